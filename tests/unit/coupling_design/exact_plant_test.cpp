#include "tests/support/coupling_models/exact_plant.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/coupling_models/random.hpp"

namespace voxtouch::coupling::design {
namespace {

struct Case {
  LoopPlant plant;
  double friction = 0.0, push = 0.0;
};

/// Plants of all kinds: free, gripped, under- and overdamped, undamped, with and without lag, also
/// a lag on a pole.
std::vector<Case> cases() {
  std::vector<Case> out;
  coupling_models::Random random(3);
  for (int i = 0; i < 200; ++i) {
    Case c;
    c.plant.mass = random.log_uniform(0.03, 24.0);
    c.plant.damping = i % 5 == 0 ? 0.0 : random.log_uniform(1e-3, 60.0);
    if (i % 3 != 0)
      c.plant.hand_stiffness = random.log_uniform(1e-2, 1e4),
      c.plant.hand_damping = random.uniform(0, 8);
    if (i % 2 != 0)
      c.plant.effort_lag_s = random.log_uniform(1e-5, 5e-3);
    if (i % 20 == 7)
      c.plant.effort_lag_s = c.plant.mass / (c.plant.damping + 1e-2), c.plant.hand_stiffness = 0;
    c.push = random.uniform(-2, 2);
    out.push_back(c);
  }
  return out;
}

TEST(ExactPlant, KeepsTheEnergyOfAnUndampedHeldDevice) {
  LoopPlant p;
  p.mass = 0.1, p.hand_mass = 0.05, p.hand_stiffness = 800.0;
  coupling_models::ExactPlant plant(p, 0.0, 0.0);
  plant.set(1e-3, 0.2);
  const double energy = plant.energy();
  coupling_models::Random random(1);
  for (int i = 0; i < 1'000'000; ++i)
    plant.advance(random.uniform(0.0, 2e-3), 0.0);
  EXPECT_NEAR(plant.energy() / energy, 1.0, 1e-10);
}

TEST(ExactPlant, StateDoesNotDependOnTheTimeSteps) {
  coupling_models::Random random(2);
  for (const Case& c : cases()) {
    for (const double friction : {0.0, 0.3}) {
      coupling_models::ExactPlant whole(c.plant, friction, c.push), cut(c.plant, friction, c.push);
      for (int i = 0; i < 200; ++i) {
        const double h = random.log_uniform(1e-4, 5e-3), u = random.uniform(-3.0, 3.0);
        whole.advance(h, u);
        const double first = random.uniform(0.0, h);
        cut.advance(first, u), cut.advance(h - first, u);
      }
      const double tolerance =
          friction > 0.0 ? 1e-8 : 1e-9;  // a reversal is found to 1e-12 of the speed
      EXPECT_NEAR(whole.position(), cut.position(), tolerance * (1.0 + std::abs(whole.position())));
      EXPECT_NEAR(whole.speed(), cut.speed(), tolerance * (1.0 + std::abs(whole.speed())));
      EXPECT_NEAR(whole.work(), cut.work(), tolerance * (1.0 + std::abs(whole.work())));
    }
  }
}

/// Classical Runge-Kutta with small steps; friction by its sign, valid only while the body moves.
struct Fine {
  double x = 0, v = 0, f = 0;
};
Fine runge_kutta(const Case& c, Fine s, double h, double u) {
  const double mass = c.plant.mass + c.plant.hand_mass, b = c.plant.damping + c.plant.hand_damping;
  const double lag = c.plant.effort_lag_s, steps = 400;
  if (lag <= 0)
    s.f = u;
  const auto slope = [&](const Fine& y) {
    const double dry = y.v > 0 ? c.friction : -c.friction;
    return Fine{y.v, (y.f + c.push - dry - b * y.v - c.plant.hand_stiffness * y.x) / mass,
                lag > 0 ? (u - y.f) / lag : 0};
  };
  const auto add = [](const Fine& y, const Fine& d, double t) {
    return Fine{y.x + t * d.x, y.v + t * d.v, y.f + t * d.f};
  };
  const double dt = h / steps;
  for (int i = 0; i < steps; ++i) {
    const Fine a = slope(s), b2 = slope(add(s, a, dt / 2)), d = slope(add(s, b2, dt / 2)),
               e = slope(add(s, d, dt));
    s = {s.x + dt / 6 * (a.x + 2 * b2.x + 2 * d.x + e.x),
         s.v + dt / 6 * (a.v + 2 * b2.v + 2 * d.v + e.v),
         s.f + dt / 6 * (a.f + 2 * b2.f + 2 * d.f + e.f)};
  }
  return s;
}

TEST(ExactPlant, AgreesWithRungeKutta) {
  coupling_models::Random random(4);
  for (Case c : cases()) {
    c.friction = 0.05;
    coupling_models::ExactPlant plant(c.plant, c.friction, c.push);
    Fine fine{0.0, 50.0, 0.0};  // fast enough not to stop
    plant.set(fine.x, fine.v);
    for (int i = 0; i < 3; ++i) {
      const double h = random.uniform(1e-4, 1e-3), u = random.uniform(-3.0, 3.0);
      plant.advance(h, u);
      fine = runge_kutta(c, fine, h, u);
    }
    ASSERT_GT(fine.v, 0.0);
    EXPECT_NEAR(plant.position(), fine.x, 1e-7 * std::abs(fine.x));
    EXPECT_NEAR(plant.speed(), fine.v, 1e-6 * std::abs(fine.v));
    EXPECT_NEAR(plant.effort(), fine.f, 1e-6 * (1 + std::abs(fine.f)));
  }
}

TEST(ExactPlant, CountsTheWorkOfTheEffort) {
  coupling_models::Random random(5);
  for (Case c : cases()) {
    c.plant.damping = c.plant.hand_damping = 0.0;  // so that only friction dissipates
    coupling_models::ExactPlant plant(c.plant, 0.0, c.push);
    for (int i = 0; i < 100; ++i)
      plant.advance(random.uniform(0, 4e-3), random.uniform(-3, 3));
    const double gained = plant.energy() - c.push * plant.position();
    EXPECT_NEAR(plant.work(), gained, 1e-9 * (1.0 + plant.energy()));
  }
}

TEST(ExactPlant, StaysAtRestBelowItsFriction) {
  LoopPlant p;
  p.mass = 5.0, p.damping = 30.0, p.hand_stiffness = 200.0, p.effort_lag_s = 3e-3;
  coupling_models::ExactPlant plant(p, 3.0, 0.0);
  plant.set(0.004, 0.0);  // the spring pulls with 0.8
  for (int i = 0; i < 1000; ++i)
    plant.advance(1e-3, i % 2 != 0 ? 3.7 : -2.1);
  EXPECT_EQ(plant.position(), 0.004);
  EXPECT_EQ(plant.speed(), 0.0);
}

TEST(ExactPlant, SlipsWhenTheEffortExceedsItsFriction) {
  LoopPlant p;
  p.mass = 2.0, p.effort_lag_s = 4e-3;
  coupling_models::ExactPlant plant(p, 3.0, 0.0);
  const double slip = 4e-3 * std::log(2.0);  // 6 (1 - exp(-t/lag)) = 3
  plant.advance(slip * 0.999999, 6.0);
  EXPECT_EQ(plant.position(), 0.0);
  plant.advance(slip * 0.01, 6.0);
  EXPECT_GT(plant.speed(), 0.0);
}

TEST(ExactPlant, FrictionDissipatesForceTimesPath) {
  LoopPlant p;
  p.mass = 0.2;
  coupling_models::ExactPlant plant(p, 0.5, 0.0);
  plant.set(0.0, 1.0);
  for (int i = 0; i < 1000; ++i)
    plant.advance(1e-3, 0.0);
  EXPECT_EQ(plant.speed(), 0.0);
  EXPECT_NEAR(plant.position(), 0.5 * 0.2 * 1.0 / 0.5, 1e-12);  // kinetic energy / friction
}

TEST(ExactPlant, GrippedBodyWithFrictionDecaysAsInTheory) {
  LoopPlant p;
  p.mass = 1.0, p.hand_stiffness = 100.0;
  coupling_models::ExactPlant plant(p, 1.0, 0.0);  // 2 F_c / k = 20 mm lost each half swing
  plant.set(0.095, 0.0);
  std::vector<double> reversals;
  double last = plant.position();
  bool inward = true;
  for (int i = 0; i < 5000; ++i) {
    plant.advance(0.7e-3, 0.0);
    if ((plant.position() > last) == inward && plant.position() != last)
      reversals.push_back(last), inward = !inward;
    last = plant.position();
  }
  ASSERT_GE(reversals.size(), 4u);
  EXPECT_NEAR(reversals[0], -0.075, 1e-5);
  EXPECT_NEAR(reversals[1], 0.055, 1e-5);
  EXPECT_NEAR(reversals[2], -0.035, 1e-5);
  EXPECT_NEAR(reversals[3], 0.015, 1e-5);  // from here inward to
  EXPECT_NEAR(last, 0.005, 1e-12);         // less than F_c / k: it stays
  EXPECT_EQ(plant.speed(), 0.0);
}

}  // namespace
}  // namespace voxtouch::coupling::design
