/// The god-object of a mesh against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/reference/god_object.hpp"
#include "core/reference/least_distance.hpp"
#include "tests/support/exact_shapes/shapes.hpp"

namespace voxtouch::reference {
namespace {

constexpr double kMm = 1e-3;
constexpr double kNear = 2e-7;  ///< [m]: contact rests at less than this from the surface

ReferenceMesh solid(const mesh::TriangleMesh& mesh) {
  return make_reference_mesh(mesh.vertices, mesh.triangles, "mesh of a test");
}
Quat rotated(double angle, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(angle, axis.normalized()));
}
double angle_of(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Settled and outside, or the test fails.
GodObjectRest led(GodObject& tool, const Pose& from, const Pose& hand) {
  const auto rest = tool.led(from, hand);
  EXPECT_TRUE(rest.has_value());
  if (!rest)
    return {};
  EXPECT_TRUE(rest->settled);
  EXPECT_GT(rest->apart_m, 0.0);
  EXPECT_LT(rest->apart_m, kNear);
  return *rest;
}

const mesh::TriangleMesh kFloor = test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0});

/// All sets of at most six inequalities that hold as equations: one of them is the solution.
TEST(LeastDistance, IsTheBestOfAllActiveSets) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 50; ++round) {
    std::vector<Inequality> rows(8);
    Vec6 inside;  // so that the inequalities are consistent
    for (double& x : inside)
      x = normal(random);
    for (Inequality& row : rows) {
      for (double& x : row.normal)
        x = normal(random);
      row.bound = row.normal.dot(inside) - std::abs(normal(random));
    }
    double best = std::numeric_limits<double>::infinity();
    for (unsigned set = 0; set < 256; ++set) {
      Eigen::MatrixXd a(0, 6);
      Eigen::VectorXd b(0);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        if ((set >> k & 1U) == 0)
          continue;
        a.conservativeResize(a.rows() + 1, 6);
        b.conservativeResize(b.size() + 1);
        a.row(a.rows() - 1) = rows[k].normal.transpose();
        b[b.size() - 1] = rows[k].bound;
      }
      if (a.rows() > 6)
        continue;
      const Vec6 x = a.rows() == 0 ? Vec6(Vec6::Zero())
                                   : Vec6(a.transpose() * (a * a.transpose()).inverse() * b);
      bool valid = true;
      for (const Inequality& row : rows)
        valid = valid && row.normal.dot(x) >= row.bound - 1e-9;
      if (valid)
        best = std::min(best, x.norm());
    }
    const LeastDistance found = least_distance(rows);
    ASSERT_TRUE(found.solved);
    EXPECT_NEAR(found.x.norm(), best, 1e-8);
    for (const Inequality& row : rows)
      EXPECT_GE(row.normal.dot(found.x), row.bound - 1e-8);
  }
}

TEST(LeastDistance, ReportsAContradiction) {
  const Vec6 up = Vec6::Unit(2);
  EXPECT_FALSE(least_distance({{up, 1.0}, {-up, 1.0}}).solved);
  EXPECT_TRUE(least_distance({{up, 1.0}, {-up, -1.0}}).solved);
}

/// The force is vertical, and its line passes through the vertices that touch.
TEST(GodObject, ABallOnAPlaneIsInEquilibrium) {
  const mesh::TriangleMesh mesh = test::ball(0.01, 2);
  GodObject tool(solid(mesh), solid(kFloor));
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 6; ++k) {
    const Quat turn = rotated(3.0 * normal(random), {normal(random), normal(random), 1.0});
    const Pose hand{{0.01, -0.02, 0.008}, turn};
    const GodObjectRest rest = led(tool, {{0.01, -0.02, 0.0105}, turn}, hand);
    const Wrench wrench = rest.wrench();
    EXPECT_LT(angle_of(wrench.force, Vec3::UnitZ()), 1e-6);
    EXPECT_NEAR(wrench.force.z(), 2.0 * kMm, 0.15 * kMm);
    Vec3 low = Vec3::Constant(1.0), high = -low;
    for (const Vec3& v : mesh.vertices) {
      const Vec3 arm = rest.tool.orientation * v;
      if (arm.z() + rest.tool.position.z() > kNear)
        continue;
      low = low.cwiseMin(arm), high = high.cwiseMax(arm);
    }
    const Vec3 at(-wrench.torque.y() / wrench.force.z(), wrench.torque.x() / wrench.force.z(), 0.0);
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_GE(at[axis], low[axis] - 1e-6);
      EXPECT_LE(at[axis], high[axis] + 1e-6);
    }
    EXPECT_NEAR(wrench.torque.z(), 0.0, 1e-6 * wrench.force.z());
  }
}

