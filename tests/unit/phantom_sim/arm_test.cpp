// The arm's model checked by mechanics: every derivative is compared with differences.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "devices/phantom/phantom_arm.hpp"
#include "tests/unit/phantom_sim/apparent_mass.hpp"

namespace voxtouch::hd_sim {
namespace {

constexpr double kStep = 1e-6;

class Arm : public ::testing::Test {
 protected:
  Vec3 joints() { return {angle_(random_), angle_(random_), angle_(random_)}; }
  Vec3 rates() { return 3.0 * joints(); }

  phantom::PhantomGeometry geometry_;
  phantom::PhantomDynamics dynamics_;
  std::mt19937_64 random_{7};
  std::uniform_real_distribution<double> angle_{-0.9, 0.9};
};

Vec3 unit(int axis) { return Vec3::Unit(axis); }

/// A body of the arm for the kinetic energy: its centre's reach and height from the shoulder, and
/// its principal moments with the angles of its frame; the whole arm rotates about the turret.
/// Independent of the closed form under test.
struct Body {
  double mass_kg;
  Vec3 moments;
  double reach_thigh, reach_shin;    // reach = reach_thigh cos t2 + reach_shin sin t3
  double height_thigh, height_shin;  // height = height_thigh sin t2 - height_shin cos t3
  int turns_with;                    // 1 thigh, 2 shin
};

double kinetic_energy(const Body& b, const Vec3& q, const Vec3& v) {
  const double reach = b.reach_thigh * std::cos(q[1]) + b.reach_shin * std::sin(q[2]);
  const double reach_rate =
      -b.reach_thigh * std::sin(q[1]) * v[1] + b.reach_shin * std::cos(q[2]) * v[2];
  const double height_rate =
      b.height_thigh * std::cos(q[1]) * v[1] + b.height_shin * std::sin(q[2]) * v[2];
  const double linear =
      0.5 * b.mass_kg *
      (reach * v[0] * reach * v[0] + reach_rate * reach_rate + height_rate * height_rate);
  // The turret's rotation about y, in a frame that is rotated about x by the link's angle.
  const double angle = q[b.turns_with];
  const Vec3 turn(v[b.turns_with], v[0] * std::cos(angle), v[0] * std::sin(angle));
  return linear + 0.5 * b.moments.dot(turn.cwiseAbs2());
}

TEST_F(Arm, TipAtRestIsTheOrigin) {
  EXPECT_LT(phantom::phantom_tip(geometry_, Vec3::Zero()).norm(), 1e-15);
}

TEST_F(Arm, AxesAreRightUpAndTowardsTheOperator) {
  EXPECT_GT(phantom::phantom_tip(geometry_, {0.1, 0.0, 0.0}).x(), 0.0);
  EXPECT_GT(phantom::phantom_tip(geometry_, {0.0, 0.1, 0.0}).y(), 0.0);
  EXPECT_GT(phantom::phantom_tip(geometry_, {0.0, 0.0, 0.1}).z(), 0.0);
}

TEST_F(Arm, JacobianIsTheDerivativeOfTheTip) {
  for (int i = 0; i < 200; ++i) {
    const Vec3 q = joints();
    const Mat3 j = phantom::phantom_jacobian(geometry_, q);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 slope = (phantom::phantom_tip(geometry_, q + kStep * unit(axis)) -
                          phantom::phantom_tip(geometry_, q - kStep * unit(axis))) /
                         (2.0 * kStep);
      EXPECT_LT((j.col(axis) - slope).norm(), 1e-9);
    }
  }
}

TEST_F(Arm, JacobianRateIsItsDerivativeByTime) {
  for (int i = 0; i < 200; ++i) {
    const Vec3 q = joints(), v = rates();
    const Mat3 slope = (phantom::phantom_jacobian(geometry_, q + kStep * v) -
                        phantom::phantom_jacobian(geometry_, q - kStep * v)) /
                       (2.0 * kStep);
    EXPECT_LT((phantom::phantom_jacobian_rate(geometry_, q, v) - slope).norm(), 1e-8);
  }
}

TEST_F(Arm, InverseKinematicsReturnsTheJoints) {
  double worst = 0.0;
  int count = 0;
  for (double turret = -1.5; turret <= 1.5; turret += 0.25)
    for (double thigh = -0.9; thigh <= 1.6; thigh += 0.1)
      for (double difference = -0.95; difference <= 1.13;
           difference += 0.08) {  // of thigh and shin: between the stops
        const Vec3 q(turret, thigh, thigh - difference);
        if (geometry_.thigh_m * std::cos(q[1]) + geometry_.shin_m * std::sin(q[2]) < 0.01)
          continue;
        const auto back = phantom::phantom_joints(geometry_, phantom::phantom_tip(geometry_, q));
        ASSERT_TRUE(back);
        worst = std::max(worst, (*back - q).norm());
        ++count;
      }
  EXPECT_GT(count, 5000);
  EXPECT_LT(worst, 1e-12);
}

TEST_F(Arm, DoesNotReachBeyondItsLength) {
  EXPECT_FALSE(phantom::phantom_joints(geometry_, {0.0, 0.0, 0.3}));
  EXPECT_FALSE(phantom::phantom_joints(
      geometry_, {0.0, 0.17, -0.215 + 0.02}));  // nearer to the shoulder than thigh less shin
  EXPECT_FALSE(phantom::phantom_joints(geometry_, {std::nan(""), 0.0, 0.0}));
  EXPECT_FALSE(phantom::phantom_joints(geometry_, {0.0, 0.0, -0.215}));  // on the turret's axis
}

TEST_F(Arm, MassMatrixIsTheCurvatureOfTheKineticEnergyOfItsLinks) {
  const phantom::PhantomInertia p;
  const double l1 = geometry_.thigh_m, l2 = geometry_.shin_m;
  const std::array<Body, 4> bodies{
      Body{p.a_kg, p.a_kg_m2, l1, 0.5 * l2, l1, 0.5 * l2, 2},
      Body{p.c_kg, p.c_kg_m2, 0.5 * l1, p.l3_m, 0.5 * l1, p.l3_m, 1},
      Body{p.be_kg, p.be_kg_m2, 0.0, 0.0, 0.0, 0.0,
           1},  // the published moments of these two are about the shoulder
      Body{p.df_kg, p.df_kg_m2, 0.0, 0.0, 0.0, 0.0, 2},
  };
  const auto energy = [&](const Vec3& q, const Vec3& v) {
    double sum = 0.5 * p.base_yy_kg_m2 * v[0] * v[0] + 0.5 * p.rotor_kg_m2.dot(v.cwiseAbs2());
    for (const Body& b : bodies)
      sum += kinetic_energy(b, q, v);
    return sum;
  };
  for (int i = 0; i < 200; ++i) {
    const Vec3 q = joints();
    const Mat3 m = dynamics_.mass(q);
    for (int row = 0; row < 3; ++row)
      for (int col = 0; col < 3; ++col) {
        // The energy is a quadratic form, so this second difference is exact up to rounding.
        const double curvature =
            energy(q, unit(row) + unit(col)) - energy(q, unit(row)) - energy(q, unit(col));
        EXPECT_NEAR(m(row, col), curvature, 1e-15) << row << col;
      }
  }
}

TEST_F(Arm, CoriolisIsMadeOfChristoffelSymbols) {
  for (int i = 0; i < 200; ++i) {
    const Vec3 q = joints(), v = rates();
    std::array<Mat3, 3> slope;
    for (int axis = 0; axis < 3; ++axis)
      slope[axis] =
          (dynamics_.mass(q + kStep * unit(axis)) - dynamics_.mass(q - kStep * unit(axis))) /
          (2.0 * kStep);
    Mat3 expected = Mat3::Zero();
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j)
        for (int l = 0; l < 3; ++l)
          expected(k, j) += 0.5 * (slope[l](k, j) + slope[j](k, l) - slope[k](j, l)) * v[l];
    EXPECT_LT((dynamics_.coriolis(q, v) - expected).norm(), 1e-9);
  }
}

