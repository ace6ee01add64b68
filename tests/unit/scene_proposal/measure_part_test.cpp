#include "core/scene_proposal/measure_part.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/mesh/report.hpp"
#include "tests/unit/scene_proposal/boxes.hpp"

namespace voxtouch::scene_proposal {
namespace {

using test::add_box;
using test::box;

TEST(LikelyUnit, IsTheOneThatMakesAPartFitADesk) {
  EXPECT_STREQ(likely_unit(0.08).name, "m");
  EXPECT_STREQ(likely_unit(0.6).name, "m");
  EXPECT_STREQ(likely_unit(12.0).name, "mm");
  EXPECT_STREQ(likely_unit(300.0).name, "mm");
}

TEST(WallThickness, OfABlockIsItsThinnestExtent) {
  EXPECT_NEAR(*wall_thickness_m(box({0, 0, 0}, {0.1, 0.08, 0.002})), 0.002, 1e-12);
  EXPECT_NEAR(*wall_thickness_m(box({-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01})), 0.02, 1e-12);
}

TEST(WallThickness, OfAHollowBoxIsThatOfItsWalls) {
  mesh::TriangleMesh hollow = box({0, 0, 0}, {0.1, 0.1, 0.1});
  add_box(hollow, {0.003, 0.003, 0.003}, {0.097, 0.097, 0.097}, true);
  EXPECT_NEAR(*wall_thickness_m(hollow), 0.003, 1e-9);
}

TEST(WallThickness, IgnoresASmallThinPart) {
  mesh::TriangleMesh mesh = box({0, 0, 0}, {0.1, 0.1, 0.05});
  add_box(mesh, {0.2, 0, 0}, {0.201, 0.01, 0.01});  // a hundredth of the area
  EXPECT_NEAR(*wall_thickness_m(mesh), 0.05, 1e-9);
}

TEST(WallThickness, IsNoneOfASheet) {
  mesh::TriangleMesh sheet{.vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}},
                           .triangles = {{0, 1, 2}}};
  EXPECT_FALSE(wall_thickness_m(sheet));
  EXPECT_FALSE(wall_thickness_m({}));
}

TEST(PlaceToTouch, IsOnTopInTheMiddle) {
  const Vec3 place = place_to_touch(box({0, 0, 0}, {0.1, 0.08, 0.02}));
  EXPECT_LT((place - Vec3(0.05, 0.04, 0.02)).norm(), 1e-12);
}

TEST(PlaceToTouch, OverAHoleIsTheHighestVertex) {
  mesh::TriangleMesh frame = box({0, 0, 0}, {0.1, 0.02, 0.02});
  add_box(frame, {0, 0.08, 0}, {0.1, 0.1, 0.03});  // two beams with nothing between them
  EXPECT_DOUBLE_EQ(place_to_touch(frame).z(), 0.03);
}

}  // namespace
}  // namespace voxtouch::scene_proposal
