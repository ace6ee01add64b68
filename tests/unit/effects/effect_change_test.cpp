#include "core/effects/effect_change.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/effects/effect_chain.hpp"

namespace voxtouch::effects {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInf = std::numeric_limits<double>::infinity();

enum : std::size_t { kForce, kAlong, kLow, kHigh, kWay, kTurning };
constexpr std::array kPushParameters = {
    EffectParameter{.name = "force_n", .high = 2.0, .standard = {{1.0, 0.0, 0.0}}},
    EffectParameter{
        .name = "along", .shape = ParameterShape::kDirection, .standard = {{1.0, 0.0, 0.0}}},
    EffectParameter{.name = "low", .high = 10.0, .standard = {{1.0, 0.0, 0.0}}},
    EffectParameter{.name = "high", .high = 10.0, .standard = {{2.0, 0.0, 0.0}}},
    EffectParameter{.name = "way",
                    .shape = ParameterShape::kWord,
                    .standard = {{0.0, 0.0, 0.0}},
                    .words = "up down"},
    EffectParameter{.name = "turning_nm", .high = 1.0, .standard = {{0.0, 0.0, 0.0}}},
};

/// A constant force; its stiffness is bounded only below a `high` of 9.
class Push final : public Effect {
 public:
  void apply(const EffectFrame&, const EffectValues& values, EffectForce& sum) noexcept override {
    sum.wrench.force += values.number(kForce) * values.vector(kAlong);
  }
};

const EffectKind kPush = {
    .name = "push",
    .summary = "",
    .equations = "",
    .parameters = kPushParameters,
    .needs =
        [](const EffectValues& v) {
          EffectNeeds needs;
          needs.torque = v.number(kTurning) > 0.0;
          return needs;
        },
    .bound =
        [](const EffectValues& v) {
          EffectBound bound;
          bound.stiffness_n_per_m = v.number(kHigh) > 9.0 ? kInf : 10.0 * v.number(kHigh);
          return bound;
        },
    .check = [](const EffectValues& v) -> std::string {
      return v.number(kLow) <= v.number(kHigh) ? "" : "'low' must not be above 'high'";
    },
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<Push>()); },
};

std::vector<EffectSpec> two_pushes() {
  const EffectSpec one{
      .name = "push", .kind = &kPush, .values = EffectValues(kPushParameters), .region = {}};
  EffectSpec other = one;
  other.name = "push2";
  return {one, other};
}

std::string refusal(const EffectRequest& request) {
  const auto judged = judge(two_pushes(), request);
  return judged ? "" : judged.error();
}
EffectRequest value(std::string_view parameter, const std::array<double, 3>& v) {
  return {.action = EffectAction::kValue, .effect = "push", .parameter = parameter, .value = v};
}
EffectRequest gain(double g) {
  return {.action = EffectAction::kGain, .effect = "push", .parameter = {}, .value = {g}};
}

TEST(EffectChange, FindsEffectAndParameterByName) {
  const auto judged = judge(two_pushes(), {.action = EffectAction::kValue,
                                           .effect = "push2",
                                           .parameter = "high",
                                           .value = {3.0, kNan, 7.0}});
  ASSERT_TRUE(judged) << judged.error();
  EXPECT_EQ(judged->effect, 1U);
  EXPECT_EQ(judged->parameter, kHigh);
  EXPECT_EQ(judged->value, (std::array{3.0, 0.0, 0.0}))
      << "what does not count must not reach the loop";
}

TEST(EffectChange, BringsADirectionToUnitLength) {
  const auto judged = judge(two_pushes(), value("along", {0.0, 3.0, 4.0}));
  ASSERT_TRUE(judged) << judged.error();
  EXPECT_NEAR(judged->value[1], 0.6, 1e-15);
  EXPECT_NEAR(judged->value[2], 0.8, 1e-15);
}