/// A hand rotated about the x axis and pressed into the plane: the box is flat if the force is
/// large enough; otherwise it stands on an edge, with tilt and height at the minimum of the energy.
TEST(GodObject, ATurnedBoxOnAPlaneHasTheLeastEnergy) {
  const double b = 4.0 * kMm, c = 6.0 * kMm;
  const mesh::TriangleMesh mesh = test::box({-5.0 * kMm, -b, -c}, {5.0 * kMm, b, c});
  GodObject tool(solid(mesh), solid(kFloor));
  for (const double turn : {0.05, 0.2}) {
    for (const double depth : {0.5 * kMm, 1.0 * kMm, 4.0 * kMm}) {
      const double height = b * std::sin(turn) + c * std::cos(turn) - depth;
      double least = std::numeric_limits<double>::infinity(), tilt = 0.0;
      for (int k = 0; k <= 400'000; ++k) {
        const double at = turn * k / 400'000;
        const double rise = b * std::sin(at) + c * std::cos(at) - height;
        const double energy = rise * rise + std::pow(tool.lever_m() * (at - turn), 2);
        if (energy < least)
          least = energy, tilt = at;
      }
      const Quat attitude = rotated(turn, Vec3::UnitX());
      const Pose hand{{0.003, 0.002, height}, attitude};
      const GodObjectRest rest = led(tool, {{0.003, 0.002, height + depth + kMm}, attitude}, hand);
      EXPECT_NEAR(rest.tool.position.z(), b * std::sin(tilt) + c * std::cos(tilt), kNear);
      EXPECT_NEAR(rest.rotation.x(), turn - tilt, 3e-5) << turn << ' ' << depth;
      EXPECT_LT(rest.rotation.tail<2>().norm(), 1e-5);
      EXPECT_LT(rest.shift.head<2>().norm(), 1e-8);
    }
  }
}

/// A facet of a prism is a plane, its ridge a line: pressed on the facet's middle and flat on the
/// ridge, a box has the exact depth.
TEST(GodObject, FacetsAndRidgesOfACylinderHoldExactly) {
  constexpr int kSides = 16;
  constexpr double kRadius = 0.02, kHalf = 0.005, kDepth = 1e-3;
  GodObject tool(solid(test::box(Vec3::Constant(-kHalf), Vec3::Constant(kHalf))),
                 solid(test::prism(test::circle(kRadius, kSides), -0.03, 0.03)));
  for (const bool ridge : {false, true}) {
    const double angle = 2.0 * std::numbers::pi / kSides * (ridge ? 3.0 : 3.5);
    const double surface = ridge ? kRadius : kRadius * std::cos(std::numbers::pi / kSides);
    const Quat attitude = rotated(angle, Vec3::UnitZ());
    const Vec3 normal = attitude * Vec3::UnitX(), along(0.0, 0.0, 0.004);
    const Pose out{(surface + kHalf + kDepth) * normal + along, attitude},
        in{(surface + kHalf - kDepth) * normal + along, attitude};
    const GodObjectRest rest = led(tool, out, in);
    EXPECT_NEAR(rest.shift.norm(), kDepth, kNear);
    EXPECT_LT(angle_of(-rest.shift, normal), 1e-5);
    EXPECT_LT(rest.rotation.norm(), 1e-5);
  }
}

constexpr double kArm = 0.01, kWidth = 0.003;  // of the cross

GodObject cross_in_hole(double clearance) {
  return GodObject(
      solid(test::prism(test::cross(kArm, kWidth, 0.0), -0.01, 0.01)),
      solid(test::block_with_hole(test::cross(kArm, kWidth, clearance), 0.02, -0.02, 0.02)));
}

TEST(GodObject, ShiftedPegIsHeldAtTheClearance) {
  for (const double clearance : {2e-4, 5e-5}) {
    GodObject tool = cross_in_hole(clearance);
    for (int k = 0; k < 5; ++k) {
      const double angle = 0.1 + 1.3 * k;
      const Pose hand{Vec3(std::cos(angle), std::sin(angle), 0.0) * kMm, Quat::Identity()};
      const GodObjectRest rest = led(tool, {}, hand);
      const Vec3 held = hand.position.cwiseMax(-clearance).cwiseMin(clearance);
      EXPECT_LT((rest.tool.position - held).norm(), 2.0 * kNear);
      EXPECT_LT(rest.rotation.norm(), 1e-5);
    }
  }
}

