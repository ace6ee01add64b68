#include "core/effects/effect_chain.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/effects/chain_change.hpp"

namespace voxtouch::effects {
namespace {

/// A spring to the origin, U = k x^2 / 2: known in every place.
enum : std::size_t { kStiffness };
constexpr std::array kSpringParameters = {
    EffectParameter{.name = "stiffness_n_per_m", .high = 1000.0}};
bool broken = false;

class Spring final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& push) noexcept override {
    const double k = values.number(kStiffness);
    const Vec3& x = frame.tool.position;
    push.wrench.force -= k * x;
    if (broken)
      push.wrench.force.x() = std::numeric_limits<double>::quiet_NaN();
    push.stiffness.topLeftCorner<3, 3>().diagonal().array() += k;
    push.stiffness_bound_n_per_m += k;
    push.potential_j += 0.5 * k * x.squaredNorm();
  }
};

const EffectKind kSpring = {
    .name = "spring",
    .summary = "",
    .equations = "",
    .parameters = kSpringParameters,
    .needs = [](const EffectValues&) { return EffectNeeds{}; },
    .bound =
        [](const EffectValues& v) {
          EffectBound bound;
          bound.stiffness_n_per_m = v.number(kStiffness), bound.force_n = 40.0,
          bound.potential_j = 4.0;
          return bound;
        },
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<Spring>()); },
};

EffectSpec spring(double k) {
  EffectSpec spec{
      .name = "spring", .kind = &kSpring, .values = EffectValues(kSpringParameters), .region = {}};
  spec.values.at(kStiffness)[0] = k;
  return spec;
}

EffectFrame at(const Vec3& x) {
  EffectFrame frame;
  frame.tool.position = x, frame.dt_s = 0.001;
  return frame;
}

TEST(EffectKinds, AreSortedAndFullyDescribed) {
  std::string_view last;
  for (const EffectKind* kind : effect_kinds()) {
    EXPECT_GT(kind->name, last);
    last = kind->name;
    EXPECT_EQ(find_effect_kind(kind->name), kind);
    EXPECT_FALSE(kind->summary.empty()) << kind->name;
    EXPECT_FALSE(kind->equations.empty()) << kind->name;
    for (const EffectParameter& p : kind->parameters) {
      EXPECT_FALSE(p.meaning.empty()) << kind->name << "." << p.name;
      EXPECT_LE(p.low, p.high);
      EXPECT_EQ(p.words.empty(), p.shape != ParameterShape::kWord);
      EXPECT_EQ(p.pattern.empty(), p.shape != ParameterShape::kText);
    }
    ASSERT_NE(kind->needs, nullptr);
    ASSERT_NE(kind->bound, nullptr);
    ASSERT_NE(kind->make(), nullptr);
  }
  EXPECT_EQ(find_effect_kind("nothing"), nullptr);
}

TEST(EffectChain, WithoutEffectsGivesNothing) {
  EffectChain chain({});
  const EffectForce push = chain.apply(at(Vec3(1, 2, 3)));
  EXPECT_TRUE(push.wrench.zero());
  EXPECT_TRUE(push.stiffness.isZero(0.0));
}

TEST(EffectChain, ARegionKeepsAConservativeEffectConservative) {
  EffectSpec spec = spring(100);
  spec.region = {SphereRegion{Vec3(0.1, 0, 0), 0.03}, 0.02};
  spec.gain = 0.5;
  EffectChain chain({spec});
  const auto potential = [&](const Vec3& x) { return chain.apply(at(x)).potential_j; };
  for (const Vec3& x : {Vec3(0.1, 0.01, 0), Vec3(0.1, 0.038, 0.01), Vec3(0.06, 0.01, -0.01),
                        Vec3(0.13, 0.02, 0.02)}) {
    const EffectForce push = chain.apply(at(x));
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = 1e-6 * Vec3::Unit(axis);
      EXPECT_NEAR(-(potential(x + step) - potential(x - step)) / 2e-6, push.wrench.force[axis],
                  1e-6);
      const Vec3 change =
          (chain.apply(at(x + step)).wrench.force - chain.apply(at(x - step)).wrench.force) / 2e-6;
      EXPECT_LE(change.norm(), push.stiffness_bound_n_per_m * (1 + 1e-6));
    }
  }
  EXPECT_TRUE(chain.apply(at(Vec3(0.2, 0, 0))).wrench.zero());
  EXPECT_GT(bound_of(spec).stiffness_n_per_m, 100.0);
}

TEST(EffectChain, ChangesWhileRunningAreRampsAndNoSteps) {
  EffectChain chain({spring(100)});
  const EffectFrame frame = at(Vec3(0.1, 0, 0));
  double force = chain.apply(frame).wrench.force.x();
  EXPECT_DOUBLE_EQ(force, -10.0);
  const auto settle = [&](double expected) {
    for (int n = 0; n < 101; ++n) {
      const double now = chain.apply(frame).wrench.force.x();
      EXPECT_LE(std::abs(now - force), 0.31);
      force = now;
    }
    EXPECT_NEAR(force, expected, 1e-9);
  };
  EXPECT_EQ(test::set_value(chain, "stiffness_n_per_m", {400, 0, 0}), "");
  settle(-40);
  const auto heads_for = [&](EffectAction action, double goal) {
    EXPECT_EQ(
        test::change(
            chain, {.action = action, .effect = "spring", .parameter = {}, .value = {goal, 0, 0}}),
        "");
  };
  heads_for(EffectAction::kGain, 0.5);
  settle(-20);
  heads_for(EffectAction::kSwitch, 0.0);
  settle(0);
  heads_for(EffectAction::kSwitch, 1.0);
  settle(-20);
}

TEST(EffectChain, RefusesAnInvalidStiffness) {
  EXPECT_THROW(EffectChain({spring(2000)}), std::invalid_argument);
}

TEST(EffectChain, SkipsAndCountsANonFiniteEffect) {
  EffectChain chain({spring(100), spring(10)});
  broken = true;
  const EffectForce push = chain.apply(at(Vec3(0.1, 0, 0)));
  broken = false;
  EXPECT_TRUE(push.wrench.zero());
  EXPECT_EQ(chain.not_finite(), 2u);
  EXPECT_DOUBLE_EQ(chain.apply(at(Vec3(0.1, 0, 0))).wrench.force.x(), -11.0);
}

}  // namespace
}  // namespace voxtouch::effects
