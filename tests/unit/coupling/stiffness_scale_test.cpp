#include "core/coupling/stiffness_scale.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "core/coupling/running_coupling.hpp"

namespace voxtouch::coupling {
namespace stiffness_scale_test {

constexpr double kT = 1e-3;
const double kInf = std::numeric_limits<double>::infinity();

/// A shell point with a force along `u`, `depth` deep, at `arm` from the tool's origin.
struct Point {
  Vec3 arm, u;
  double depth;
};

/// Results of the contact models for such points after the tool has moved by `shift`: wrench, bound
/// and matrix, k for each point.
CouplingInput contact_of(const std::vector<Point>& points, double k,
                         const Vec3& shift = Vec3::Zero()) {
  CouplingInput in;
  for (const Point& p : points) {
    const double depth = p.depth - p.u.dot(shift);
    if (depth < 0.0)
      continue;
    const Vec3 force = k * depth * p.u;
    in.contact.force += force;
    in.contact.torque += p.arm.cross(force);
    Vec6 j;
    j << p.u, p.arm.cross(p.u);
    in.contact_stiffness += k * j * j.transpose();
    in.contact_stiffness_n_per_m += k;
  }
  return in;
}

CouplingSpec direct(double cap_t, double cap_r = std::numeric_limits<double>::infinity()) {
  CouplingSpec spec;
  spec.kind = "direct", spec.stiffness_cap_n_per_m = cap_t, spec.stiffness_cap_nm_per_rad = cap_r;
  return spec;
}

/// Largest eigenvalue without the solver under test.
double power_iteration(const Mat6& m) {
  Vec6 x = Vec6::Ones() + 0.1 * Vec6::LinSpaced(0.0, 1.0);
  double value = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Vec6 y = m * x.normalized();
    value = y.norm(), x = y;
  }
  return value;
}

std::vector<Point> random_points(std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i)
    points.push_back({0.05 * Vec3(u(random), u(random), u(random)),
                      Vec3(u(random), u(random), u(random)).normalized(), 1e-3 * (1 + u(random))});
  return points;
}

TEST(StiffnessScale, KeepsTheMatrixJustBelowBothCaps) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(0, 1);
  int cut = 0;
  for (int attempt = 0; attempt < 300; ++attempt) {
    const CouplingInput in =
        contact_of(random_points(random, 1 + attempt % 40), std::pow(10.0, 1 + 2 * u(random)));
    const double t = std::pow(10.0, 2 + 2 * u(random)),
                 r = attempt % 3 ? std::pow(10.0, 2 * u(random) - 2) : kInf;
    const double s = cap_scale(in.contact_stiffness, in.contact_stiffness_n_per_m, 1 / t, 1 / r);
    ASSERT_GT(s, 0.0);
    ASSERT_LE(s, 1.0);
    Vec6 caps;
    caps << t, t, t, r, r, r;
    const Vec6 n = caps.cwiseSqrt().cwiseInverse();
    const double worst =
        power_iteration(n.asDiagonal() * (s * in.contact_stiffness) * n.asDiagonal());
    ASSERT_LE(worst, 1 + 1e-9);
    if (s < 1.0) {
      ASSERT_GT(worst, 1 - 1e-3) << "it scales by what is needed and no more";
      ++cut;
    }
    if (!(r < kInf))
      continue;
    for (int i = 0; i < 50; ++i) {
      Vec6 x;
      for (double& component : x)
        component = 2 * u(random) - 1;
      ASSERT_LE(x.dot(s * in.contact_stiffness * x), x.dot(caps.cwiseProduct(x)) * (1 + 1e-9));
    }
  }
  EXPECT_GT(cut, 100);
}

TEST(StiffnessScale, ChangesNothingBelowOrWithoutCaps) {
  std::mt19937_64 random(2);
  const CouplingInput in = contact_of(random_points(random, 5), 10);
  EXPECT_EQ(cap_scale(in.contact_stiffness, 50, 1.0 / 51, 0), 1.0);
  EXPECT_EQ(cap_scale(in.contact_stiffness, 50, 0, 0), 1.0);
  EXPECT_EQ(cap_scale(Mat6::Zero(), 0, 1.0 / 51, 1), 1.0);
}

