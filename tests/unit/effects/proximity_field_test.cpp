// The distances used by `proximity`, compared with true ones.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "proximity_ground.hpp"
#include "tests/support/exact_shell.hpp"

namespace voxtouch::test {
namespace {

TEST(ProximityField, IsTheTrueDistanceBeforeAFlatWallOutToItsRange) {
  const double range = 0.02;
  for (const double h : {0.002, 0.005}) {
    const rendering::ProximityField field = ground_of(block_mesh(), range, h);
    for (double z = -0.01; z < range; z += 0.0003) {
      const effects::ProximitySample sample = field.at({0.003, -0.0041, 0.02 + z});
      EXPECT_NEAR(sample.distance_m, z, 1e-8);
      EXPECT_TRUE(sample.gradient.isApprox(Vec3::UnitZ(), 1e-5)) << z;
      EXPECT_LT(sample.curvature.norm(), 1e-2) << z;
    }
  }
}

TEST(ProximityField, ErrorBeforeABallIsWithinItsBound) {
  const double radius = 0.03, range = 0.008;
  const mesh::TriangleMesh mesh = sphere_mesh(radius, 4);
  Random random(31);
  for (const double h : {0.002, 0.006}) {
    const rendering::ProximityField field = ground_of(mesh, range, h);
    EXPECT_NEAR(field.smoothing_m(), h, 1e-12);
    double most = 0.0;
    for (int n = 0; n < 3000; ++n) {
      const Vec3 u = random.direction();
      const double d = random.number(0, range);
      const double off = field.at((radius + d) * u).distance_m - d;
      EXPECT_GT(off,
                -1e-6);  // facets lie inside the ball, nothing else brings a convex body nearer
      EXPECT_LT(off, h * h / (4 * radius) + 4e-5);
      most = std::max(most, off);
    }
    EXPECT_GT(most, h * h / (8 * radius));
  }
}

TEST(ProximityField, ReachesTheRequestedRangeOnEverySide) {
  Random random(32);
  const Quat turn(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()));
  const Vec3 size(0.06, 0.06, 0.04);
  for (const double range : {0.004, 0.03}) {
    const rendering::ProximityField field = ground_of(block_mesh(turn), range, 0.002);
    int inside_range = 0;
    for (int n = 0; n < 20000; ++n) {
      const Vec3 x = random.vector(0.09);
      const double d = box_distance(turn.conjugate() * x, size);
      const double found = field.at(x).distance_m;
      if (d > 0.0 && d < range) {
        EXPECT_NEAR(found, d, 0.0006) << "an edge is rounded by less than a third of the smoothing";
        ++inside_range;
      }
      if (d > range + 0.0006) {
        EXPECT_GE(found, range);
      }
    }
    EXPECT_GT(inside_range, 200);
  }
}

TEST(ProximityField, HasBoundedGradientAndCurvature) {
  Random random(33);
  for (const double h : {0.002, 0.004}) {
    const rendering::ProximityField field = ground_of(block_mesh(random.orientation()), 0.012, h);
    double steepest = 0.0, bent = 0.0;
    for (int n = 0; n < 4000; ++n) {
      const Vec3 x = random.vector(0.05);
      const effects::ProximitySample here = field.at(x);
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = 1e-7 * Vec3::Unit(axis);
        const effects::ProximitySample more = field.at(x + step), less = field.at(x - step);
        EXPECT_NEAR((more.distance_m - less.distance_m) / 2e-7, here.gradient[axis], 1e-5);
        EXPECT_LT(((more.gradient - less.gradient) / 2e-7 - here.curvature.col(axis)).norm(),
                  1e-3 + 2e-3 / h);
      }
      steepest = std::max(steepest, here.gradient.norm());
      bent = std::max(bent, here.curvature.cwiseAbs().rowwise().sum().maxCoeff());
    }
    EXPECT_LE(steepest, std::sqrt(3.0));
    EXPECT_LE(bent, 6.0 / h);
    EXPECT_GT(bent, 0.5 / h) << "an edge was met";
    RecordProperty("steepest", std::to_string(steepest));
    RecordProperty("bent_times_h", std::to_string(bent * h));
  }
}

TEST(ProximityField, IsContinuousBeyondStorageAtAnyPoint) {
  const rendering::ProximityField field = ground_of(block_mesh(), 0.01, 0.002);
  effects::ProximitySample last = field.at({0.001, 0.002, 0.0});
  for (int n = 1; n <= 40000; ++n) {
    const effects::ProximitySample sample = field.at({0.001, 0.002, 5e-6 * n});
    if (std::min(sample.distance_m, last.distance_m) < 0.01) {
      EXPECT_LE(std::abs(sample.distance_m - last.distance_m), 5e-6 * 1.0001);
      EXPECT_LE((sample.gradient - last.gradient).norm(), 5e-6 * 6 / 0.002);
    }
    last = sample;
  }
  EXPECT_EQ(last.distance_m, field.reach_m());
  for (const double far : {1e5, 1e9, 1e300, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(field.at({far, 0, 0}).distance_m, field.reach_m());
    EXPECT_TRUE(field.at({0, -far, 0}).gradient.isZero(1e-12));
  }
}

TEST(ToolPoints, AreShellPointsCoveringTheWholeArea) {
  const mesh::TriangleMesh mesh = sphere_mesh(0.01, 4);
  const pointshell::Pointshell shell = exact_shell(mesh, 0.001);
  double last = 1.0;
  for (const std::size_t most : {1u, 16u, 128u, 100000u}) {
    const rendering::ToolPoints tool = rendering::spread_tool_points(shell, most);
    EXPECT_EQ(tool.points.size(), std::min(most, shell.size()));
    double fraction = 0.0, farthest = 0.0;
    for (const effects::ToolPoint& point : tool.points)
      fraction += point.fraction, farthest = std::max(farthest, point.position.norm());
    EXPECT_NEAR(fraction, 1.0, 1e-12);
    for (const effects::ToolPoint& point : tool.points) {
      EXPECT_LT(point.fraction * static_cast<double>(tool.points.size()), 8.0)
          << "of a ball all shares are alike, nearly";
    }
    EXPECT_EQ(tool.reach_m, farthest);
    double gap = 0.0;
    for (std::size_t p = 0; p < shell.size(); ++p) {
      double nearest = 1.0;
      for (const effects::ToolPoint& point : tool.points)
        nearest = std::min(nearest, (shell.point(p) - point.position).norm());
      gap = std::max(gap, nearest);
    }
    EXPECT_EQ(tool.gap_m, gap);
    EXPECT_LT(gap, last);
    last = gap;
  }
  EXPECT_LT(rendering::spread_tool_points(shell).gap_m, 0.0025);
  EXPECT_TRUE(rendering::spread_tool_points({}).points.empty());
}

}  // namespace
}  // namespace voxtouch::test