TEST(EffectChange, RefusesWithAMessageWhatCannotRun) {
  for (const double bad : {kNan, kInf, -kInf, -0.1, 1.1})
    EXPECT_NE(refusal(gain(bad)), "") << bad;
  for (const double bad : {kNan, kInf, -1.0, 2.1})
    EXPECT_NE(refusal(value("force_n", {bad, 0, 0})), "") << bad;
  for (const double bad : {kNan, 0.5, 2.0})
    EXPECT_NE(
        refusal(
            {.action = EffectAction::kSwitch, .effect = "push", .parameter = {}, .value = {bad}}),
        "")
        << bad;
  for (const auto& bad :
       {std::array{0.0, 0.0, 0.0}, std::array{kNan, 0.0, 1.0}, std::array{kInf, 0.0, 0.0}})
    EXPECT_NE(refusal(value("along", bad)), "") << bad[0];
  EXPECT_NE(refusal(value("low", {3, 0, 0})).find("'low'"), std::string::npos);
  EXPECT_NE(refusal(value("way", {1, 0, 0})).find("'way'"), std::string::npos);
  EXPECT_NE(refusal(value("turning_nm", {0.5, 0, 0})).find("not built"), std::string::npos);
  EXPECT_NE(refusal(value("high", {9.5, 0, 0})).find("stiffness"), std::string::npos);
  EXPECT_NE(refusal(value("colour", {1, 0, 0})).find("force_n, along"), std::string::npos);
  EXPECT_NE(
      refusal({.action = EffectAction::kGain, .effect = "pull", .parameter = {}, .value = {1}})
          .find("push, push2"),
      std::string::npos);
  EXPECT_FALSE(judge({}, gain(1.0)).has_value());
}

TEST(EffectChange, ChecksACombinedRequestByItsResult) {
  const auto together = [](const std::vector<EffectRequest>& requests) {
    return judge(two_pushes(), requests);
  };
  const EffectRequest low = value("low", {5.0}), high = value("high", {6.0});
  EXPECT_NE(refusal(low), "") << "above the `high` of 2";
  for (const auto& both : {std::vector{low, high}, std::vector{high, low}}) {
    const auto judged = together(both);
    ASSERT_TRUE(judged) << judged.error();
    EXPECT_EQ(judged->size(), 2U);
  }
  EXPECT_TRUE(together({low, value("high", {4.0})}).error().contains("'high'"));
  EXPECT_EQ(together({high, gain(1.5)}).error(), refusal(gain(1.5)));
  EXPECT_EQ(together({gain(0.5), value("force_n", {kNan})}).error(),
            refusal(value("force_n", {kNan})));
  EXPECT_FALSE(together({value("turning_nm", {0.5}), high})) << "torque was not built";
  EXPECT_FALSE(together({value("high", {9.5}), gain(0.5)})) << "nothing bounds the stiffness";
  EXPECT_TRUE(together({}));
}

TEST(EffectChange, QuotesNoControlCharacters) {
  const std::string quote = quotable("a\x1b[2J\n" + std::string(500, 'x'));
  EXPECT_EQ(quote.substr(0, 6), "a?[2J?");
  EXPECT_LT(quote.size(), 70U);
}

TEST(EffectChange, SpecMatchesTheChain) {
  std::vector<EffectSpec> specs = two_pushes();
  EffectChain chain(specs);
  for (const EffectRequest& request :
       {value("force_n", {0.25, 0, 0}), value("along", {0, 0, 2}), gain(0.5)}) {
    const auto judged = judge(specs, request);
    ASSERT_TRUE(judged) << judged.error();
    chain.carry_out(*judged);
    carry_out(specs[judged->effect], *judged);
  }
  EffectFrame frame;
  frame.dt_s = 0.001;
  Vec3 last = Vec3(2, 0, 0);
  for (int i = 0; i < 110; ++i) {
    const Vec3 force = chain.apply(frame).wrench.force;
    ASSERT_LT((force - last).norm(), 0.05) << i;
    last = force;
  }
  EXPECT_NEAR((last - Vec3(1.0, 0, 0.125)).norm(), 0.0, 1e-12);
  EXPECT_EQ(chain.spec(0).values, specs[0].values);
  EXPECT_EQ(chain.spec(0).gain, specs[0].gain);
}

}  // namespace
}  // namespace voxtouch::effects
