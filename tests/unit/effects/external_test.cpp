// An external wrench: its effect on the hand, for any input.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/effects/effect_chain.hpp"
#include "core/effects/ros_topic.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/effects/chain_change.hpp"
#include "tests/unit/effects/effect_check.hpp"

namespace voxtouch::effects {
namespace external_test {

constexpr double kInf = std::numeric_limits<double>::infinity(),
                 kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kStepS = 0.001, kMax = 2.0, kMaxTorque = 0.05, kSlew = 100.0, kTorqueSlew = 5.0,
                 kTimeout = 0.05, kFade = 0.02;
constexpr int kTimeoutSamples = 50, kFadeSamples = 20;

EffectSpec external(double energy_j = 1.0, double power_w = 0.0) {
  return test::effect("external", {{"max_force_n", {kMax, 0, 0}},
                                   {"max_torque_nm", {kMaxTorque, 0, 0}},
                                   {"timeout_s", {kTimeout, 0, 0}},
                                   {"fade_s", {kFade, 0, 0}},
                                   {"slew_n_per_s", {kSlew, 0, 0}},
                                   {"slew_nm_per_s", {kTorqueSlew, 0, 0}},
                                   {"energy_j", {energy_j, 0, 0}},
                                   {"power_w", {power_w, 0, 0}}});
}

/// The effect behind its chain, sample after sample.
class ForceProbe {
 public:
  explicit ForceProbe(const EffectSpec& spec) : chain({spec}) {}
  /// An external writer writes this before every sample from now on.
  void writes(const Wrench& wrench) { writes_ = wrench; }
  void falls_silent() { writes_.reset(); }
  const EffectForce& sample(const Vec3& displacement = Vec3::Zero()) {
    time_s += kStepS;
    if (writes_)
      newest_ = ExternalWrench{*writes_, time_s};
    frame.tool.position += displacement;
    frame.dt_s = kStepS, frame.time_s = time_s;
    frame.external = newest_ ? &*newest_ : nullptr;
    const Wrench before = push.wrench;
    push = chain.apply(frame);
    force_step = (push.wrench.force - before.force).norm(),
    torque_step = (push.wrench.torque - before.torque).norm();
    most_step = std::max(most_step, force_step),
    most_torque_step = std::max(most_torque_step, torque_step);
    most_force = std::max(most_force, push.wrench.force.norm()),
    most_torque = std::max(most_torque, push.wrench.torque.norm());
    return push;
  }
  void samples(int count, const Vec3& displacement = Vec3::Zero()) {
    for (int n = 0; n < count; ++n)
      sample(displacement);
  }
  double force() const { return push.wrench.force.norm(); }

  EffectChain chain;
  EffectFrame frame;
  EffectForce push;
  double time_s = 0.0, force_step = 0.0, torque_step = 0.0, most_step = 0.0, most_torque_step = 0.0,
         most_force = 0.0, most_torque = 0.0;