TEST_F(Arm, RateOfTheMassLessTwiceCoriolisIsSkew) {
  for (int i = 0; i < 200; ++i) {
    const Vec3 q = joints(), v = rates();
    const Mat3 rate =
        (dynamics_.mass(q + kStep * v) - dynamics_.mass(q - kStep * v)) / (2.0 * kStep);
    const Mat3 n = rate - 2.0 * dynamics_.coriolis(q, v);
    EXPECT_LT((n + n.transpose()).norm(), 1e-8);
    EXPECT_GT(n.norm(), 1e-6);
  }
}

TEST_F(Arm, GravityIsTheGradientOfThePotential) {
  for (int i = 0; i < 200; ++i) {
    const Vec3 q = joints();
    const Vec3 g = dynamics_.gravity(q);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(g[axis],
                  (dynamics_.potential(q + kStep * unit(axis)) -
                   dynamics_.potential(q - kStep * unit(axis))) /
                      (2.0 * kStep),
                  1e-9);
  }
}

TEST_F(Arm, MassAndApparentMassAtRestAreThePublishedOnes) {
  phantom::PhantomInertia links;
  links.rotor_kg_m2.setZero();
  const phantom::PhantomDynamics without(geometry_, links);
  const Vec3 diagonal = without.mass(Vec3::Zero()).diagonal();
  EXPECT_NEAR(diagonal[0], 3.57e-3, 5e-6);
  EXPECT_NEAR(diagonal[1], 2.43e-3, 5e-6);
  EXPECT_NEAR(diagonal[2], 0.93e-3, 5e-6);
  EXPECT_LT(
      (apparent_mass(without, Vec3::Zero()) - Vec3(0.077, 0.053, 0.032)).cwiseAbs().maxCoeff(),
      6e-4);
  EXPECT_LT(
      (apparent_mass(dynamics_, Vec3::Zero()) - Vec3(0.081, 0.055, 0.037)).cwiseAbs().maxCoeff(),
      6e-4);
}

TEST_F(Arm, GimbalAnglesGiveTheOrientationBack) {
  for (int i = 0; i < 200; ++i) {
    const Vec3 q = joints(), gimbal = 1.5 * joints();
    const Quat stylus = phantom::stylus_orientation(q, gimbal);
    EXPECT_LT((phantom::gimbal_angles(q, stylus) - gimbal).norm(), 1e-12);
  }
  const Quat straight_up =
      phantom::stylus_orientation(Vec3::Zero(), {0.4, std::numbers::pi / 2.0, 0.0});
  EXPECT_LT(
      phantom::stylus_orientation(Vec3::Zero(), phantom::gimbal_angles(Vec3::Zero(), straight_up))
          .angularDistance(straight_up),
      1e-7);
}

TEST_F(Arm, StylusRotatesWithTheLibrarysSigns) {
  const Vec3 ahead = -Vec3::UnitZ();  // the stylus points at the base
  EXPECT_GT((phantom::stylus_orientation(Vec3::Zero(), {0.1, 0.0, 0.0}) * ahead).x(), 0.0);
  EXPECT_GT((phantom::stylus_orientation(Vec3::Zero(), {0.0, -0.1, 0.0}) * ahead).y(), 0.0);
  EXPECT_GT((phantom::stylus_orientation(Vec3::Zero(), {0.0, 0.0, 0.1}) * Vec3::UnitY()).x(), 0.0);
}

}  // namespace
}  // namespace voxtouch::hd_sim
