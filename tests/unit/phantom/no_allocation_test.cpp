/// Counts heap allocations of all threads while an open driver runs: the loop's calls, and the
/// servo thread's callback.
#include <gtest/gtest.h>

#include "devices/phantom/phantom_driver.hpp"
#include "tests/support/heap_count/heap_count.hpp"
#include "tests/unit/phantom_sim/library.hpp"

namespace voxtouch::phantom {
namespace {

using namespace std::chrono_literals;

class NoAllocation : public hd_sim_test::SimulatedLibrary {
 protected:
  PhantomOptions options(bool virtual_time) {
    EXPECT_EQ(sim.use_virtual_time(virtual_time), 0);
    PhantomOptions o;
    o.library = VOXTOUCH_HD_SIM_LIBRARY;
    return o;
  }
  static void cycle(PhantomDriver& driver, int i) {
    (void)driver.read(500ms);
    (void)driver.write({Vec3(i % 7 ? 1.0 : 1e9, 0, 0), Vec3::Zero()});
    if (i % 11 == 0)
      (void)driver.write({Vec3(std::nan(""), 0, 0), Vec3::Zero()});
    if (i % 13 == 0)
      driver.stop();
  }
};

TEST_F(NoAllocation, OpenDriverAndCallbackUseNoHeap) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  PhantomDriver driver(options(true));
  for (int i = 0; i < 10; ++i)
    cycle(driver, i);
  EXPECT_EQ(test::heap_count_of(
                [&] {
                  for (int i = 0; i < 500; ++i) {
                    cycle(driver, i);
                    if (i == 100)
                      sim.inject(HDSIM_WARM_MOTORS, 1.0);
                    if (i == 150)
                      sim.inject(HDSIM_WARM_MOTORS, 0.8);
                    if (i == 200)
                      sim.inject(HDSIM_NAN_POSITION, 5);
                    if (i == 250)
                      sim.inject(HDSIM_SKIPPED_TICKS, 600);
                    if (i == 300)
                      sim.inject(HDSIM_COMM_ERROR, -1);
                  }
                },
                test::HeapOf::kAllThreads),
            0);
  EXPECT_EQ(driver.read(10ms).error(), devices::DeviceError::kDisconnected);
}

TEST_F(NoAllocation, ServoThreadUsesNoHeap) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  PhantomDriver driver(options(false));
  for (int i = 0; i < 50; ++i)
    cycle(driver, i);
  EXPECT_EQ(test::heap_count_of(
                [&] {
                  for (int i = 0; i < 300; ++i)
                    cycle(driver, i);
                },
                test::HeapOf::kAllThreads),
            0);
  EXPECT_GT(driver.servo().counts().applied.load(), 0u);
}

}  // namespace
}  // namespace voxtouch::phantom