TEST(StiffnessScale, UsesTheBoundForAZeroMatrix) {
  EXPECT_DOUBLE_EQ(cap_scale(Mat6::Zero(), 5000, 1.0 / 1000, 0), 0.2);
  EXPECT_DOUBLE_EQ(cap_scale(Mat6::Zero(), 5000, 1.0 / 1000, 10), 0.2);
  RunningCoupling coupling(direct(1000), {}, kT);
  coupling.step({}, kT);
  const CouplingOutput out = coupling.step({{{10, 0, 0}, {0.1, 0, 0}}, 5000}, kT);
  EXPECT_NEAR(out.wrench.force.x(), 2, 1e-12);
  EXPECT_NEAR(out.wrench.torque.x(), 0.02, 1e-14) << "the same fraction of the torque";
  EXPECT_TRUE(out.capped);
}

/// A matrix that is no matrix makes the sample unusable, as a force that is no number does.
TEST(StiffnessScale, HoldsTheLastContactForANonFiniteMatrix) {
  RunningCoupling coupling(direct(1000), {}, kT);
  coupling.step({}, kT);
  const CouplingInput good{{{1, 0, 0}, {0, 0, 0}}, 500};
  const Wrench before = coupling.step(good, kT).wrench;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInf, 1e13}) {
    CouplingInput broken = good;
    broken.contact.force *= 3.0;
    broken.contact_stiffness(2, 4) = bad;
    const CouplingOutput out = coupling.step(broken, kT);
    EXPECT_TRUE(out.repeated_input);
    EXPECT_EQ(out.wrench.force, before.force);
  }
  EXPECT_EQ(cap_scale(Mat6::Constant(1e12), 1e12, 1e300, 1e300), 0.0)
      << "beyond what a double holds: nothing is let through";
}

/// Plate on plate: 10^4 points of 10 N/m are 10^5 N/m, and 1000 N/m and 0.5 Nm/rad are displayed.
TEST(StiffnessScale, PlateOfTenThousandPointsDisplaysTheCap) {
  std::vector<Point> plate;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j)
      plate.push_back({Vec3(1e-3 * (i - 49.5), 1e-3 * (j - 49.5), 0), Vec3(0, 0, 1), 5e-4});
  for (const double cap_r : {kInf, 0.5}) {
    const auto scaled = [&](double advance) {
      const CouplingInput in = contact_of(plate, 10, Vec3(0, 0, -advance));
      const double s =
          cap_scale(in.contact_stiffness, in.contact_stiffness_n_per_m, 1e-3, 1 / cap_r);
      return std::pair(s, s * in.contact.force.z());
    };
    const auto [s, force] = scaled(0);
    const double rotational =
        1e5 * (1e4 - 1) / 12 * 1e-6;  // k N (n^2 - 1)/12 h^2 about each axis of the plate
    EXPECT_NEAR(s, std::min(0.01, cap_r / rotational), 1e-9);
    EXPECT_LE((scaled(1e-6).second - force) / 1e-6, 1000 * (1 + 1e-9));
  }
}

/// Points of a plate in any order; a grid of dyadic numbers has exact sums, so the cap must give
/// bit-identical results.
TEST(StiffnessScale, PermutedPointsAreBitIdentical) {
  std::vector<Point> plate;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j)
      plate.push_back({Vec3(i - 20, j - 30, 4) / 1024.0, Vec3(0, 0.5, 1), 1.0 / 2048});
  std::mt19937_64 random(4);
  const CouplingInput in = contact_of(plate, 16);
  const double s = cap_scale(in.contact_stiffness, in.contact_stiffness_n_per_m, 1e-3, 2);
  EXPECT_LT(s, 1.0);
  for (int attempt = 0; attempt < 5; ++attempt) {
    std::shuffle(plate.begin(), plate.end(), random);
    const CouplingInput other = contact_of(plate, 16);
    EXPECT_EQ(other.contact_stiffness, in.contact_stiffness);
    EXPECT_EQ(cap_scale(other.contact_stiffness, other.contact_stiffness_n_per_m, 1e-3, 2), s);
    EXPECT_NE(cap_scale(contact_of(random_points(random, 9), 500).contact_stiffness, 9, 1e-3, 2),
              s);  // no memory of it
  }
}

}  // namespace stiffness_scale_test
}  // namespace voxtouch::coupling
