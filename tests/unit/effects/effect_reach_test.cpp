// Intermediate states of changes of effects: none exceeds the stated bounds.
#include "core/effects/effect_reach.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/effects/effect_chain.hpp"
#include "core/effects/effect_change.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/effects/chain_change.hpp"

namespace voxtouch::effects {
namespace {

EffectSpec oil(double damping) {
  const EffectKind* kind = find_effect_kind("viscosity");
  EffectSpec spec{
      .name = "oil", .kind = kind, .values = EffectValues(kind->parameters), .region = {}};
  spec.values.at(0)[0] = damping;
  return spec;
}

TEST(EffectReach, IsTheMaximumOfOldAndNewValues) {
  EffectReach reach(oil(3.0));
  EXPECT_EQ(reach.bound().damping_ns_per_m, 3.0);
  reach.widen(oil(0.5));
  EXPECT_EQ(reach.bound().damping_ns_per_m, 3.0) << "it is still on its way";
  EXPECT_EQ(reach.spec().values.number(0), 0.5);
  reach.widen(oil(7.0));
  EXPECT_EQ(reach.bound().damping_ns_per_m, 7.0);
}

/// Numbers that two changes move one after the other may occur in any combination: a magnet's
/// stiffness follows from force / radius.
TEST(EffectReach, CountsCombinationsThatNoStateHasHad) {
  const EffectKind* kind = find_effect_kind("magnet");
  EffectSpec weak{
      .name = "m", .kind = kind, .values = EffectValues(kind->parameters), .region = {}};
  weak.values.at(0) = {0.0, 0.0, 0.0}, weak.values.at(1)[0] = 0.01, weak.values.at(2)[0] = 0.1;
  EffectSpec wide = weak;
  wide.values.at(1)[0] = 0.1, wide.values.at(2)[0] = 1.0;
  EffectReach reach(weak);
  reach.widen(wide);
  EXPECT_NEAR(reach.bound().stiffness_n_per_m, 10.0 * bound_of(weak).stiffness_n_per_m, 1e-9);
}

double within(double low, double high, std::mt19937_64& random) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Random valid values of the kind, by trial; false if none was found.
bool draw(EffectSpec& spec, double word, std::mt19937_64& random) {
  for (int tries = 0; tries < 2000; ++tries) {
    for (std::size_t p = 0; p < spec.values.size(); ++p) {
      const EffectParameter& parameter = spec.kind->parameters[p];
      const double high = std::min(parameter.high, parameter.low + 100.0);
      switch (parameter.shape) {
        case ParameterShape::kNumber: {
          const double number = within(parameter.low, high, random);
          const auto kind = random() % 4;
          spec.values.at(p) = {kind == 0   ? parameter.low
                               : kind == 1 ? std::round(number)
                                           : number,
                               0.0, 0.0};
          break;
        }
        case ParameterShape::kVector:
          spec.values.at(p) = {0.3 * high, 0.2 * high, 0.1 * high};
          break;
        case ParameterShape::kDirection:
          spec.values.at(p) = {0.0, 0.0, 1.0};
          break;
        case ParameterShape::kWord:
          spec.values.at(p) = {word, 0.0, 0.0};
          break;
        case ParameterShape::kText:
          break;
      }
    }
    if (check_values(*spec.kind, spec.values).empty())
      return true;
  }
  return false;
}

TEST(EffectReach, BoundsEveryIntermediateStateForEveryKind) {
  const std::uint64_t seed = testing::seed(20261122);
  SCOPED_TRACE(testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  for (const EffectKind* kind : effect_kinds()) {
    EffectSpec from{
        .name = "e", .kind = kind, .values = EffectValues(kind->parameters), .region = {}},
        to = from;
    for (int pair = 0; pair < 200; ++pair) {
      const double word = pair % 2;
      ASSERT_TRUE(draw(from, word, random) && draw(to, word, random)) << kind->name;
      EffectReach reach(from);
      reach.widen(to);
      const EffectBound most = reach.bound();
      for (int state = 0; state < 20; ++state) {
        EffectSpec at = from;
        for (std::size_t p = 0; p < at.values.size(); ++p)
          if (kind->parameters[p].shape == ParameterShape::kNumber)
            at.values.at(p)[0] +=
                within(0.0, 1.0, random) * (to.values.number(p) - from.values.number(p));
        const EffectBound now = bound_of(at);
        ASSERT_LE(now.stiffness_n_per_m, most.stiffness_n_per_m * (1 + 1e-9)) << kind->name;
        ASSERT_LE(now.stiffness_nm_per_rad, most.stiffness_nm_per_rad * (1 + 1e-9)) << kind->name;
        ASSERT_LE(now.damping_ns_per_m, most.damping_ns_per_m * (1 + 1e-9)) << kind->name;
        ASSERT_LE(now.damping_nms_per_rad, most.damping_nms_per_rad * (1 + 1e-9)) << kind->name;
        ASSERT_LE(now.external_force_n, most.external_force_n * (1 + 1e-9)) << kind->name;
        ASSERT_LE(now.external_torque_nm, most.external_torque_nm * (1 + 1e-9)) << kind->name;
      }
    }
  }
}

TEST(EffectChainAtRest, IsReachedOnceAllValuesArrived) {
  EffectChain chain({oil(3.0)});
  EXPECT_TRUE(chain.at_rest());
  ASSERT_EQ(test::set_value(chain, "damping_ns_per_m", {1.0, 0.0, 0.0}), "");
  EffectFrame frame;
  frame.dt_s = 0.001;
  int samples = 0;
  for (; !chain.at_rest() && samples < 1000; ++samples)
    chain.apply(frame);
  EXPECT_NEAR(samples, 100, 1);
  EXPECT_EQ(chain.values(0).number(0), 1.0);
}

}  // namespace
}  // namespace voxtouch::effects
