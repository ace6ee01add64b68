/// Parts of a mesh that touch or overlap are one solid.
#include <gtest/gtest.h>

#include "core/exact/limits.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

/// A box that slides from x = -20 mm to 20 mm, pressed 3 mm deep and rotated.
void slides_as_on_one_plane(const mesh::TriangleMesh& object,
                            const std::vector<double>& turns = {0.0, 0.003, 0.7}) {
  for (const double turn : turns) {
    Rig rig(test::box({-.005, -.004, -.003}, {.005, .004, .003}), object);
    Pose hand{{-0.02, 0.001, 0.004}, turned(turn, Vec3::UnitZ())};
    ASSERT_TRUE(rig.virtual_tool.place(hand, {&rig.object_pose, 1}));
    for (int k = 0; k < 40; ++k) {
      hand.position.z() -= 1e-4;
      rig.frame(hand);
    }
    for (int k = 0; k < 400; ++k) {
      hand.position.x() += 1e-4;
      const VirtualToolFrame frame = rig.frame(hand);
      ASSERT_LT(angle_between(-frame.shift, Vec3::UnitZ()), 0.001 * kDegree) << k << ' ' << turn;
      ASSERT_NEAR(frame.tool.position.z(), 0.003 + limits::kMarginM, 2e-8) << k;
      ASSERT_LT(frame.rotation.norm(), 1e-5) << k;
    }
  }
}

TEST(CoveredFeatures, SeamOfTwoBoxesIsAbsent) {
  slides_as_on_one_plane(
      test::joined(test::box({-.1, -.1, -.02}, {0, .1, 0}), test::box({0, -.1, -.02}, {.1, .1, 0})),
      {0.0});
}

TEST(CoveredFeatures, SeamOfUnequalBoxesIsAbsent) {
  slides_as_on_one_plane(test::joined(test::box({-.1, -.1, -.02}, {0, .1, 0}),
                                      test::box({0, -.05, -.03}, {.1, .2, 0})));
}

TEST(CoveredFeatures, BoxesThatOverlapAreOne) {
  slides_as_on_one_plane(test::joined(test::box({-.1, -.1, -.02}, {.005, .1, 0}),
                                      test::box({-.005, -.1, -.02}, {.1, .1, 0})));
}

TEST(CoveredFeatures, TJunctionsOfASheetAreAbsent) {
  slides_as_on_one_plane(test::sheet(0.1, 10, true));
}

TEST(CoveredFeatures, FreeFeaturesStay) {
  const mesh::TriangleMesh box = test::box({-.1, -.1, -.02}, {.1, .1, 0});
  const mesh::TriangleMesh post = test::box({-.01, -.01, -.01}, {.01, .01, .05});
  const FeatureMesh alone = free_features(post), both = free_features(test::joined(box, post));
  EXPECT_EQ(alone.row_edges.size(), 12u);
  EXPECT_EQ(alone.row_vertices.size(), 8u);
  EXPECT_EQ(both.row_edges.size(), 12u + 8u);  // four at the post's foot are inside the box
  EXPECT_EQ(both.row_vertices.size(), 8u + 4u);
  for (const std::uint32_t e : both.row_edges)
    for (const std::uint32_t end : both.edges[e].ends)
      EXPECT_TRUE(std::abs(both.points[end].x()) > 0.09 || both.points[end].z() > -1e-9);
}

}  // namespace
}  // namespace voxtouch::exact
