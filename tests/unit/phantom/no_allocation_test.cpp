/// Counts what any thread asks of the heap while an open driver runs: the loop's calls, and the servo thread's callback.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>

#include "devices/phantom/phantom_driver.hpp"
#include "tests/unit/phantom_sim/library.hpp"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GLIBC__)
#define VOXTOUCH_COUNTS_MALLOC 1
namespace {
std::atomic<bool> counting{false};
std::atomic<long> asked{0};
void note() noexcept {
  if (counting.load(std::memory_order_relaxed)) asked.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* malloc(std::size_t size) {
  note();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  note();
  return __libc_realloc(old, size);
}
}
#endif

namespace voxtouch {
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
  static void turn(PhantomDriver& driver, int i) {
    (void)driver.read(500ms);
    (void)driver.write({Vec3(i % 7 ? 1.0 : 1e9, 0, 0), Vec3::Zero()});
    if (i % 11 == 0) (void)driver.write({Vec3(std::nan(""), 0, 0), Vec3::Zero()});
    if (i % 13 == 0) driver.stop();
    (void)driver.status();
  }
};

#ifdef VOXTOUCH_COUNTS_MALLOC
template <class Body>
long count(Body body) {
  asked = 0;
  counting = true;
  body();
  counting = false;
  return asked;
}

TEST_F(NoAllocation, TheCounterSeesNew) {
  EXPECT_GE(count([] { delete new volatile int(1); }), 1);
}

TEST_F(NoAllocation, AnOpenDriverAndItsCallbackTakeNothingFromTheHeap) {
  PhantomDriver driver(options(true));
  for (int i = 0; i < 10; ++i) turn(driver, i);
  EXPECT_EQ(count([&] {
              for (int i = 0; i < 500; ++i) {
                turn(driver, i);
                if (i == 100) sim.inject(HDSIM_WARM_MOTORS, 1.0);
                if (i == 150) sim.inject(HDSIM_WARM_MOTORS, 0.8);
                if (i == 200) sim.inject(HDSIM_NAN_POSITION, 5);
                if (i == 250) sim.inject(HDSIM_SKIPPED_TICKS, 600);
                if (i == 300) sim.inject(HDSIM_COMM_ERROR, -1);
              }
            }),
            0);
  EXPECT_EQ(driver.read(10ms).error(), DeviceError::kDisconnected);
}

TEST_F(NoAllocation, NorDoTheyInTheServoThread) {
  PhantomDriver driver(options(false));
  for (int i = 0; i < 50; ++i) turn(driver, i);
  EXPECT_EQ(count([&] {
              for (int i = 0; i < 300; ++i) turn(driver, i);
            }),
            0);
  EXPECT_GT(driver.status().pushed, 0u);
}
#else
TEST_F(NoAllocation, IsNotCountedUnderASanitiser) { GTEST_SKIP() << "the sanitiser owns malloc"; }
#endif

}  // namespace
}  // namespace voxtouch