/// The arm's corner meets the wall: length sin + width cos = width + clearance.
TEST(GodObject, RotatedPegHasTheTorqueOfTheClosedForm) {
  for (const double clearance : {2e-4, 5e-5}) {
    for (const double turn : {0.1, -0.1}) {
      GodObject tool = cross_in_hole(clearance);
      const GodObjectRest rest = led(tool, {}, {Vec3::Zero(), rotated(turn, Vec3::UnitZ())});
      const double held =
          std::asin((kWidth + clearance) / std::hypot(kArm, kWidth)) - std::atan2(kWidth, kArm);
      const double torque =
          -tool.lever_m() * tool.lever_m() * std::copysign(std::abs(turn) - held, turn);
      EXPECT_NEAR(rest.wrench().torque.z(), torque, 1e-4 * std::abs(torque));
      EXPECT_LT(rest.wrench().torque.head<2>().norm(), 1e-4 * std::abs(torque));
      EXPECT_LT(rest.shift.norm(), 1e-6);
    }
  }
}

/// Three walls that overlap. The box lies flat on all of them.
TEST(GodObject, BoxInACornerIsHeldByAllWalls) {
  const auto walls = test::joined(test::joined(test::box({-0.02, -0.02, -0.02}, {0.06, 0.06, 0.0}),
                                               test::box({-0.02, -0.02, -0.02}, {0.0, 0.06, 0.06})),
                                  test::box({-0.02, -0.02, -0.02}, {0.06, 0.0, 0.06}));
  const double half = 5.0 * kMm;
  GodObject tool(solid(test::box(Vec3::Constant(-half), Vec3::Constant(half))), solid(walls));
  const Quat turn = rotated(0.05, {1, 2, 3});
  const Pose hand{Vec3::Constant(half) - Vec3(1, 2, 3) * kMm, turn};
  const GodObjectRest rest = led(tool, {Vec3::Constant(8.0 * kMm), Quat::Identity()}, hand);
  EXPECT_LT((rest.wrench().force - Vec3(1, 2, 3) * kMm).norm(), 3.0 * kNear);
  const Vec3 torque = -tool.lever_m() * tool.lever_m() * 0.05 * Vec3(1, 2, 3).normalized();
  EXPECT_LT((rest.wrench().torque - torque).norm(), 1e-4 * torque.norm());
}

TEST(GodObject, ABallAcrossTheSeamOfOverlappingBoxesFeelsNoSeam) {
  const auto boxes = test::joined(test::box({-0.1, -0.1, -0.02}, {0.005, 0.1, 0.0}),
                                  test::box({-0.005, -0.1, -0.02}, {0.1, 0.1, 0.0}));
  GodObject tool(solid(test::ball(0.01, 2)), solid(boxes));
  for (const double x : {-0.006, -0.0049, 0.0, 0.0051}) {
    const GodObjectRest rest = led(tool, {{x - 0.002, 0.0, 0.0105}, Quat::Identity()},
                                   {{x, 0.0, 0.008}, Quat::Identity()});
    EXPECT_LT(angle_of(-rest.shift, Vec3::UnitZ()), 1e-6) << x;
  }
}

/// The hand is on the other side at once.
TEST(GodObject, DoesNotPassAFoil) {
  const auto foil = test::box({-0.05, -0.05, 0.0}, {0.05, 0.05, 2e-5});
  for (const auto& mesh :
       {test::ball(0.005, 2), test::box(Vec3::Constant(-0.003), Vec3::Constant(0.003))}) {
    GodObject tool(solid(mesh), solid(foil));
    const Quat turn = rotated(0.4, {1, 2, 3});
    const auto rest = tool.pulled({{0.0, 0.0, 0.01}, turn}, {{0.002, 0.001, -0.03}, turn});
    ASSERT_TRUE(rest.has_value());
    EXPECT_TRUE(rest->settled);
    EXPECT_GT(rest->apart_m, 0.0);
    EXPECT_GT(rest->tool.position.z(), 0.0);
    EXPECT_LT(angle_of(-rest->shift, Vec3::UnitZ()), 1e-6);
  }
}

TEST(GodObject, InFreeSpaceIsAtTheHand) {
  GodObject tool(solid(test::ball(0.01, 1)), solid(kFloor));
  const Pose hand{{0.01, 0.02, 0.013}, rotated(1.0, {1, 2, 3})};
  const auto rest = tool.led({{0.0, 0.0, 0.02}, Quat::Identity()}, hand);
  ASSERT_TRUE(rest.has_value());
  EXPECT_TRUE(rest->settled);
  EXPECT_LT(rest->shift.norm(), 1e-9);
  EXPECT_LT(rest->rotation.norm(), 1e-7);
}

TEST(GodObject, DoesNotStartInContact) {
  GodObject tool(solid(test::ball(0.01, 1)), solid(kFloor));
  EXPECT_FALSE(tool.led({{0.0, 0.0, 0.01}, Quat::Identity()}, {}).has_value());
}

TEST(GodObject, RefusesAnOpenTool) {
  EXPECT_THROW(GodObject(solid(test::sheet(0.01, 2)), solid(kFloor)), std::invalid_argument);
}

}  // namespace
}  // namespace voxtouch::reference
