// The designed coupling in the whole ring: the cup, abruptly and sliding, with a light, usual and
// firm grip, and released.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/types/geometry.hpp"
#include "nodes/runtime/convert.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

constexpr double kPeriodS = 1e-3, kDurationS = 6.0;

/// Largest distance between two coordinates of one axis, over the samples [from, to).
double peak_to_peak(const std::vector<Vec3>& points, std::size_t from, std::size_t to) {
  Vec3 low = points[from], high = points[from];
  for (std::size_t i = from; i < to; ++i)
    low = low.cwiseMin(points[i]), high = high.cwiseMax(points[i]);
  return (high - low).maxCoeff();
}

struct Recorded {
  nlohmann::json summary;
  std::vector<Vec3> position, force;
  double lowest_energy_j = 0.0;
};

Recorded touch_cup(const std::string& device, const std::string& motion,
                   std::vector<std::string> hand) {
  const TemporaryFolder folder;
  hand.insert(hand.end(),
              {"--device", device, "--motion", motion, "--lockstep", "--one-process", "--duration",
               std::to_string(kDurationS), "--record", (folder / "bag").string()});
  const RingResult run = run_ring(shipped_scene("cup"), hand);
  EXPECT_EQ(run.process.status, 0) << run.process.err << run.process.out;
  Recorded out;
  out.summary = run.summary;
  for (const auto& m : read_ring_topic<msg::DeviceState>(folder / "bag", "/haptic/device/state"))
    out.position.push_back(runtime::from_msg(m.pose).position);
  for (const auto& m :
       read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command")) {
    out.force.push_back(runtime::from_msg(m.wrench).force);
    out.lowest_energy_j = std::min(out.lowest_energy_j, m.energy_j);
  }
  return out;
}

/// The bound of the passivity observer (core/coupling/passivity.hpp): a debt of at most five times
/// the work of the largest force over the longest path of one period in contact.
double energy_bound_j(const Recorded& r) {
  double force = 0.0, displacement = 0.0;
  for (std::size_t i = 1; i < std::min(r.position.size(), r.force.size()); ++i) {
    if (r.force[i].isZero(0.0))
      continue;
    force = std::max(force, r.force[i].norm());
    displacement = std::max(displacement, (r.position[i] - r.position[i - 1]).norm());
  }
  return -5.0 * force * displacement;
}

/// The largest force of the first 100 ms of the first contact over the mean from 45 to 55 ms after
/// it.
double first_peak_over_later(const std::vector<Vec3>& force) {
  const auto begin = std::ranges::find_if(force, [](const Vec3& f) { return f.norm() > 0.02; });
  if (force.end() - begin < 160)
    return std::numeric_limits<double>::quiet_NaN();
  const auto peak = std::max_element(
      begin, begin + 100, [](const Vec3& a, const Vec3& b) { return a.norm() < b.norm(); });
  double later = 0.0;
  for (auto f = peak + 45; f < peak + 56; ++f)
    later += f->norm() / 11.0;
  return peak->norm() / later;
}

/// The median of the force while `hit` rests on the wall.
double steady_n(const std::vector<Vec3>& force) {
  std::vector<double> sizes;
  for (std::size_t i = 4300; i < 5300; ++i)
    sizes.push_back(force.at(i).norm());
  std::ranges::nth_element(sizes, sizes.begin() + 500);
  return sizes[500];
}

struct Case {
  const char* device;
  double encoder_step_m;
  const char* motion;
  std::vector<std::string> hand;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.device << " " << c.motion;
  for (const std::string& word : c.hand)
    *out << " " << word;
}

class DesignedCoupling : public testing::TestWithParam<Case> {};

TEST_P(DesignedCoupling, TouchesTheCupWithinItsEnergyBound) {
  const Case& c = GetParam();
  const Recorded r = touch_cup(c.device, c.motion, c.hand);
  ASSERT_EQ(r.position.size(), static_cast<std::size_t>(kDurationS / kPeriodS));
  ASSERT_GT(r.summary["contact_samples"].get<int>(), 1000);
  EXPECT_NE(r.summary["coupling"]["status"], "infeasible");
  EXPECT_GE(r.summary["coupling"]["gain_margin"].get<double>(), 2.0 - 1e-6);
  EXPECT_EQ(r.summary["validator"]["disagree"], 0);
  // A firm arm that strikes at 0.2 m/s meets the injected damping at once: a step that the guard
  // may have to lead over.
  EXPECT_LE(r.summary["guard"]["clamped"], 3);
  EXPECT_GE(r.lowest_energy_j, energy_bound_j(r));
  RecordProperty("lowest_energy_j", std::to_string(r.lowest_energy_j));
  RecordProperty("energy_bound_j", std::to_string(energy_bound_j(r)));
  if (c.hand.empty()) {
    EXPECT_LE(first_peak_over_later(r.force), 1.5)
        << "a touch is displayed as the contact, not as the damper";
    RecordProperty("first_peak_over_later", std::to_string(first_peak_over_later(r.force)));
  }
  // `hit` rests on the wall from about 2.9 to 5.4 s; a tool released at 4.2 s comes to rest at any
  // place.
  if (std::string(c.motion) == "hit" || !c.hand.empty()) {
    const bool released = !c.hand.empty() && c.hand.front() == "--release-time";
    if (std::string(c.motion) == "hit" || released) {
      const std::size_t from = released ? 5500 : 4300, to = released ? 6000 : 5300;
      const double left_m = peak_to_peak(r.position, from, to);
      EXPECT_LE(left_m, c.encoder_step_m * 1.001) << "in samples " << from << " to " << to;
      RecordProperty("oscillation_m", std::to_string(left_m));
    }
  }
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const std::pair<const char*, double> devices[] = {{"sim-phantom", 0.03e-3}, {"sim-lwr", 20e-6}};
  for (const auto& [device, step_m] : devices)
    for (const char* motion : {"hit", "slide"}) {
      const std::string kind = std::string(device) == "sim-phantom" ? "pen" : "arm";
      all.push_back({device, step_m, motion, {}});
      all.push_back({device, step_m, motion, {"--hand", "pen-light"}});
      all.push_back({device, step_m, motion, {"--hand", kind + "-firm"}});
      all.push_back({device, step_m, motion, {"--release-time", "4.2"}});
    }
  return all;
}
INSTANTIATE_TEST_SUITE_P(Cup, DesignedCoupling, testing::ValuesIn(cases()));

