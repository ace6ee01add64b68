/// A small, fixed part of tests/experiments/coupling_campaign.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/experiments/coupling_campaign/campaign.hpp"

namespace voxtouch::campaign {
namespace {

Options sample(std::uint64_t members) {
  Options out;
  out.seed = 20240607, out.members = members, out.corners = false, out.limits = 0;
  return out;
}

std::string failures(const PhaseResult& result) {
  std::string out;
  for (const Failure& f : result.failures)
    out += f.setting + ": member " + std::to_string(f.index) + ": " + f.details + "\n";
  return out;
}

double figure(const PhaseResult& result, std::string_view name) {
  for (const Figure& f : result.figures)
    if (f.name == name)
      return f.value;
  ADD_FAILURE() << "no figure " << name;
  return 0.0;
}

double unstable_ratio(PhaseResult& result, const std::string& kind) {
  const Tally& t = result.tally(kind);
  return static_cast<double>(t.unstable) / static_cast<double>(t.runs);
}

/// At 1.9 times the certified stiffness a bounded damper may not suffice for a large oscillation,
/// which has a margin of 1.5: that row is only reported. The residual damping of a bounded damper
/// in a large oscillation is a describing-function estimate. At 1.4 times the certified stiffness,
/// at the slowest timing, one of these designs with a ratio above the standard one keeps
/// oscillating.
TEST(Campaign, NoDesignBecomesUnstable) {
  PhaseResult result = design_phase(sample(75));
  std::erase_if(result.failures,
                [](const Failure& f) { return f.setting.starts_with("1.9 times"); });
  EXPECT_LE(std::erase_if(result.failures,
                          [](const Failure& f) { return f.setting.starts_with("1.4 times"); }),
            1U);
  EXPECT_TRUE(result.failures.empty()) << failures(result);
  std::uint64_t runs = 0;
  for (const Tally& t : result.tallies)
    runs += t.runs;
  EXPECT_GT(runs, 280u);
}

/// 17 kg, 84 Ns/m and an encoder whose steps cause pulses of some tenths of a newton, while the law
/// gives 0.04 N: cut to 0.05 N they still damp.
TEST(Campaign, ACoarseEncodersDamperStillDampsALightContact) {
  Options options = sample(1);
  options.seed = 1, options.first = 2327;
  PhaseResult result = design_phase(options);
  EXPECT_EQ(result.tally("worst vertex, up to a period of delay more").runs, 1U);
  EXPECT_TRUE(result.failures.empty()) << failures(result);
}

TEST(Campaign, FindsTooStiffDesigns) {
  Options options = sample(12);
  options.overload = 4.0;
  EXPECT_GT(design_phase(options).failures.size(), 12u);
}

/// The margin of 2 is a linear one; an oscillation that leaves the contact has 1.5, and so has one
/// within the encoder's steps, which the slow velocity damps. Excess beyond it, at the certified
/// timing, is conservatism; at the nominal timing the figure also includes the allowance for jitter
/// and lost samples.
TEST(Campaign, CertificatesKeepTheirMarginInSimulation) {
  Options options = sample(24);
  options.limits = 16;
  const PhaseResult result = design_phase(options);
  EXPECT_GE(figure(result, "limit / promise, slowest timing, least"), 1.5);
  EXPECT_LE(figure(result, "limit / promise, slowest timing, median"), 2.3);
  EXPECT_GE(figure(result, "limit / promise, nominal timing, least"), 1.8);
}

TEST(Campaign, TheLiteralRecipeIsUnstableOnMostDevices) {
  PhaseResult result = recipe_phase(sample(60));
  EXPECT_GT(unstable_ratio(result, "released"), 0.7);
  EXPECT_GT(unstable_ratio(result, "gripped"), 0.4);
  EXPECT_GT(unstable_ratio(result, "released, with the device's friction"), 0.3);
  EXPECT_LT(unstable_ratio(result, "released, with the device's friction"),
            unstable_ratio(result, "released"));
}

TEST(Campaign, LinearStabilityHoldsInSimulation) {
  PhaseResult result = predictor_phase(sample(100));
  EXPECT_TRUE(result.failures.empty()) << failures(result);
  EXPECT_GT(unstable_ratio(result, "nominal gain margin below 1, wall of one slope"), 0.8);
}

TEST(Campaign, IsReproducibleForASeed) {
  const auto report = [](std::uint64_t seed) {
    Options options = sample(6);
    options.seed = seed;
    return as_json({recipe_phase(options), design_phase(options), predictor_phase(options)});
  };
  EXPECT_EQ(report(1), report(1));
  EXPECT_EQ(nlohmann::json::parse(report(1)).size(), 3u);
}

TEST(Campaign, AMemberCanBeRepeatedAlone) {
  Options options = sample(4);
  options.overload = 8.0;
  const PhaseResult all = design_phase(options);
  ASSERT_FALSE(all.failures.empty());
  const Failure& last = all.failures.back();
  options.first = last.index, options.members = 1;
  const PhaseResult alone = design_phase(options);
  ASSERT_FALSE(alone.failures.empty());
  EXPECT_EQ(alone.failures.back().details, last.details);
}

}  // namespace
}  // namespace voxtouch::campaign
