#include "core/coupling/spring_damper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace voxtouch::coupling {
namespace spring_damper_test {

constexpr double kT = 1e-3;

SpringDamper running(double c, double r) {
  CouplingSpec spec;
  spec.kind = "spring_damper", spec.stiffness_n_per_m = c, spec.damping_ns_per_m = r;
  return SpringDamper(spec);
}

TEST(SpringDamper, FollowsItsEquationAlongASteadyDirection) {
  const double c = 500, r = 2, k = 800;
  SpringDamper coupling = running(c, r);
  const Vec3 n = Vec3(1, 2, -2) / 3;
  double before = 0;
  for (int i = 0; i < 500; ++i) {
    const double f = 1 + 0.5 * std::sin(0.03 * i);
    const double delta = (f + r * before / kT) / (k + c + r / kT);
    const Wrench out = coupling.step({{f * n, 0.1 * f * n}, k});
    EXPECT_LE((out.force - (c * delta + r * (delta - before) / kT) * n).norm(), 1e-12);
    EXPECT_LE((out.torque - 0.1 * out.force).norm(), 1e-12) << "the torque keeps its proportion";
    EXPECT_LE((coupling.object_offset() - delta * n).norm(), 1e-15);
    before = delta;
  }
}

TEST(SpringDamper, RestsAtTwoSpringsInSeries) {
  for (const double c : {50.0, 500.0, 5e4})
    for (const double k : {10.0, 1000.0, 1e6})
      for (const double r : {0.0, 2.0, 50.0}) {
        SpringDamper coupling = running(c, r);
        Wrench out;
        // Long enough for the slowest of these, r / (c + k) = 0.83 s.
        for (int n = 0; n < 50'000; ++n)
          out = coupling.step({{{3, 0, -4}, {0.2, 0, 0}}, k});
        EXPECT_LE((out.force - c / (c + k) * Vec3(3, 0, -4)).norm(), 1e-11 * (1 + k / c));
        EXPECT_LE((out.torque - c / (c + k) * Vec3(0.2, 0, 0)).norm(), 1e-11 * (1 + k / c));
      }
}

TEST(SpringDamper, GivesNothingInFreeSpaceWhileTheObjectSwingsBack) {
  SpringDamper coupling = running(500, 2);
  for (int n = 0; n < 1000; ++n)
    coupling.step({{{1, 0, 0}, {0, 0, 0}}, 1000});
  double before = coupling.object_offset().norm();
  EXPECT_GT(before, 1e-4);
  for (int n = 0; n < 20; ++n) {
    EXPECT_TRUE(coupling.step({}).zero());
    EXPECT_NEAR(coupling.object_offset().norm() / before, 2000.0 / 2500.0, 1e-12)
        << "r/T over c + r/T";
    before = coupling.object_offset().norm();
  }
  for (int n = 0; n < 1000; ++n)
    coupling.step({});
  EXPECT_EQ(coupling.object_offset(), Vec3::Zero().eval()) << "no denormals left";
}

/// For any contact, the coupling acts along it, with at most its force, and never pulls.
TEST(SpringDamper, NeverPullsAndNeverPushesHarderThanTheContact) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> u(-1, 1);
  for (const double r : {0.0, 2.0, 100.0}) {
    SpringDamper coupling = running(500, r);
    Vec3 f = Vec3::Zero();
    for (int n = 0; n < 20'000; ++n) {
      if (u(random) > 0.7)
        f = Vec3(u(random), u(random), u(random)) * std::pow(10.0, 3 * u(random));
      if (u(random) > 0.95)
        f.setZero();
      const double k = std::pow(10.0, 3 + 3 * u(random));
      const Wrench out = coupling.step({{f, Vec3::Zero()}, k});
      ASSERT_TRUE(out.finite());
      ASSERT_GE(out.force.dot(f), 0.0);
      ASSERT_LE(out.force.norm(), f.norm() * (1 + 1e-12));
      ASSERT_LE(out.force.cross(f).norm(), 1e-12 * f.squaredNorm());
    }
  }
}

/// The law has no discontinuity for small changes of the contact.
TEST(SpringDamper, IsContinuousInTheContact) {
  std::mt19937_64 random(22);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int attempt = 0; attempt < 5000; ++attempt) {
    UnilateralSpringDamper a{1e-3 * Vec3(u(random), u(random), u(random))}, b = a;
    const Vec3 f = 0.5 * Vec3(u(random), u(random), u(random));
    const Vec3 nudge = 1e-9 * Vec3(u(random), u(random), u(random));
    if (f.norm() < 0.01)
      continue;  // the direction of nothing is not defined; the size of the force is bounded by it
    const double k = 1000 * (1 + u(random));
    const Vec3 fa = a.step(f, k, 500, 2, kT), fb = b.step(f + nudge, k, 500, 2, kT);
    EXPECT_LE((fa - fb).norm(), 1e-6);
    EXPECT_LE((a.delta - b.delta).norm(), 1e-8);
  }
}

/// A touch with a stiffness bound but no depth yet is not a pull.
TEST(SpringDamper, ReadsATouchWithoutForceAsFree) {
  SpringDamper coupling = running(500, 2);
  for (int n = 0; n < 100; ++n)
    coupling.step({{{1, 0, 0}, {0, 0, 0}}, 1000});
  EXPECT_TRUE(coupling.step({{{0, 0, 0}, {0, 0, 0}}, 1000}).zero());
}

/// The same impact that makes a stiff explicit spring explode: k T / r is large, and still nothing
/// rings.
TEST(SpringDamper, IsStableForAnyContactStiffness) {
  SpringDamper coupling = running(500, 2);
  for (int n = 0; n < 2000; ++n) {
    const Wrench out = coupling.step({{{n % 2 ? 10.0 : 5.0, 0, 0}, {0, 0, 0}}, 1e9});
    ASSERT_TRUE(out.finite());
    ASSERT_LE(out.force.norm(), 10.0);
  }
}

}  // namespace spring_damper_test
}  // namespace voxtouch::coupling