/// The cup with other lines for coupling and contact, if given.
std::string cup_with(const TemporaryFolder& folder, const std::string& coupling,
                     const std::string& contact) {
  const std::string file = (folder / "cup_with.yaml").string();
  std::ifstream in(shipped_scene("cup"));
  std::ofstream out(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("coupling:") && !coupling.empty())
      line = "coupling: " + coupling;
    if (line.starts_with("contact:") && !contact.empty())
      line = "contact: " + contact;
    if (const auto at = line.find("../meshes"); at != std::string::npos)
      line.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    out << line << "\n";
  }
  return file;
}

double held_n(const std::string& scene, const std::string& device) {
  const TemporaryFolder bag;
  // A coupling without a certificate for the device is a problem of such a run; its force is
  // checked nevertheless.
  run_ring(scene, {"--device", device, "--motion", "hit", "--lockstep", "--one-process",
                   "--duration", "6", "--record", (bag / "bag").string()});
  std::vector<Vec3> force;
  for (const auto& m : read_ring_topic<msg::ForceCommand>(bag / "bag", "/haptic/coupling/command"))
    force.push_back(runtime::from_msg(m.wrench).force);
  return steady_n(force);
}

/// The spring in series with the contact costs force: a stiffer contact holds more, and the paper's
/// filter, which is not stable, more still.
TEST(DesignedCoupling, HoldsMostOfThePapersForceAtTheSameHand) {
  const TemporaryFolder folder;
  for (const char* device : {"sim-phantom", "sim-lwr"}) {
    const double designed = steady_n(touch_cup(device, "hit", {}).force),
                 papers = held_n(
                     cup_with(folder,
                              "{kind: shaping_filter, cutoff_hz: 5, damping_ratio: 1, gain: 1}",
                              ""),
                     device),
                 stiffer = held_n(cup_with(folder, "", "{model: adapted, stiffness_n_per_m: 45}"),
                                  device);
    std::printf("%s: designed %.3f N, with 45 N/m a point %.3f N, the paper's 5 Hz %.3f N\n",
                device, designed, stiffer, papers);
    EXPECT_GE(designed, 0.65 * papers)
        << device;  // a sim-phantom's dry friction holds it within some hundredths of a newton
    EXPECT_GE(stiffer, 1.1 * designed) << device;
  }
}

/// Output of `up` for the plane with this coupling and these effects, if it refuses to start.
std::string refusal_at_start(const std::string& coupling, const std::string& effects) {
  const TemporaryFolder folder;
  const std::filesystem::path scene = folder / "refused.yaml";
  std::ifstream in(shipped_scene("plane"));
  std::ofstream out(scene);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("coupling:"))
      line = "coupling: " + coupling;
    if (line.starts_with("effects:"))
      line = "effects: " + effects;
    if (const auto at = line.find("../meshes"); at != std::string::npos)
      line.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    out << line << "\n";
  }
  out.close();
  const RingResult run =
      run_ring(scene.string(), {"--motion", "hit", "--duration", "2", "--no-record"});
  EXPECT_EQ(run.process.status, 1);
  EXPECT_FALSE(run.summary.contains("max_force_n")) << "nodes ran: " << run.process.out;
  return run.summary.is_null() ? run.process.err : run.summary["problems"].dump();
}

TEST(DesignedCoupling, InfeasibleDesignIsRefusedAtStart) {
  const std::string problems = refusal_at_start("{design: auto, hand: any_passive}", "[]");
  EXPECT_NE(problems.find("run_infeasible"), std::string::npos) << problems;
}

TEST(DesignedCoupling, TooMuchEffectDampingIsRefused) {
  const std::string problems =
      refusal_at_start("{design: auto}", "[{viscosity: {damping_ns_per_m: 90}}]");
  EXPECT_NE(problems.find("90 Ns/m"), std::string::npos) << problems;
}

}  // namespace
}  // namespace voxtouch::test
