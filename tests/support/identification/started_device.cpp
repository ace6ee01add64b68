#include "tests/support/identification/started_device.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace voxtouch::testing {
namespace {

constexpr double kHeavyKg = 1.0;  // from here on an arm holds the device, else two fingers

AxisHand random_hand(std::mt19937_64& random, bool pen, bool moves) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  AxisHand hand;
  hand.mass_kg = pen ? between(0.01, 0.15) : between(0.2, 1.5);
  hand.damping_ns_per_m = pen ? between(0.5, 8.0) : between(5.0, 30.0);
  hand.stiffness_n_per_m = pen ? between(50.0, 800.0) : between(200.0, 1500.0);
  hand.tremor_n = pen ? between(0.01, 0.05) : between(0.05, 0.3);
  hand.frequency_hz = between(0.3, 1.0);
  hand.phase = between(0.0, 2.0 * std::numbers::pi);
  if (moves)
    hand.amplitude_m = between(0.005, 0.03);
  return hand;
}

void plant(AxisTruth& truth, Planted planted) {
  switch (planted) {
    case Planted::kHealthy:
      return;
    case Planted::kDelayTwice:
      truth.delay_s *= 2.0;
      truth.lag_s *= 2.0;
      return;
    case Planted::kMassTwice:
      truth.mass_kg *= 2.0;
      return;
    case Planted::kMassHalf:
      truth.mass_kg *= 0.5;
      return;
    case Planted::kEncoderFourfold:
      truth.encoder_step_m *= 4.0;
      return;
  }
}

}  // namespace

DeviceDescription file_of(const std::array<AxisTruth, 3>& truth) {
  DeviceDescription d;
  d.rate_hz = truth[0].rate_hz;
  d.max_force_n = truth[0].max_force_n;
  d.mass_min_kg = std::numeric_limits<double>::infinity();
  for (const AxisTruth& axis : truth) {
    d.mass_min_kg = std::min(d.mass_min_kg, axis.mass_kg);
    d.mass_max_kg = std::max(d.mass_max_kg, axis.mass_kg);
    d.delay_s = std::max(d.delay_s, axis.mean_delay_s());
  }
  d.force_bandwidth_hz = std::numeric_limits<double>::infinity();
  d.position_resolution_m = truth[0].encoder_step_m;
  d.grip = d.mass_min_kg < kHeavyKg ? "pen" : "arm";
  d.simulated = true;
  return d;
}

StartRun check_start(std::array<AxisTruth, 3> truth, Planted planted, Holding holding,
                     std::uint64_t seed) {
  const DeviceDescription file = file_of(truth);
  std::mt19937_64 random(seed);
  std::vector<IdentifiedAxis> axes;
  for (AxisTruth& axis : truth) {
    plant(axis, planted);
    axes.emplace_back(axis, random());
    if (holding != Holding::kReleased)
      axes.back().hold(random_hand(random, file.grip == "pen", holding == Holding::kMoving));
  }
  identification::StartCheck check;
  check.start(file);
  StartRun out;
  double squares = 0.0, samples = 0.0;
  while (!check.finished()) {
    Vec3 position;
    double time_s = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const AxisSample sample = axes[a].next();
      position[static_cast<Eigen::Index>(a)] = sample.position_m;
      time_s = sample.time_s;
    }
    const Vec3 force = check.force(time_s, position);
    check.applied(force);
    squares += force[0] * force[0];
    samples += 1.0;
    for (std::size_t a = 0; a < 3; ++a)
      axes[a].command(force[static_cast<Eigen::Index>(a)]);
  }
  out.findings = check.findings();
  out.acceleration = std::sqrt(squares / samples) / file.mass_min_kg;
  return out;
}

}  // namespace voxtouch::testing
