// The scene's section `coupling`: by hand and designed.
#include <cmath>
#include <map>

#include "tests/unit/scene/scene_fixture.hpp"

namespace voxtouch::scene {
namespace {

class CouplingSection : public SceneFolder {
 protected:
  Scene with(const std::string& coupling) const {
    return parse(kSmall + "coupling: {" + coupling + "}\n");
  }
};

TEST_F(CouplingSection, RefusesAnEarlierKeyAndStatesItsName) {
  for (const auto& [key, name] :
       std::map<std::string, std::string>{{"damper_share", "damping_force_ratio"},
                                          {"damping_floor", "min_damping_ratio"},
                                          {"rotation_damping_floor", "rotation_min_damping_ratio"}})
    try {
      with("design: auto, " + key + ": 0.35");
      ADD_FAILURE() << key << " was read";
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find("'" + name + "'"), std::string::npos)
          << error.what();
    }
}

TEST_F(CouplingSection, SetByHandMayCapAndDamp) {
  const Scene s = with(
      "kind: direct, stiffness_cap_n_per_m: 800, stiffness_cap_nm_per_rad: 2.5, "
      "injected_damping_ns_per_m: 3, "
      "injected_damping_nms_per_rad: 0.01, velocity_filter_hz: 60, velocity_window: 3, "
      "slow_velocity_hz: 12, velocity_band_m_per_s: 0.004");
  EXPECT_FALSE(s.design);
  EXPECT_EQ(s.coupling.kind, "direct");
  EXPECT_EQ(s.coupling.stiffness_cap_n_per_m, 800);
  EXPECT_EQ(s.coupling.stiffness_cap_nm_per_rad, 2.5);
  EXPECT_EQ(s.coupling.injected_damping_ns_per_m, 3);
  EXPECT_EQ(s.coupling.injected_damping_nms_per_rad, 0.01);
  EXPECT_EQ(s.coupling.velocity_filter_hz, 60);
  EXPECT_EQ(s.coupling.velocity_window, 3U);
  EXPECT_EQ(s.coupling.slow_velocity_hz, 12);
  EXPECT_EQ(s.coupling.velocity_band_m_per_s, 0.004);
}

TEST_F(CouplingSection, AddsNoCapAndNoDampingByDefault) {
  const Scene s = with("gain: 0.5");
  EXPECT_FALSE(s.design);
  EXPECT_TRUE(std::isinf(s.coupling.stiffness_cap_n_per_m) &&
              std::isinf(s.coupling.stiffness_cap_nm_per_rad));
  EXPECT_EQ(s.coupling.injected_damping_ns_per_m + s.coupling.injected_damping_nms_per_rad, 0);
}

TEST_F(CouplingSection, ADesignHasDefaultsForAllItsKeys) {
  const Scene s = with("design: auto");
  ASSERT_TRUE(s.design);
  EXPECT_EQ(s.design->kind, "auto");
  EXPECT_EQ(s.design->cutoff_hz, 5);
  EXPECT_EQ(s.design->gain_margin, 2);
  EXPECT_FALSE(s.design->stiffness_cap_n_per_m || s.design->stiffness_cap_nm_per_rad);
  EXPECT_EQ(s.design->hand, HandOption::kAsDeviceIsHeld);
  EXPECT_TRUE(s.design->released && s.design->inject_damping);
  EXPECT_TRUE(s.design->velocity_windows);
  EXPECT_EQ(s.design->min_damping_ratio, 0.3);
  EXPECT_EQ(s.design->rotation_min_damping_ratio, 0.0);
  EXPECT_FALSE(s.design->run_infeasible);
  EXPECT_TRUE(s.warnings.empty());
}

TEST_F(CouplingSection, EveryKeyOfADesignArrives) {
  const Scene s = with(
      "design: auto, kind: shaping_filter, cutoff_hz: 7, gain_margin: 1, stiffness_cap_n_per_m: "
      "700, "
      "stiffness_cap_nm_per_rad: 0.25, hand: arm, released: false, inject_damping: false, "
      "velocity_windows: false, min_damping_ratio: 0.2, rotation_min_damping_ratio: 0.1, "
      "run_infeasible: "
      "true");
  ASSERT_TRUE(s.design);
  EXPECT_EQ(s.design->kind, "shaping_filter");
  EXPECT_EQ(s.design->cutoff_hz, 7);
  EXPECT_EQ(s.design->gain_margin, 1);
  EXPECT_EQ(s.design->stiffness_cap_n_per_m, 700);
  EXPECT_EQ(s.design->stiffness_cap_nm_per_rad, 0.25);
  EXPECT_EQ(s.design->hand, HandOption::kArm);
  EXPECT_FALSE(s.design->released || s.design->inject_damping);
  EXPECT_FALSE(s.design->velocity_windows);
  EXPECT_EQ(s.design->min_damping_ratio, 0.2);
  EXPECT_EQ(s.design->rotation_min_damping_ratio, 0.1);
  EXPECT_TRUE(s.design->run_infeasible);
  EXPECT_EQ(with("design: auto, kind: spring_damper").design->kind, "spring_damper");
  EXPECT_EQ(with("design: auto, cutoff_hz: 150").warnings.size(), 1U)
      << "a cut-off near the sample rate gives a warning";
  EXPECT_NE(with("design: auto").hash, with("design: auto, gain_margin: 2").hash);
}

TEST_F(CouplingSection, TakesTheDampingRatioFromSceneOrDefault) {
  EXPECT_EQ(with("design: auto").design->damping_force_ratio, std::nullopt);
  EXPECT_EQ(with("design: auto, damping_force_ratio: 0.35").design->damping_force_ratio, 0.35);
  EXPECT_EQ(with("design: auto, damping_force_ratio: 0").design->damping_force_ratio, 0.0);
  EXPECT_EQ(with("injected_damping_ns_per_m: 3").coupling.damping_force_ratio, 0.35);
  EXPECT_EQ(
      with("injected_damping_ns_per_m: 3, damping_force_ratio: 0.2").coupling.damping_force_ratio,
      0.2);
}

TEST_F(CouplingSection, AHandMayBeGivenInRanges) {
  const std::string translation =
      "mass_kg: [0.1, 0.2], damping_ns_per_m: [0, 3], stiffness_n_per_m: [5, 5]";
  const DesignOptions half = *with("design: auto, hand: {" + translation + "}").design;
  EXPECT_EQ(half.hand, HandOption::kGiven);
  EXPECT_FALSE(half.given_rotation);
  const DesignOptions whole = *with("design: auto, hand: {" + translation +
                                    ", inertia_kg_m2: [1, 2], damping_nms_per_rad: "
                                    "[3, 4], stiffness_nm_per_rad: [5, 6]}")
                                   .design;
  const coupling::design::OperatorRange hand = operator_range(whole, coupling::design::Grip::kPen);
  EXPECT_EQ(hand.translation.mass_min, 0.1);
  EXPECT_EQ(hand.translation.mass_max, 0.2);
  EXPECT_EQ(hand.translation.damping_min, 0);
  EXPECT_EQ(hand.translation.damping_max, 3);
  EXPECT_EQ(hand.translation.stiffness_min, 5);
  EXPECT_EQ(hand.translation.stiffness_max, 5);
  EXPECT_EQ(hand.rotation.mass_min, 1);
  EXPECT_EQ(hand.rotation.mass_max, 2);
  EXPECT_EQ(hand.rotation.damping_min, 3);
  EXPECT_EQ(hand.rotation.damping_max, 4);
  EXPECT_EQ(hand.rotation.stiffness_min, 5);
  EXPECT_EQ(hand.rotation.stiffness_max, 6);
  EXPECT_EQ(operator_range(half, coupling::design::Grip::kArm).rotation.mass_max,
            hand_range(coupling::design::Grip::kArm).rotation.mass_max)
      << "what is not given is the device's grip";
}

TEST(HandRanges, AreNamedOrTheDevicesOwn) {
  DesignOptions ask;
  EXPECT_EQ(operator_range(ask, coupling::design::Grip::kPen).translation.mass_max, 0.2);
  EXPECT_EQ(operator_range(ask, coupling::design::Grip::kArm).translation.mass_max, 2.0);
  ask.hand = HandOption::kPen;
  EXPECT_EQ(operator_range(ask, coupling::design::Grip::kArm).translation.mass_max, 0.2)
      << "the scene has the last word";
  EXPECT_TRUE(operator_range(ask, coupling::design::Grip::kArm).translation.may_release);
  ask.hand = HandOption::kArm, ask.released = false;
  const coupling::design::OperatorRange held = operator_range(ask, coupling::design::Grip::kPen);
  EXPECT_EQ(held.rotation.stiffness_max, 15.0);
  EXPECT_FALSE(held.translation.may_release || held.rotation.may_release ||
               held.translation.any_passive);
  ask.hand = HandOption::kAnyPassive, ask.released = true;
  const coupling::design::OperatorRange any = operator_range(ask, coupling::design::Grip::kPen);
  EXPECT_TRUE(any.translation.any_passive && any.rotation.any_passive &&
              any.translation.may_release);
}

TEST(HandRanges, AreRangesAndTheArmIsTheHeavierHand) {
  const coupling::design::OperatorRange pen = hand_range(coupling::design::Grip::kPen),
                                        arm = hand_range(coupling::design::Grip::kArm);
  for (const coupling::design::HandRange& r :
       {pen.translation, pen.rotation, arm.translation, arm.rotation}) {
    EXPECT_TRUE(r.mass_min > 0 && r.mass_min < r.mass_max);
    EXPECT_TRUE(r.damping_min > 0 && r.damping_min < r.damping_max);
    EXPECT_TRUE(r.stiffness_min > 0 && r.stiffness_min < r.stiffness_max);
  }
  EXPECT_GT(arm.translation.mass_min, pen.translation.mass_max);
  EXPECT_GT(arm.rotation.mass_min, pen.rotation.mass_max);
  coupling::design::Grip grip = coupling::design::Grip::kPen;
  EXPECT_TRUE(coupling::design::parse_grip("arm", grip));
  EXPECT_EQ(grip, coupling::design::Grip::kArm);
  EXPECT_FALSE(coupling::design::parse_grip("fist", grip));
  EXPECT_EQ(grip, coupling::design::Grip::kArm);
  EXPECT_EQ(coupling::design::name_of(coupling::design::Grip::kPen), "pen");
}

}  // namespace
}  // namespace voxtouch::scene
