#include "core/voxmap/triangle_voxels.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/voxmap/exact_sign.hpp"

namespace voxtouch::voxmap {
namespace {

using Int = __int128;
using IntVec = std::array<std::int64_t, 3>;

/// The plain test of 13 axes, both sides of each, in integers: nothing is shared with the code
/// under test.
Meeting plain_meeting(const std::array<IntVec, 3>& triangle, const VoxelIndex& v,
                      std::int64_t unit) {
  std::vector<std::array<Int, 3>> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::array<std::array<Int, 3>, 3> edge{};
  for (std::size_t n = 0; n < 3; ++n)
    for (std::size_t axis = 0; axis < 3; ++axis)
      edge[n][axis] = triangle[(n + 1) % 3][axis] - triangle[n][axis];
  const auto cross = [](const auto& a, const auto& b) {
    return std::array<Int, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                              a[0] * b[1] - a[1] * b[0]};
  };
  for (std::size_t n = 0; n < 3; ++n)
    for (std::size_t axis = 0; axis < 3; ++axis)
      axes.push_back(cross(axes[axis], edge[n]));
  axes.push_back(cross(edge[0], edge[1]));
  Meeting result = Meeting::kOpen;
  for (const auto& axis : axes) {
    if (axis[0] == 0 && axis[1] == 0 && axis[2] == 0)
      continue;
    Int box_low = 0, box_high = 0, low = 0, high = 0;
    const std::array<std::int64_t, 3> at{v.i, v.j, v.k};
    for (std::size_t n = 0; n < 3; ++n) {
      box_low += axis[n] * (at[n] + (axis[n] < 0)) * unit;
      box_high += axis[n] * (at[n] + (axis[n] > 0)) * unit;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const Int x = axis[0] * triangle[c][0] + axis[1] * triangle[c][1] + axis[2] * triangle[c][2];
      low = c == 0 || x < low ? x : low;
      high = c == 0 || x > high ? x : high;
    }
    if (high < box_low || low > box_high)
      return Meeting::kNone;
    if (high == box_low || low == box_high)
      result = Meeting::kTouch;
  }
  return result;
}

void compare_with_plain_test(std::mt19937& random, std::int64_t unit, std::int64_t range,
                             std::int64_t step) {
  std::uniform_int_distribution<std::int64_t> pick(-range, range);
  std::array<IntVec, 3> whole{};
  for (auto& corner : whole)
    for (auto& x : corner)
      x = pick(random) * step;
  if (random() % 8 == 0)
    whole[2] = whole[random() % 2];
  if (random() % 8 == 0)
    for (std::size_t n = 0; n < 3; ++n)
      whole[2][n] = 2 * whole[1][n] - whole[0][n];
  if (random() % 8 == 0)
    whole[0][random() % 3] = whole[1][0] / unit * unit;
  std::array<Vec3, 3> u;
  for (std::size_t n = 0; n < 3; ++n)
    u[n] = Vec3(double(whole[n][0]), double(whole[n][1]), double(whole[n][2])) / double(unit);

  const TriangleVoxels triangle(u[0], u[1], u[2]);
  std::set<VoxelIndex> runs;
  triangle.for_each_run(
      -1000, 1000, [&](std::int32_t i, std::int32_t row, std::int32_t first, std::int32_t last) {
        for (std::int32_t n = first; n <= last; ++n)
          ASSERT_TRUE(
              runs.insert(triangle.run_axis() == 2 ? VoxelIndex{i, row, n} : VoxelIndex{i, n, row})
                  .second);
      });
  std::size_t met = 0;
  const auto &first = triangle.first(), &last = triangle.last();
  for (std::int32_t i = first[0] - 1; i <= last[0] + 1; ++i)
    for (std::int32_t j = first[1] - 1; j <= last[1] + 1; ++j)
      for (std::int32_t k = first[2] - 1; k <= last[2] + 1; ++k) {
        const VoxelIndex v{i, j, k};
        const Meeting expected = plain_meeting(whole, v, unit);
        ASSERT_EQ(triangle.meeting(v), expected) << i << ' ' << j << ' ' << k << " unit " << unit;
        ASSERT_EQ(runs.contains(v), expected != Meeting::kNone)
            << i << ' ' << j << ' ' << k << " unit " << unit;
        met += expected != Meeting::kNone;
      }
  ASSERT_EQ(met, runs.size());
}

TEST(TriangleVoxels, EqualsThePlainTestInIntegers) {
  std::mt19937 random(1);
  for (int n = 0; n < 4000; ++n)
    compare_with_plain_test(random, 256, 700, 1);  // anywhere
  // corners on borders and halves
  for (int n = 0; n < 4000; ++n)
    compare_with_plain_test(random, 256, 6, 128);
  for (int n = 0; n < 3000; ++n)
    compare_with_plain_test(random, 256, 3, 256);  // corners on voxel corners
  for (int n = 0; n < 300; ++n)
    compare_with_plain_test(random, 1 << 20, 9 << 20, 1);
  // smaller than a voxel
  for (int n = 0; n < 3000; ++n)
    compare_with_plain_test(random, 1 << 20, 1 << 18, 1);
}

TEST(TriangleVoxels, DecidesOneUlpAwayFromABorder) {
  const double below = std::nextafter(1.0, 0.0), above = std::nextafter(1.0, 2.0);
  const auto meets = [](double x, const VoxelIndex& v) {
    return TriangleVoxels(Vec3(x, 0.25, 0.25), Vec3(x, 0.75, 0.25), Vec3(x, 0.25, 0.75)).meeting(v);
  };
  EXPECT_EQ(meets(below, {0, 0, 0}), Meeting::kOpen);
  EXPECT_EQ(meets(below, {1, 0, 0}), Meeting::kNone);
  EXPECT_EQ(meets(1.0, {0, 0, 0}), Meeting::kTouch);
  EXPECT_EQ(meets(1.0, {1, 0, 0}), Meeting::kTouch);
  EXPECT_EQ(meets(above, {0, 0, 0}), Meeting::kNone);
  // A plane through the far corner (1,1,1) of voxel 0, and the same plane one ulp further out.
  const auto slanted = [](double shift) {
    return TriangleVoxels(Vec3(3 + shift, 0, 0), Vec3(0, 3 + shift, 0), Vec3(0, 0, 3 + shift))
        .meeting({0, 0, 0});
  };
  EXPECT_EQ(slanted(0.0), Meeting::kTouch);
  EXPECT_EQ(slanted(-0x1p-51), Meeting::kOpen);
  EXPECT_EQ(slanted(0x1p-51), Meeting::kNone);
}

TEST(ExactSign, SeesThroughCancellation) {
  const double tiny = 0x1p-200, big = 0x1p+200;
  EXPECT_GT(orient2d(0, 0, 1, 1, 0.5, 0.5 + 0x1p-53), 0.0);
  EXPECT_EQ(orient2d(0, 0, 3, 3, 1.0 / 3, 1.0 / 3), 0.0);
  EXPECT_GT(orient2d(-big, -big, big, big, 0, tiny), 0.0);
  EXPECT_LT(orient2d(-big, -big, big, big, tiny, 0), 0.0);
  EXPECT_GT(orient3d(Vec3(0, 0, 0), Vec3(1, 0, 1), Vec3(0, 1, 1), Vec3(0.25, 0.25, 0.5 + 0x1p-53)),
            0.0);
  EXPECT_EQ(orient3d(Vec3(0, 0, 0), Vec3(1, 0, 1), Vec3(0, 1, 1), Vec3(0.25, 0.25, 0.5)), 0.0);
  EXPECT_LT(orient3d(Vec3(0, 0, 0), Vec3(1, 0, 1), Vec3(0, 1, 1), Vec3(0.25, 0.25, 0.5 - 0x1p-54)),
            0.0);
  EXPECT_TRUE(area_vector(Vec3(0.1, 0.2, 0.3), Vec3(0.1, 0.2, 0.3), Vec3(1, 2, 3)).isZero(0.0));
  EXPECT_FALSE(area_vector(Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(2, 2, 0x1p-300)).isZero(0.0));
}

}  // namespace
}  // namespace voxtouch::voxmap