 private:
  std::optional<Wrench> writes_;
  std::optional<ExternalWrench> newest_;
};

const Wrench kPush{Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 0.01)};

TEST(External, GivesNothingUntilTheFirstMessage) {
  ForceProbe probe(external());
  probe.samples(100);
  EXPECT_TRUE(probe.push.wrench.zero());
  EXPECT_TRUE(probe.push.stiffness.isZero(0.0));
  EXPECT_EQ(probe.push.potential_j, 0.0);
}

TEST(External, ReachesItsInputAtTheSlewAndStays) {
  ForceProbe probe(external());
  probe.writes(kPush);
  probe.samples(5);
  EXPECT_NEAR(probe.force(), 5 * kStepS * kSlew, 1e-12);
  probe.samples(200);
  EXPECT_TRUE(probe.push.wrench.force.isApprox(kPush.force, 1e-12));
  EXPECT_TRUE(probe.push.wrench.torque.isApprox(kPush.torque, 1e-12));
  EXPECT_LE(probe.most_step, kStepS * kSlew * (1 + 1e-9));
  EXPECT_LE(probe.most_torque_step, kStepS * kTorqueSlew * (1 + 1e-9));
}

TEST(External, AnyInputIsClampedToItsLargestForceAndTorque) {
  for (const double size : {3.0, 1e6, 1e300, std::numeric_limits<double>::max()}) {
    ForceProbe probe(external());
    probe.writes({Vec3(size, -size, 0.5 * size), Vec3(0, size, size)});
    probe.samples(300);
    EXPECT_NEAR(probe.force(), kMax, 1e-9) << size;
    EXPECT_NEAR(probe.push.wrench.torque.norm(), kMaxTorque, 1e-9) << size;
    EXPECT_LE(probe.most_force, kMax);
    EXPECT_LE(probe.most_torque, kMaxTorque);
    EXPECT_GT(probe.push.wrench.force.dot(Vec3(1, -1, 0.5)), 0.0) << "cut, not turned";
  }
}

TEST(External, ReversesNoFasterThanItsSlew) {
  ForceProbe probe(external());
  for (int turn = 0; turn < 20; ++turn) {
    probe.writes({turn % 2 ? Vec3(-100, 0, 0) : Vec3(100, 0, 0), Vec3::Zero()});
    probe.samples(7);
  }
  EXPECT_LE(probe.most_step, kStepS * kSlew * (1 + 1e-9));
}

TEST(External, FadesToZeroWithinTheStatedTime) {
  for (const double slew : {kSlew, 0.5}) {  // the fade does not wait for a slow slew
    EffectSpec spec = external();
    spec.values.at(5)[0] = slew;
    ASSERT_EQ(spec.kind->parameters[5].name, "slew_n_per_s");
    ForceProbe probe(spec);
    probe.writes({Vec3(5, 0, 0), Vec3(0, 1, 0)});
    probe.samples(5000);
    ASSERT_NEAR(probe.force(), kMax, 1e-9);
    probe.falls_silent();
    probe.samples(kTimeoutSamples - 1);
    EXPECT_NEAR(probe.force(), kMax, 1e-9) << "held up to the timeout";
    probe.most_step = 0.0;
    probe.samples(kFadeSamples + 2);
    EXPECT_TRUE(probe.push.wrench.zero()) << probe.push.wrench.force.transpose();
    EXPECT_LE(probe.most_step, kMax / kFade * kStepS * (1 + 1e-9));
    probe.writes({Vec3(5, 0, 0), Vec3::Zero()});
    probe.most_step = 0.0;
    probe.samples(10);
    EXPECT_GT(probe.force(), 0.0);
    EXPECT_LE(probe.most_step, slew * kStepS * (1 + 1e-9)) << "it comes back by a ramp";
  }
}

TEST(External, AgeIsSampleTimeSoGapsCountAsSilence) {
  ForceProbe probe(external());
  probe.writes(kPush);
  probe.samples(200);
  probe.falls_silent();
  probe.time_s += 0.2;  // samples that were lost
  const double before = probe.force();
  probe.sample();
  EXPECT_LT(probe.force(), before)
      << "the value is older than the timeout by the first sample after the gap";
  ForceProbe backwards(external());
  backwards.writes(kPush);
  backwards.samples(200);
  backwards.falls_silent();
  backwards.time_s -= 0.15;  // a clock that was set back
  backwards.samples(50);
  EXPECT_TRUE(backwards.push.wrench.zero()) << "a value from a later time is none";
}

TEST(External, NonFiniteNumberChangesNothingAndAges) {
  for (const double bad : {kNan, kInf, -kInf})
    for (int place = 0; place < 6; ++place) {
      ForceProbe probe(external());
      probe.writes(kPush);
      probe.samples(300);
      Wrench spoiled = kPush;
      (place < 3 ? spoiled.force : spoiled.torque)[place % 3] = bad;
      probe.writes(spoiled);
      probe.samples(kTimeoutSamples - 1);
      ASSERT_TRUE(probe.push.wrench.force.isApprox(kPush.force, 1e-12)) << bad << " at " << place;
      probe.samples(kFadeSamples + 2);
      ASSERT_TRUE(probe.push.wrench.zero()) << bad << " at " << place;
      ASSERT_EQ(probe.chain.not_finite(), 0U) << "it never reached the sum";
    }
}

TEST(External, AnyInputStaysWithinForceTorqueAndSlew) {
  const std::uint64_t seed = testing::seed(20261124);
  SCOPED_TRACE(testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  const auto any = [&] {
    const std::uint64_t bits =
        random() % 4 == 0
            ? random()
            : random() & 0x40FFFFFFFFFFFFFFULL;  // half of them of a size that is displayed
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  };
  ForceProbe probe(external());
  for (int n = 0; n < 200'000; ++n) {
    if (random() % 3 != 0)
      probe.writes({Vec3(any(), any(), any()), Vec3(any(), any(), any())});
    else
      probe.falls_silent();
    const EffectForce& push = probe.sample();
    ASSERT_TRUE(push.wrench.finite());
    ASSERT_LE(push.wrench.force.norm(), kMax);
    ASSERT_LE(push.wrench.torque.norm(), kMaxTorque);
    ASSERT_LE(probe.force_step, kMax / kFade * kStepS * (1 + 1e-9));
  }
  EXPECT_GT(probe.most_force, 0.1);
}

TEST(External, EnergyNeverExceedsItsBudget) {
  for (const double power_w : {0.0, 0.02}) {
    constexpr double kEnergy = 0.05;
    ForceProbe probe(external(kEnergy, power_w));
    probe.writes({Vec3(10, 0, 0), Vec3::Zero()});
    double energy_generated_j = 0.0, reported_j = 0.0;
    for (int n = 0; n < 4000; ++n) {  // the hand is moved with 0.2 m/s
      const Vec3 displacement(0.0002, 0, 0), force = probe.push.wrench.force;
      energy_generated_j += force.dot(displacement);
      reported_j += probe.sample(displacement).energy_generated_j;
      ASSERT_LE(energy_generated_j, kEnergy + power_w * probe.time_s + 1e-6) << n;
      ASSERT_LE(probe.force_step, 0.11)
          << "the budget's end is no step: 2 N over half of the store at 0.2 m/s, and the slew";
    }
    EXPECT_NEAR(reported_j, energy_generated_j, 1e-9)
        << "what the observer is reported is what was done, and no more";
    EXPECT_GT(energy_generated_j, 0.9 * kEnergy);
    EXPECT_NEAR(probe.force(), power_w / 0.2, 0.01) << "what is left is what the power lasts for";
    // Moved back, it returns the energy that the hand supplied; reported as absorbed.
    double back_j = 0.0;
    probe.samples(50, Vec3(-0.0002, 0, 0));
    for (int n = 0; n < 500; ++n)
      back_j += probe.sample(Vec3(-0.0002, 0, 0)).energy_generated_j;
    if (power_w > 0.0) {
      EXPECT_LT(back_j, 0.0);
    }
  }
}

TEST(External, HandAtRestReceivesTheFullForceForever) {
  ForceProbe probe(external(0.001, 0.0));
  probe.writes({Vec3(10, 0, 0), Vec3::Zero()});
  probe.samples(20'000);
  EXPECT_NEAR(probe.force(), kMax, 1e-9);
}

TEST(External, ReenteredRegionGivesNoNewBudget) {
  EffectSpec spec = external(0.02, 0.0);
  spec.region = {SphereRegion{Vec3::Zero(), 0.03}, 0.01};
  ForceProbe probe(spec);
  probe.writes({Vec3(10, 0, 0), Vec3::Zero()});
  double energy_generated_j = 0.0;
  for (int round = 0; round < 10; ++round) {
    probe.frame.tool.position =
        Vec3(-0.05, 0, 0);  // enters at the side that repels it, and is carried out
    for (int n = 0; n < 500; ++n) {
      const Vec3 displacement(0.0002, 0, 0);
      energy_generated_j += probe.push.wrench.force.dot(displacement);
      probe.sample(displacement);
    }
    probe.push = {};
  }
  EXPECT_LE(energy_generated_j, 0.021);
}

TEST(External, AllowsNoTorqueToTheObserver) {
  ForceProbe probe(external());
  probe.writes({Vec3::Zero(), Vec3(0, 0, 1)});
  double reported_j = 0.0;
  for (int n = 0; n < 500; ++n) {
    probe.frame.tool.orientation = Quat(Eigen::AngleAxisd(0.001 * n, Vec3::UnitZ()));
    reported_j += probe.sample().energy_generated_j;
  }
  EXPECT_NEAR(probe.push.wrench.torque.norm(), kMaxTorque, 1e-9);
  EXPECT_EQ(reported_j, 0.0);
}

TEST(External, ForgetsItsForceWhenRegionOrSessionEnds) {
  ForceProbe probe(external());
  probe.writes(kPush);
  probe.samples(300);
  probe.chain.reset();
  probe.sample();
  EXPECT_LE(probe.force(), kStepS * kSlew * (1 + 1e-9));
}

TEST(External, ValuesGainAndSwitchChangeWithoutAStep) {
  ForceProbe probe(external());
  probe.writes({Vec3(10, 0, 0), Vec3::Zero()});
  probe.samples(300);
  probe.most_step = 0.0;
  ASSERT_EQ(test::set_value(probe.chain, "max_force_n", {0.5, 0, 0}), "");
  probe.samples(150);
  EXPECT_NEAR(probe.force(), 0.5, 1e-9);
  EXPECT_LE(probe.most_step, kMax / EffectChain::kEffectRampS * kStepS * 1.001);
  EXPECT_NE(test::set_value(probe.chain, "topic", {0, 0, 0}), "");
  EXPECT_NE(test::set_value(probe.chain, "max_force_n", {-1, 0, 0}), "");
  EXPECT_NE(test::set_value(probe.chain, "max_force_n", {kNan, 0, 0}), "");
}

TEST(External, LoweredLimitIsKeptDespiteASlowSlew) {
  EffectSpec spec = external();
  spec.values.at(5)[0] = 0.5;
  ForceProbe probe(spec);
  probe.writes({Vec3(10, 0, 0), Vec3::Zero()});
  probe.samples(5000);
  ASSERT_NEAR(probe.force(), kMax, 1e-9);
  ASSERT_EQ(test::set_value(probe.chain, "max_force_n", {0.5, 0, 0}), "");
  for (int n = 0; n < 150; ++n) {
    probe.sample();
    ASSERT_LE(probe.force(), probe.chain.values(0).number(1));
  }
  EXPECT_NEAR(probe.force(), 0.5, 1e-9);
}

TEST(External, NeedsAndBoundsAreCorrect) {
  const EffectSpec spec = external();
  const EffectNeeds needs = spec.kind->needs(spec.values);
  EXPECT_TRUE(needs.external && needs.torque);
  EXPECT_FALSE(needs.contact || needs.twist);
  EXPECT_EQ(bound_of(spec).force_n, kMax);
  EXPECT_EQ(bound_of(spec).external_force_n, kMax);
  EXPECT_EQ(bound_of(spec).external_torque_nm, kMaxTorque);
  EXPECT_EQ(bound_of(spec).stiffness_n_per_m, 0.0);
  EXPECT_EQ(bound_of(spec).energy_per_metre_j, 0.0) << "its way alone allows nothing";
  EXPECT_EQ(external_of(std::vector{spec})->name, "external");
  EXPECT_EQ(external_of({}), nullptr);
}

TEST(RosTopic, TakesAbsoluteNamesOnlyAndReportsWhatIsWrong) {
  for (const char* good : {"/sim/wrench", "/w", "/a_b/c9/_d"})
    EXPECT_EQ(fault_of_ros_topic(good), "") << good;
  for (const char* bad : {"", "/", "wrench", "sim/wrench", "/sim/", "//w", "/9a", "/a b", "/a-b",
                          "/a/../b", "/a\n", "~/w", "/é"})
    EXPECT_NE(fault_of_ros_topic(bad), "") << bad;
  EXPECT_NE(fault_of_ros_topic("/" + std::string(200, 'a')), "");
}

}  // namespace external_test
}  // namespace voxtouch::effects
