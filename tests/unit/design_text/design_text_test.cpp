// Sentences about designs: every limit has one, with its values, and a refusal has them all.
#include "nodes/design_text/design_text.hpp"

#include <gtest/gtest.h>

#include <set>

namespace voxtouch::design_text {
namespace {

using coupling::design::Design;
using coupling::design::DesignLimit;

Design some_design() {
  Design design;
  design.spec.damping_force_ratio = 0.7;
  for (coupling::design::AxisDesign* axis : {&design.translation, &design.rotation}) {
    axis->requested_stiffness = 800.0, axis->displayed_stiffness = 300.0;
    axis->worst_case = {
        {.mass = 0.08, .hand_mass = 0.1, .hand_damping = 3, .hand_stiffness = 200}, true, true};
  }
  return design;
}

std::string sentence(DesignLimit what, std::size_t axis = 0) {
  Design design = some_design();
  design.reasons = {{what, axis, {11.0, 12.0, 13.0, 14.0, 15.0}}};
  return reasons_of(design).at(0);
}

TEST(DesignText, EveryLimitHasItsOwnSentence) {
  std::set<std::string> seen;
  const int count = static_cast<int>(DesignLimit::kSlowVelocity) + 1;
  for (int limit = 0; limit < count; ++limit) {
    const std::string text = sentence(static_cast<DesignLimit>(limit));
    ASSERT_FALSE(text.empty()) << limit;
    EXPECT_EQ(text.back(), '.') << text;
    seen.insert(text);
  }
  EXPECT_EQ(std::ssize(seen), count);
}

TEST(DesignText, HasTheValuesInTheUnitsOfTheirAxis) {
  EXPECT_TRUE(sentence(DesignLimit::kDeviceStiffness).contains("11 N/m"));
  EXPECT_TRUE(sentence(DesignLimit::kDeviceStiffness, 1).contains("11 Nm/rad"));
  EXPECT_TRUE(sentence(DesignLimit::kFilterLag).contains("12 N/m and 13 Nm/rad"));
  EXPECT_TRUE(
      sentence(DesignLimit::kMinDampingCost).contains("11 of 311 N/m and 12 of 312 Nm/rad"));
  for (const char* value : {"11 of", "12)", "1.3e+03 %", "1.4e+03 %", "1.5e+03 %"})
    EXPECT_TRUE(sentence(DesignLimit::kDampingForceRatio).contains(value)) << value;
}

TEST(DesignText, NamesTheWorstCase) {
  Design design = some_design();
  EXPECT_EQ(worst_case_of(design, 0), "gripped (0.1 kg, 3 Ns/m, 200 N/m), 0.08 kg, slowest timing");
  design.translation.any_passive_hand = true;
  EXPECT_EQ(worst_case_of(design, 0), "a passive hand");
  EXPECT_EQ(worst_case_of(Design{}, 0), "");
  EXPECT_EQ(case_of({}), "");
  EXPECT_EQ(case_of({0.2, 1, {{.mass = 0.5}}}), "Rotation: released, 0.5 kg m^2");
  EXPECT_TRUE(out_of_reach({0.2, 1, {{.mass = 0.5}}}).contains("0.2"));
}

TEST(DesignText, OfARefusalHasAllReasonsAndTheRemedy) {
  device_fit::Refusal refusal;
  EXPECT_EQ(sentence_of(refusal), "");
  refusal.in_transition = true;
  EXPECT_EQ(sentence_of(refusal), "");
  refusal.error = "Too much.";
  EXPECT_TRUE(sentence_of(refusal).starts_with("Too much. ("));
  refusal = {{}, "stylus", some_design()};
  refusal.infeasible->reasons = {{DesignLimit::kStability, 0, {}},
                                 {DesignLimit::kDeviceStiffness, 1, {11.0, 12.0}}};
  const std::string text = sentence_of(refusal);
  EXPECT_FALSE(refusal.empty());
  for (const char* part : {"stylus", "Translation: gripped", "Rotation: device limit",
                           "coupling.run_infeasible: true", "300 N/m"})
    EXPECT_TRUE(text.contains(part)) << text;
}

TEST(DesignText, NotesOnDampingAreThoseThatApply) {
  coupling::CouplingSpec spec;
  EXPECT_TRUE(damping_notes(spec).empty());
  spec.injected_damping_ns_per_m = 2.0;
  EXPECT_EQ(damping_notes(spec).size(), 1U);
  spec.slow_velocity_hz = 16.0, spec.velocity_band_m_per_s = 5.4e-3;
  ASSERT_EQ(damping_notes(spec).size(), 2U);
  EXPECT_EQ(damping_notes(spec)[0],
            "uses a velocity filter of 16 Hz within 5.4 mm/s (encoder quantisation)");
}

}  // namespace
}  // namespace voxtouch::design_text
