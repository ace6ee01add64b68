/// Counts what is asked of the heap, beneath `operator new` too, while the calls of the loop run.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include "devices/force_guard.hpp"
#include "devices/registry.hpp"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GLIBC__)
#define VOXTOUCH_COUNTS_MALLOC 1
namespace {
thread_local bool counting = false;
thread_local long asked = 0;
}  // namespace
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* malloc(std::size_t size) {
  asked += counting;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  asked += counting;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  asked += counting;
  return __libc_realloc(old, size);
}
}
#endif

namespace voxtouch {
namespace {

#ifdef VOXTOUCH_COUNTS_MALLOC
template <class Body>
long count(Body body) {
  asked = 0;
  counting = true;
  body();
  counting = false;
  return asked;
}

TEST(NoAllocation, TheCounterSeesNewAndMalloc) {
  EXPECT_GE(count([] { delete new volatile int(1); }), 1);
  EXPECT_GE(count([] { std::string(100, 'x').push_back('y'); }), 1);
}

TEST(NoAllocation, ReadGuardWriteAndStopTakeNothingFromTheHeap) {
  for (const char* name : {"sim-phantom", "sim-lwr"}) {
    DeviceOptions options;
    options.hand = usual_hand(name);
    options.hand->tremor_n = 0.1;
    options.motion.emplace().path = {Vec3::Zero(), Vec3(0.05, 0, 0)};
    const auto device = open_device(name, options);
    ForceGuard guard(guard_config(device->description()));
    CommandGate gate(1);
    EXPECT_EQ(count([&] {
                for (std::uint64_t i = 0; i < 500; ++i) {
                  const auto sample = device->read(std::chrono::microseconds(0));
                  guard.count(gate.accept(1, 1, i / 2, i));
                  const GuardInput input{{Vec3(i % 7 ? 1.0 : 1e9, 0, 0), Vec3::Zero()}, sample->time_ns + 3'000'000};
                  (void)device->write(guard.pass(input, sample->time_ns));
                  if (i % 10 == 0) (void)device->read(std::chrono::microseconds(0));
                  if (i % 11 == 0) (void)device->write({Vec3(std::nan(""), 0, 0), Vec3::Zero()});
                }
                device->stop();
                guard.stop();
              }),
              0);
  }
}
#else
TEST(NoAllocation, IsNotCountedUnderASanitiser) { GTEST_SKIP() << "the sanitiser owns malloc"; }
#endif

}  // namespace
}  // namespace voxtouch
