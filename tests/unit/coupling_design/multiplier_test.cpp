/// Multipliers: closed forms, a loop that is stable with every linear contact and oscillates with a
/// nonlinear one, and refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/coupling/design/multiplier.hpp"

namespace voxtouch::testing {
namespace {

using namespace coupling::design;
using Weights = Multiplier::Weights;

/// L = gain z^-late.
LoopOverArc delay(double gain, int late) {
  return [=](const Arc& arc) {
    return LoopFraction{gain * arc.delay(late), arc.constant(1.0), false};
  };
}
/// L = (1 - a) z^-1 / (1 - a z^-1).
LoopOverArc first_order(double a) {
  return [=](const Arc& arc) {
    CircleValue bottom = arc.z_less_one();
    bottom.even = bottom.even + (1.0 - a);
    return LoopFraction{arc.constant(1.0 - a), bottom, false};
  };
}
/// L = 0.1 z / (z^2 - 1.8 z + 0.81), from the literature on counterexamples to the Kalman
/// conjecture in discrete time (Heath, Carrasco, de la Sen 2015). With linear contacts it is stable
/// below 36.1, where z^2 + (0.1 k - 1.8) z + 0.81 has a root at -1.
constexpr double kLinearLimit = 36.1;
LoopOverArc kalman() {
  return [](const Arc& arc) {
    CircleValue z = arc.z_less_one();
    z.even = z.even + 1.0;
    CircleValue less = arc.z_less_one();  // z - 0.9
    less.even = less.even + 0.1;
    return LoopFraction{0.1 * z, arc.times(less, less), false};
  };
}
/// A resonance at `angle`, 1e-5 rad wide, whose real part goes down to -depth between two points of
/// any grid.
LoopOverArc narrow_resonance(double angle, double depth) {
  constexpr double kDecay = 1e-5;
  const double r = 1.0 - kDecay;
  return [=](const Arc& arc) {
    CircleValue q = arc.z_less_one();
    const double b = 2.0 - 2.0 * r * std::cos(angle);
    CircleValue bottom = arc.times(q, q) + b * q;  // z^2 - 2 r cos(angle) z + r^2
    bottom.even = bottom.even + (b - 1.0 + r * r);
    // Its residue makes a circle of diameter 2 depth, centred on the negative real axis.
    CircleValue top = q;
    top.even = top.even + (1.0 - std::cos(angle));
    CircleValue z = q;
    z.even = z.even + 1.0;
    return LoopFraction{-2.0 * kDecay * depth * arc.times(z, top), bottom, false};
  };
}

ContactLoop before(LoopOverArc loop, double stiffness) {
  return {std::move(loop), 1.0 / stiffness, kMultiplierFloor / stiffness};
}
bool proves(const Multiplier& m, const ContactLoop& one) {
  return prove(m, std::span(&one, 1)).holds();
}
bool found(const ContactLoop& one) { return find_multiplier(std::span(&one, 1)).has_value(); }

/// Largest |x| of the last 100 of 3000 samples from x = 2, -12 on, with a contact that saturates.
double swings(double stiffness) {
  double last = 2.0;
  double x = -12.0;
  double most = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double force = stiffness * std::clamp(x, -1.0, 1.0);
    const double next = 1.8 * x - 0.81 * last - 0.1 * force;
    last = x;
    x = next;
    if (i >= 2900)
      most = std::max(most, std::abs(x));
  }
  return most;
}

/// M = 1 is the circle criterion: 1/K > -min Re L.
TEST(Multiplier, OneIsTheCircleCriterion) {
  const Multiplier one;
  for (const int late : {1, 2, 7}) {
    EXPECT_TRUE(proves(one, before(delay(2.0, late), 0.498))) << late;
    EXPECT_FALSE(proves(one, before(delay(2.0, late), 0.502))) << late;
  }
  for (const double a : {0.5, 0.9, 0.999}) {
    const double limit = (1.0 + a) / (1.0 - a);
    EXPECT_TRUE(proves(one, before(first_order(a), 0.998 * limit))) << a;
    EXPECT_FALSE(proves(one, before(first_order(a), 1.002 * limit))) << a;
  }
  // Re L of the counterexample has its least at its own angle; here by search.
  double least = 0.0;
  for (double angle = 1e-4; angle < std::numbers::pi; angle += 1e-5) {
    const Arc point(angle, 0.0);
    least = std::min(least, value_in_the_middle(kalman()(point), point).real());
  }
  EXPECT_TRUE(proves(one, before(kalman(), -0.998 / least)));
  EXPECT_FALSE(proves(one, before(kalman(), -1.002 / least)));
}

TEST(Multiplier, KeepsItsFloorUnderTheCircleCriterion) {
  const Multiplier one;
  ContactLoop loop{delay(1.0, 1), 1.0 / 0.9, 0.0};  // Re(1/K + L) >= 0.111
  loop.floor = 0.110;
  EXPECT_TRUE(proves(one, loop));
  loop.floor = 0.112;
  EXPECT_FALSE(proves(one, loop));
}

TEST(Multiplier, RejectsLoopsThatSaturationDestabilises) {
  EXPECT_LT(swings(12.0), 1e-9);
  EXPECT_GT(swings(20.0), 1.0) << "stable with every linear contact below " << kLinearLimit;
  EXPECT_TRUE(found(before(kalman(), 12.0)));
  for (const double stiffness : {20.0, 24.0, 30.0, 36.0})
    EXPECT_FALSE(found(before(kalman(), stiffness))) << stiffness;
}

/// Exchanged, the same weights shift the phase in the other direction.
TEST(Multiplier, PastAndFutureAreNotTheSame) {
  const std::optional<Multiplier> m = find_multiplier(std::array{before(kalman(), 12.0)});
  ASSERT_TRUE(m);
  const ContactLoop loop = before(kalman(), 12.0);
  EXPECT_TRUE(proves(*m, loop));
  EXPECT_FALSE(proves({m->at_rest, m->future, m->past}, loop));
}

/// The multiplier of the h_i of i = 1 .. N and i = -1 .. -N.
Multiplier multiplier_of(const Weights& past, const Weights& future) {
  Multiplier m{1.0, past, future};
  for (const double h : past)
    m.at_rest -= h;
  for (const double h : future)
    m.at_rest -= h;
  return m;
}

TEST(Multiplier, InvalidWeightsAreRefused) {
  const ContactLoop easy = before(delay(1.0, 1), 0.01);
  Weights past{}, future{};
  past[0] = 0.6;
  future[2] = 0.399;
  EXPECT_TRUE(proves(multiplier_of(past, future), easy));
  future[2] = 0.4;  // they sum up to 1
  EXPECT_FALSE(proves(multiplier_of(past, future), easy));
  future[2] = 0.8;
  EXPECT_FALSE(proves(multiplier_of(past, future), easy));
  future[2] = -0.1;
  EXPECT_FALSE(proves(multiplier_of(past, future), easy));
  future[2] = std::nan("");
  EXPECT_FALSE(proves(multiplier_of(past, future), easy));
}

/// L = 1/(z - 1): with M(1) < 0 the inequality would hold all the same, since L has no bound at
/// rest.
TEST(Multiplier, UnitWeightSumIsRefusedForAnIntegrator) {
  const LoopOverArc integrator = [](const Arc& arc) {
    return LoopFraction{arc.constant(1.0), arc.constant(1.0), true};
  };
  const ContactLoop loop = before(integrator, 1.0);
  Weights past{};
  past[0] = 0.99;
  EXPECT_TRUE(proves(multiplier_of(past, Weights{}), loop));
  for (const double h : {1.0, 1.01, 1.5}) {
    past[0] = h;
    EXPECT_FALSE(proves(multiplier_of(past, Weights{}), loop)) << h;
  }
}

TEST(Multiplier, NoGridMissesANarrowResonance) {
  const Multiplier one;
  for (const double angle : {0.0123456, 0.3456789, 1.2345678, 2.7654321}) {
    const ContactLoop inside = before(narrow_resonance(angle, 1.0), 0.99),
                      outside = before(narrow_resonance(angle, 1.0), 1.05);
    const MultiplierProof yes = prove(one, std::span(&inside, 1)),
                          no = prove(one, std::span(&outside, 1));
    EXPECT_TRUE(yes.holds()) << angle;
    EXPECT_FALSE(no.holds()) << angle;
    ASSERT_FALSE(no.refuted.empty());
    EXPECT_NEAR(no.refuted.front().angle, angle, 1e-4);
  }
}

TEST(Multiplier, OneServesAllLoopsOrNone) {
  const std::array both{before(kalman(), 10.0), before(first_order(0.9), 15.0)};
  const std::optional<Multiplier> m = find_multiplier(both);
  ASSERT_TRUE(m);
  for (const ContactLoop& one : both)
    EXPECT_TRUE(proves(*m, one));
  const std::array with_a_bad_one{before(kalman(), 10.0), before(first_order(0.9), 19.1)};
  EXPECT_FALSE(find_multiplier(with_a_bad_one));
  const MultiplierProof proof = prove(*m, with_a_bad_one);
  ASSERT_EQ(proof.refuted.size(), 1U);
  EXPECT_EQ(proof.refuted.front().loop, 1U);
}

TEST(Multiplier, IsReproducible) {
  const std::array loops{before(kalman(), 12.0), before(first_order(0.9), 15.0)};
  const std::optional<Multiplier> a = find_multiplier(loops), b = find_multiplier(loops);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->at_rest, b->at_rest);
  EXPECT_EQ(a->past, b->past);
  EXPECT_EQ(a->future, b->future);
}

}  // namespace
}  // namespace voxtouch::testing
