#include "tests/support/loop_rig/wall_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/coupling/design/loop_parts.hpp"
#include "core/scene/design_options.hpp"

namespace voxtouch::long_runs {
namespace {

constexpr double kRigid = 1e8;  ///< stiffness of any contact that is designed for, and of a wall
                                ///< before a virtual tool [N/m, Nm/rad]

coupling::CouplingLimits limits_of(const DeviceDescription& d) {
  return {.max_force_n = d.max_force_n,
          .max_torque_nm = d.max_torque_nm,
          .resolution_m = d.position_resolution_m,
          .damping_ns_per_m = d.damping_ns_per_m,
          .coulomb_friction_n = d.coulomb_friction_n,
          .delay_s = d.delay_s,
          .force_lag_s = 1.0 / (2.0 * std::numbers::pi * d.force_bandwidth_hz)};
}

double chance(std::uint64_t& state) noexcept {  // SplitMix64
  std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

coupling::design::Design design_for(const DeviceDescription& device, const std::string& kind) {
  coupling::design::DesignProblem problem;
  DeviceDescription simulated = device;
  simulated.simulated = true;
  problem.device = coupling::design::model_of(simulated);
  problem.hand = scene::operator_range(scene::DesignOptions{}, problem.device.grip);
  problem.contact = problem.contact_rotation = {1.0, kRigid};
  problem.goals.kind = kind;
  problem.goals.free_cap = true;
  return coupling::design::design_coupling(problem);
}

WallLoop::WallLoop(const WallLoopOptions& options, const coupling::design::Design& design)
    : options_(options),
      coupling_(
          [&] {
            coupling::CouplingSpec spec = design.spec;  // whatever is shown is in the spring
            spec.stiffness_cap_n_per_m *= options.times_promise,
                spec.stiffness_cap_nm_per_rad *= options.times_promise;
            return spec;
          }(),
          limits_of(options.designed_for), 1.0 / options.designed_for.rate_hz),
      guard_(devices::guard_config(options.device.description)),
      random_(options.seed * 2 + 1),
      period_s_(1.0 / options.designed_for.rate_hz) {
  const coupling::CouplingSpec& spec = design.spec;
  spring_.set_target(
      {rendering::compliance_for(options.times_promise * spec.stiffness_cap_n_per_m, 2.0 * kRigid),
       options.designed_for.max_torque_nm > 0.0
           ? rendering::compliance_for(options.times_promise * spec.stiffness_cap_nm_per_rad,
                                       2.0 * kRigid)
           : 0.0});
  device_ = std::make_unique<sim::SimulatedDevice>(options.device, options.hand, options.motion,
                                                   options.seed);
}

rendering::ContactAt WallLoop::contact_at(const Pose& tool) noexcept {
  rendering::ContactAt out;
  Vec3 normals = Vec3::Zero();
  std::uint32_t hits = 0;
  for (const LoopWall& wall : options_.walls) {
    const Vec3 arm = tool.orientation * wall.arm;
    const double wave_m = wall.texture_m * std::sin(wall.texture_per_m * tool.position.x());
    const double depth = wall.at_m + wave_m - wall.normal.dot(tool.position + arm);
    if (!(depth > 0.0))
      continue;
    const double k = options_.virtual_tool ? kRigid : wall.n_per_m,
                 over = std::max(0.0, depth - wall.knee_m);
    const double force = k * (depth - over + wall.beyond * over),
                 slope = over > 0.0 ? k * wall.beyond : k;
    normals += wall.normal, ++hits;
    // The gradient of the depth: over waves the force also acts against the motion uphill, so that
    // no closed path gives energy.
    const Vec3 push = wall.normal - wall.texture_m * wall.texture_per_m *
                                        std::cos(wall.texture_per_m * tool.position.x()) *
                                        Vec3::UnitX();
    Vec6 j;
    j << push, arm.cross(push);
    out.wrench.force += force * j.head<3>(), out.wrench.torque += force * j.tail<3>();
    out.stiffness += slope * j * j.transpose();
  }
  coherence_ = coupling::coherence_of(hits, normals.norm() / std::max(1U, hits));
  return out;
}

const Wrench& WallLoop::step() noexcept {
  const auto sample = device_->read(std::chrono::microseconds(0));
  if (!sample)
    return given_;
  const std::uint64_t sequence = sequence_++;
  const double dt_s =
      sequence > 0 ? static_cast<double>(sample->time_ns - last_ns_) * 1e-9 : period_s_;
  last_ns_ = sample->time_ns;
  spring_.begin(sample->pose, dt_s);
  rendering::ContactAt contact;
  do {
    contact = contact_at(spring_.tool());
  } while (spring_.settle(contact));
  coupling::CouplingInput input;
  input.contact = spring_.wrench();
  input.contact_stiffness = rendering::in_series(contact.stiffness, spring_.compliance());
  input.contact_stiffness_n_per_m = input.contact_stiffness.topLeftCorner<3, 3>().trace();
  input.tool = sample->pose, input.coherence = coherence_;
  const coupling::CouplingOutput out = coupling_.step(input, dt_s);
  const std::pair<std::uint64_t, devices::GuardInput> command{
      sequence, {out.wrench, sample->time_ns + std::llround(5e9 * period_s_)}};
  std::optional<devices::GuardInput> arrived;
  const auto arrive = [&](const std::pair<std::uint64_t, devices::GuardInput>& one) {
    if (gate_.accept(1, 1, one.first, sequence) == devices::GateVerdict::kAccepted)
      arrived = one.second;
  };
  if (late_)
    arrive(*std::exchange(late_, std::nullopt));
  if (options_.loss > 0.0 && chance(random_) < options_.loss) {
  } else if (options_.late && chance(random_) < 0.2) {
    late_ = command;
  } else {
    arrive(command);
  }
  given_ = guard_.pass(arrived, sample->time_ns);
  (void)device_->write(given_);
  return given_;
}

}  // namespace voxtouch::long_runs
