#include "core/exact/box_tree.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace voxtouch::exact {
namespace {

std::vector<Box> random_boxes(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> place(-1.0, 1.0), size(0.0, 0.1);
  std::vector<Box> boxes(count);
  for (Box& box : boxes) {
    const Vec3 low(place(random), place(random), place(random));
    box.add(low);
    box.add(low + Vec3(size(random), size(random), size(random)));
  }
  return boxes;
}

TEST(BoxTree, MatchesBruteForceAndBoundsTheRest) {
  std::mt19937 random(7);
  for (const std::size_t count : {1u, 3u, 5u, 64u, 1000u}) {
    const std::vector<Box> boxes = random_boxes(count, random);
    const BoxTree tree(boxes);
    for (int k = 0; k < 50; ++k) {
      const Box probe = random_boxes(1, random)[0];
      const double range = 0.01 * k;
      std::set<std::uint32_t> found;
      Work work;
      const auto bound = [&](const Box& box) { return distance(box, probe); };
      const auto walked = tree.walk(
          bound, range, [&](std::uint32_t item) { return found.insert(item).second; }, work);
      EXPECT_TRUE(walked.whole);
      for (std::uint32_t n = 0; n < boxes.size(); ++n) {
        const double far = distance(boxes[n], probe);
        if (far <= range) {
          EXPECT_TRUE(found.contains(n));
        }
        if (!found.contains(n)) {
          EXPECT_GE(far, walked.beyond_m);
        }
      }
      EXPECT_GT(walked.beyond_m, range);
    }
  }
}

TEST(BoxTree, StopsAtItsLimitAndReportsIt) {
  std::mt19937 random(8);
  const BoxTree tree(random_boxes(1000, random));
  Work work(20);
  const auto bound = [](const Box&) { return 0.0; };
  EXPECT_FALSE(tree.walk(
                       bound, 1.0, [](std::uint32_t) { return true; }, work)
                   .whole);
  EXPECT_LT(work.used(), 40u);
}

}  // namespace
}  // namespace voxtouch::exact
