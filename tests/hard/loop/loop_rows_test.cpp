// Row L5 and rest and sliding at encoder resolution, in the whole loop: device, scene, coupling,
// gate, guard.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>

#include "core/coupling/design/design_axis.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::long_runs {
namespace {

RigOptions asked(const char* scene, const char* motion) {
  RigOptions ask;
  ask.scene = std::filesystem::path(VOXTOUCH_DEPLOY) / "scenes" / scene;
  ask.motion = motion;
  return ask;
}

/// The tool's position as seen by the encoder, and the energy bound of the passivity observer
/// (core/coupling/passivity.hpp).
class Watch {
 public:
  void see(const Vec3& position, const Wrench& given, double energy_j) {
    if (given_ && !force_.isZero(0.0)) {
      most_n_ = std::max(most_n_, force_.norm());
      longest_m_ = std::max(longest_m_, (position - position_).norm());
    }
    if (given_)
      steepest_n_ = std::max(steepest_n_, (given.force - force_).norm());
    given_ = true, position_ = position, force_ = given.force;
    lowest_j_ = std::min(lowest_j_, energy_j);
    low_ = low_.cwiseMin(position), high_ = high_.cwiseMax(position);
  }
  void forget_places() { low_ = Vec3::Constant(1e9), high_ = Vec3::Constant(-1e9); }
  double peak_to_peak_m() const { return (high_ - low_).maxCoeff(); }
  double bound_j() const { return -5.0 * most_n_ * longest_m_; }
  double lowest_j() const { return lowest_j_; }
  double steepest_n() const { return steepest_n_; }

