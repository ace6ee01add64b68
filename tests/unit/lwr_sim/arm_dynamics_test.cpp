#include "devices/lwr/simulated/lwr_plant.hpp"
#include "tests/unit/lwr_sim/arm_energy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <random>

namespace voxtouch::lwr_sim {
namespace {

constexpr int kPostures = 40;
const TipLoad kHand{1.3, 0.01};
const Pose kTool{Vec3(0.03, -0.02, 0.1),
                 Quat(Eigen::AngleAxisd(0.4, Vec3(1.0, 2.0, -1.0).normalized()))};

lwr::LwrJoints random_joints(std::mt19937_64& random, double scale) {
  lwr::LwrJoints q;
  for (int i = 0; i < 7; ++i)
    q[i] = scale * (2.0 * std::generate_canonical<double, 53>(random) - 1.0);
  return q;
}

/// The derivative of a function of q in direction v, by central differences.
template <class F>
auto derivative(const F& f, const lwr::LwrJoints& q, const lwr::LwrJoints& v) {
  constexpr double kH = 1e-6;
  return ((f(q + kH * v) - f(q - kH * v)) / (2.0 * kH)).eval();
}

TEST(ArmDynamics, ItsFlangeIsThatOfTheDenavitHartenbergRows) {
  std::mt19937_64 random(1);
  const lwr::LwrArm arm(kTool);
  const ArmDynamics dynamics(lwr_bodies(), kTool);
  for (int n = 0; n < kPostures; ++n) {
    const lwr::LwrJoints q = random_joints(random, 2.5);
    const lwr::LwrArm::State expected = arm.at(q);
    const ArmDynamics::Terms terms = dynamics.at(q, lwr::LwrJoints::Zero());
    EXPECT_NEAR((terms.tool.position - expected.pose_BT.position).norm(), 0.0, 1e-12);
    EXPECT_NEAR(terms.tool.orientation.angularDistance(expected.pose_BT.orientation), 0.0, 1e-7);
    EXPECT_NEAR((terms.jacobian - expected.jacobian).norm(), 0.0, 1e-12);
  }
}

TEST(ArmDynamics, MassMatrixIsTheEnergysSecondDerivative) {
  std::mt19937_64 random(2);
  const ArmDynamics dynamics(lwr_bodies(), kTool);
  for (int n = 0; n < kPostures; ++n) {
    const lwr::LwrJoints q = random_joints(random, 2.5);
    const LwrMatrix mass = dynamics.at(q, lwr::LwrJoints::Zero(), kHand).mass;
    const auto energy = [&](const lwr::LwrJoints& v) {
      return kinetic_energy(dynamics, q, v, kHand);
    };
    for (int i = 0; i < 7; ++i)
      for (int j = 0; j < 7;
           ++j) {  // quadratic in the rates: the difference quotient is exact at any step
        const lwr::LwrJoints a = lwr::LwrJoints::Unit(i), b = lwr::LwrJoints::Unit(j);
        EXPECT_NEAR(mass(i, j), 0.5 * (energy(a + b) - energy(a - b)), 1e-12);
      }
    EXPECT_GT(mass.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0.0);
  }
}

TEST(ArmDynamics, KineticEnergyEqualsThatOfLinkPoints) {
  // Each link as six point masses on its axes with the link's mass, centre and inertia; their
  // speeds by differences in time.
  std::mt19937_64 random(3);
  const ArmBodies inertia = lwr_bodies();
  const ArmDynamics dynamics(inertia);
  for (int n = 0; n < kPostures; ++n) {
    const lwr::LwrJoints q = random_joints(random, 2.5), rate = random_joints(random, 2.0);
    constexpr double kH = 1e-5;
    const auto before = dynamics.links(q - kH * rate), after = dynamics.links(q + kH * rate);
    double energy = 0.5 * rate.cwiseAbs2().dot(inertia.rotor_kg_m2);
    for (std::size_t i = 0; i < 7; ++i) {
      const Link& link = inertia.links[i];
      for (int axis = 0; axis < 3; ++axis) {
        const double second_moment =
            0.5 * link.inertia_kg_m2.sum() - link.inertia_kg_m2[axis];  // integral of x_axis^2 dm
        const double arm = std::sqrt(3.0 * second_moment / link.mass_kg);
        for (const double side : {-1.0, 1.0}) {
          const Vec3 point = link.centre_m + side * arm * Vec3::Unit(axis);
          const Vec3 displacement = after[i].rotation * point + after[i].origin -
                                    before[i].rotation * point - before[i].origin;
          energy += 0.5 * link.mass_kg / 6.0 * (displacement / (2.0 * kH)).squaredNorm();
        }
      }
    }
    EXPECT_NEAR(kinetic_energy(dynamics, q, rate), energy, 1e-8 * energy);
  }
}

TEST(ArmDynamics, GravityIsTheGradientOfThePotentialEnergy) {
  std::mt19937_64 random(4);
  const ArmDynamics dynamics(lwr_bodies());
  for (int n = 0; n < kPostures; ++n) {
    const lwr::LwrJoints q = random_joints(random, 2.5);
    const lwr::LwrJoints gravity = dynamics.at(q, lwr::LwrJoints::Zero(), kHand).gravity;
    for (int i = 0; i < 7; ++i) {
      const double h = 1e-6;
      const lwr::LwrJoints displacement = h * lwr::LwrJoints::Unit(i);
      const double slope = (potential_energy(dynamics, q + displacement) -
                            potential_energy(dynamics, q - displacement)) /
                           (2.0 * h);
      EXPECT_NEAR(gravity[i], slope, 1e-7);
    }
  }
}

/// The Coriolis matrix of Christoffel's symbols, from c alone: c is a quadratic form of the rates,
/// and its polar form with one argument filled is that matrix.
LwrMatrix coriolis_matrix(const ArmDynamics& dynamics, const lwr::LwrJoints& q,
                          const lwr::LwrJoints& rate) {
  const auto c = [&](const lwr::LwrJoints& v) { return dynamics.at(q, v, kHand).coriolis; };
  LwrMatrix matrix;
  for (int j = 0; j < 7; ++j) {
    const lwr::LwrJoints e = lwr::LwrJoints::Unit(j);
    matrix.col(j) = 0.25 * (c(rate + e) - c(rate - e));
  }
  return matrix;
}

TEST(ArmDynamics, MassRateMinusTwiceCoriolisIsSkew) {
  std::mt19937_64 random(5);
  const ArmDynamics dynamics(lwr_bodies(), kTool);
  for (int n = 0; n < kPostures; ++n) {
    const lwr::LwrJoints q = random_joints(random, 2.5), rate = random_joints(random, 2.0);
    const LwrMatrix coriolis = 2.0 * coriolis_matrix(dynamics, q, rate);
    const auto mass = [&](const lwr::LwrJoints& at) -> LwrMatrix {
      return dynamics.at(at, rate, kHand).mass;
    };
    const LwrMatrix skew = derivative(mass, q, rate) - coriolis;
    EXPECT_NEAR((skew + skew.transpose()).cwiseAbs().maxCoeff(), 0.0, 1e-7);
    EXPECT_GT(skew.cwiseAbs().maxCoeff(), 1e-3);  // not because both are nothing
    EXPECT_NEAR((0.5 * coriolis * rate - dynamics.at(q, rate, kHand).coriolis).norm(), 0.0, 1e-10);
  }
}

TEST(ArmDynamics, TheToolsTwistIsTheJacobianTimesTheRates) {
  std::mt19937_64 random(6);
  const ArmDynamics dynamics(lwr_bodies(), kTool);
  const lwr::LwrJoints q = random_joints(random, 2.0), rate = random_joints(random, 2.0);
  const ArmDynamics::Terms terms = dynamics.at(q, rate);
  Vec6 twist;
  twist << terms.twist.linear, terms.twist.angular;
  EXPECT_NEAR((terms.jacobian * rate - twist).norm(), 0.0, 1e-12);
}

TEST(ArmDynamics, TheMassAtTheToolIsThatOfPublishedEstimates) {
  const double deg = std::numbers::pi / 180.0;
  lwr::LwrJoints q;
  q << 0, 30, 0, -90, 0, 60, 0;
  q *= deg;
  const ArmDynamics::Terms terms = ArmDynamics(lwr_bodies()).at(q, lwr::LwrJoints::Zero());
  const Mat3 mobility =
      (terms.jacobian * terms.mass.inverse() * terms.jacobian.transpose()).topLeftCorner<3, 3>();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(1.0 / mobility(axis, axis), 2.5);
    EXPECT_LT(1.0 / mobility(axis, axis), 8.0);
  }
}

TEST(ArmDynamics, RefusesAGainThatNoTorqueLoopHas) {
  EXPECT_THROW(lwr_bodies(0.0), std::runtime_error);
}

}  // namespace
}  // namespace voxtouch::lwr_sim
