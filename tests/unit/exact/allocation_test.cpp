#include <gtest/gtest.h>

#include "tests/support/heap_count/heap_count.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

TEST(Allocation, NothingAllocatesAfterConstruction) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "a sanitiser owns malloc";
  Rig rig(test::box({-.004, -.006, -.015}, {.004, .006, .015}), test::bowl(0.03, 0.034, 48, 12));
  const long calls = test::heap_count_of([&] {
    for (int k = 0; k < 1500; ++k) {
      const double t = 1e-3 * k;
      rig.object_pose.position.z() = k > 900 ? 1e-5 * (k - 900) : 0.0;
      rig.frame({Vec3(0.03 * std::sin(33 * t), 0.03 * std::sin(25 * t), -0.02 * std::sin(29 * t)),
                 turned(7.0 * t, Vec3(1, 2, 3))},
                k > 500 ? 0.4 : 0.0);
      if (k == 1200)
        rig.virtual_tool.reset();
    }
  });
  EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace voxtouch::exact