 private:
  bool given_ = false;
  Vec3 position_ = Vec3::Zero(), force_ = Vec3::Zero(), low_ = Vec3::Constant(1e9),
       high_ = Vec3::Constant(-1e9);
  double most_n_ = 0.0, longest_m_ = 0.0, lowest_j_ = 0.0, steepest_n_ = 0.0;
};

// --- resting contact at encoder resolution, sliding over voxel borders

struct Touch {
  contact::ContactModelKind model;
  bool arm;
};
void PrintTo(const Touch& t, std::ostream* out) {
  *out << contact::name_of(t.model) << (t.arm ? " arm" : " stylus");
}

class EncoderResolution : public ::testing::TestWithParam<Touch> {};

/// Moves into the cup's wall by a tenth, a quarter and half a voxel, the stiffest range of the
/// contact, and rests at each depth. Below the voxel layer the force of three models is constant,
/// and nothing can oscillate.
Motion gentle_rests() {
  const Vec3 out = Vec3(-0.04417, -0.01607, 0.0).normalized();
  Motion motion;
  for (const double depth_m : {-0.002, 0.0002, 0.0005, 0.001})
    motion.path.push_back((0.05 - depth_m) * out + Vec3(0, 0, 0.05));
  motion.hold_s = 2.5;
  return motion;
}

TEST_P(EncoderResolution, LightRestHasNoLimitCycle) {
  const auto& [model, arm] = GetParam();
  for (const bool friction : {true, false}) {
    RigOptions ask = asked("cup_field.yaml", "");
    ask.path = gentle_rests(), ask.model = model;
    if (arm)
      ask.device = sim::sim_lwr();
    if (!friction)
      ask.device.description.coulomb_friction_n = ask.device.coulomb_friction_nm = 0.0;
    LoopRig rig(ask);
    Watch whole;
    const double step_m = ask.device.description.position_resolution_m;
    double at_s = ask.path->hold_s;
    for (std::size_t i = 1; i < ask.path->path.size(); ++i) {
      const double path_m = (ask.path->path[i] - ask.path->path[i - 1]).norm();
      at_s += kMinimumJerkPeak * path_m / ask.path->speed_m_per_s + ask.path->hold_s;
      Watch rest;
      double force_n = 0.0;
      while (static_cast<double>(rig.device().time_ns()) * 1e-9 < at_s) {
        const Wrench& given = rig.step();
        const Vec3& position = rig.front().frame().object.position;
        whole.see(position, given, rig.front().out().energy_j);
        if (static_cast<double>(rig.device().time_ns()) * 1e-9 > at_s - 0.5)
          rest.see(position, given, 0.0);
        force_n = given.force.norm();
      }
      EXPECT_LE(rest.peak_to_peak_m(), 1.001 * step_m)
          << i << (friction ? "" : " without friction");
      if (i > 1 && !(arm && friction)) {  // an arm's friction prevents the full displacement
        EXPECT_GT(force_n, 0.0) << i;
      }
      std::printf("%s rest %d: %.3f N, %.2f encoder steps peak to peak\n",
                  friction ? "friction," : "no friction,", static_cast<int>(i), force_n,
                  rest.peak_to_peak_m() / step_m);
    }
    EXPECT_GE(whole.lowest_j(), whole.bound_j());
  }
}

TEST_P(EncoderResolution, SlidingKeepsTheEnergyBound) {
  const auto& [model, arm] = GetParam();
  RigOptions ask = asked("cup_field.yaml", "slide");
  ask.model = model;
  if (arm)
    ask.device = sim::sim_lwr();
  LoopRig rig(ask);
  Watch watch;
  int touching = 0;
  for (int n = 0; n < 5300; ++n) {
    const Wrench& given = rig.step();
    watch.see(rig.front().frame().object.position, given, rig.front().out().energy_j);
    touching += !given.zero();
  }
  EXPECT_GT(touching, 1000);
  EXPECT_GE(watch.lowest_j(), watch.bound_j());
  std::printf("lowest energy %.3g J, bound %.3g J\n", watch.lowest_j(), watch.bound_j());
}

INSTANTIATE_TEST_SUITE_P(Cup, EncoderResolution,
                         ::testing::Values(Touch{contact::ContactModelKind::kOriginal, false},
                                           Touch{contact::ContactModelKind::kAdapted, false},
                                           Touch{contact::ContactModelKind::kField, false},
                                           Touch{contact::ContactModelKind::kOriginal, true},
                                           Touch{contact::ContactModelKind::kAdapted, true},
                                           Touch{contact::ContactModelKind::kField, true}));

// --- L1

/// Effect of the encoder on the force through the injected damping, peak to peak: 2 B q/T (1 -
/// e^(-w T)), or the fraction of a window.
double encoder_step_n(const RigOptions& ask, const coupling::CouplingSpec& spec) {
  const coupling::design::VelocityEstimate velocity = coupling::design::velocity_of(spec);
  const double period_s = 1.0 / ask.device.description.rate_hz;
  return 2.0 * spec.injected_damping_ns_per_m * ask.device.description.position_resolution_m /
         period_s *
         coupling::design::step_ratio(velocity.filter_rad_per_s(), velocity.window, period_s);
}

/// The scene is rebuilt, twice as stiff, while the tool is pressed into it. Quasi-statically the
/// work on the hand is the mean of both forces times the displacement; a step would do half as much
/// again.
TEST(L1StiffnessStep, ReloadUnderPressureGivesOnlyTheRampEnergy) {
  for (const double stiffness_times :
       {0.03, 0.06}) {  // below the cap, so that the hand gets the scene's stiffness
    RigOptions ask = asked("cup_field.yaml", "hit");
    ask.device.description.coulomb_friction_n = 0.0;  // it would keep the tool in place
    ask.stiffness_times = stiffness_times;
    LoopRig rig(ask);
    Watch watch;
    double before_n = 0.0, energy_generated_j = 0.0;
    Vec3 before = Vec3::Zero(), last = Vec3::Zero();
    for (int n = 0; n < 5300; ++n) {
      if (n == 3800) {
        before = rig.device().plant().pose().position;
        rig.front().swap_to(rig.build_again(2 * ask.stiffness_times));
      }
      const Wrench& given = rig.step();
      if (n < 3800)
        before_n = given.force.norm();
      if (n == 3799)
        watch = {};
      const Vec3 at = rig.device().plant().pose().position;
      if (n >= 3799)
        watch.see(at, given, 0.0);
      if (n >= 3800)
        energy_generated_j += given.force.dot(at - last);
      last = at;
    }
    const double after_n = rig.front().out().wrench.force.norm(),
                 path_m = (rig.device().plant().pose().position - before).norm();
    const double must_j = 0.5 * (before_n + after_n) * path_m;
    ASSERT_GT(after_n, 1.3 * before_n);
    ASSERT_EQ(rig.front().counters().capped, 0U);
    // By the device's true path: the observer's figure also has the encoder's steps, twice as much
    // as this in so light a contact.
    EXPECT_NEAR(energy_generated_j, must_j,
                0.2 * must_j + after_n * ask.device.description.position_resolution_m);
    EXPECT_LE(watch.steepest_n(), 1.5 * (after_n - before_n) * 1e-3 / rendering::LiveScene::kFadeS +
                                      encoder_step_n(ask, rig.spec()));
    std::printf(
        "from %.3g N to %.3g N over %.2g m, largest step %.2g N (an encoder step %.2g N), given "
        "%.3g J, must %.3g J\n",
        before_n, after_n, path_m, watch.steepest_n(), encoder_step_n(ask, rig.spec()),
        energy_generated_j, must_j);
  }
}

// --- L5

/// The connection of coupling and device: commands are lost, duplicated, delayed and reordered.
class Wire {
 public:
  Wire(double loss, std::uint64_t seed) : loss_(loss), random_(seed) {}
  bool loses() { return uniform() < loss_; }
  /// `command` sets out at `now`; it may arrive then, up to two periods later, or twice.
  void send(const LoopRig::Command& command, std::uint64_t now) {
    if (loses())
      return;
    pending_.push_back({now + late(), command});
    if (uniform() < 0.1)
      pending_.push_back({now + 1 + late(), command});
  }
  /// Commands that arrive at `now`, the last sent first.
  std::vector<LoopRig::Command> arriving(std::uint64_t now) {
    std::vector<LoopRig::Command> out;
    for (std::size_t i = pending_.size(); i-- > 0;) {
      if (pending_[i].at > now)
        continue;
      out.push_back(pending_[i].command);
      pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return out;
  }

 private:
  struct Letter {
    std::uint64_t at;
    LoopRig::Command command;
  };
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::uint64_t late() { return uniform() < 0.9 ? 0 : 1 + (random_() & 1U); }

  double loss_;
  std::mt19937_64 random_;
  std::deque<Letter> pending_;
};

TEST(L5Wire, LossAndReorderingKeepRestAndNewestCommand) {
  const std::uint64_t standard = testing::seed(5);
  SCOPED_TRACE(testing::seed_trace(standard));
  for (const double loss : {0.0, 0.01, 0.03, 0.05})
    for (const bool arm : {false, true}) {
      RigOptions ask = asked("cup.yaml", "hit");
      if (arm)
        ask.device = sim::sim_lwr();
      LoopRig rig(ask);
      Wire wire(loss, standard + (arm ? 100 : 0) + static_cast<std::uint64_t>(1000 * loss));
      Watch watch;
      std::uint64_t newest = 0, lost = 0, refused = 0;
      for (std::uint64_t n = 0; n < 5300; ++n) {
        if (n == 4300)
          watch.forget_places();
        const devices::DeviceSample sample = rig.read();
        if (wire.loses())
          ++lost;
        else
          wire.send(rig.answer(sample, rig.sequence()), n);
        for (const LoopRig::Command& command : wire.arriving(n)) {
          const bool newer =
              command.sequence > newest || (newest == 0 && command.sequence == 0 && n == 0);
          ASSERT_EQ(rig.arrive(command),
                    newer ? devices::GateVerdict::kAccepted : devices::GateVerdict::kOldSequence)
              << n;
          if (newer)
            newest = command.sequence;
          else
            ++refused;
        }
        const Wrench& given = rig.finish();
        ASSERT_TRUE(given.finite());
        watch.see(sample.pose.position, given, rig.front().out().energy_j);
      }
      EXPECT_EQ(rig.guard().counts().refused_sequence, refused);
      EXPECT_GT(refused, 300U);
      EXPECT_EQ(lost > 0, loss > 0.0);
      EXPECT_EQ(rig.guard().counts().refused_stale, 0U);
      EXPECT_EQ(rig.refused_writes(), 0U);
      const double step_m = ask.device.description.position_resolution_m;
      EXPECT_LE(watch.peak_to_peak_m(), 1.001 * step_m) << loss << (arm ? " arm" : " stylus");
      std::printf(
          "loss %.0f %%: %.2f encoder steps peak to peak, %d samples lost, %d commands too old, %d "
          "fades\n",
          100 * loss, watch.peak_to_peak_m() / step_m, static_cast<int>(lost),
          static_cast<int>(refused), static_cast<int>(rig.guard().counts().faded));
    }
}

enum class Silent { kCommands, kSamples };

/// The wire is cut for 100 ms while the tool rests on the wall.
TEST(L5Wire, SilenceFadesTheForceAndReturnsWithoutAStep) {
  for (const Silent what : {Silent::kCommands, Silent::kSamples})
    for (const bool arm : {false, true}) {
      RigOptions ask = asked("cup.yaml", "hit");
      if (arm)
        ask.device = sim::sim_lwr();
      LoopRig rig(ask);
      Watch watch;
      constexpr int kCut = 3800, kBack = kCut + 100;
      double before_n = 0.0;
      Vec3 rest = Vec3::Zero();
      for (int n = 0; n < 5300; ++n) {
        const devices::DeviceSample sample = rig.read();
        const bool cut = n >= kCut && n < kBack;
        if (n == kCut)
          rest = sample.pose.position;
        if (n == 4800)
          watch.forget_places();
        if (!cut || what == Silent::kCommands) {
          const LoopRig::Command command = rig.answer(sample, rig.sequence());
          if (!cut)
            rig.arrive(command);
        }
        const Wrench& given = rig.finish();
        if (n < kCut)
          before_n = given.force.norm();
        if (n == kCut - 1)
          watch = {};
        if (n >= kCut - 1)
          watch.see(sample.pose.position, given, 0.0);
        if (n >= kCut - 1 + 3 + 20 && n < kBack) {
          ASSERT_TRUE(given.zero()) << n - kCut;
        }
      }
      ASSERT_GT(before_n, 0.1);
      // 20 ms from full force to zero, by the guard; back over its 0.1 s, and the larger force of a
      // deeper tool.
      EXPECT_LE(watch.steepest_n(), 1.2 * before_n / 20.0 + encoder_step_n(ask, rig.spec()));
      const double step_m = ask.device.description.position_resolution_m;
      EXPECT_LE(watch.peak_to_peak_m(), 1.001 * step_m);
      std::printf(
          "%s, %s: %.3g N before, largest change in a period %.3g N, back to %.2f steps from where "
          "it was\n",
          what == Silent::kCommands ? "commands" : "samples", arm ? "arm" : "stylus", before_n,
          watch.steepest_n(), (rig.front().frame().object.position - rest).norm() / step_m);
    }
}

}  // namespace
}  // namespace voxtouch::long_runs
