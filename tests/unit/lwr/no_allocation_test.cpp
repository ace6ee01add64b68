/// Counts what is asked of the heap, beneath `operator new` too, while the driver's loop runs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "fake_controller.hpp"

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

namespace voxtouch::test {
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

TEST(LwrNoAllocation, TheCounterSeesNewAndMalloc) {
  EXPECT_GE(count([] { delete new volatile int(1); }), 1);
  EXPECT_GE(count([] { std::string(100, 'x').push_back('y'); }), 1);
}

TEST(LwrNoAllocation, NothingIsTakenFromTheHeapWhateverHappens) {
  FakeController krc;
  LwrOptions options = quick_options();
  options.capture_file = testing::TempDir() + "voxtouch_lwr_no_allocation.pcap";
  options.capture_packets = 50;
  const auto driver = krc.open(options);
  ASSERT_TRUE(run_to_command(krc, *driver));
  const fri::MsrPacket good = krc.msr;
  long taken = 0;
  int pushed = 0, failed = 0;
  for (int n = 0; n < 500; ++n) {
    const std::uint16_t sequence = krc.msr.header.send_seq;
    krc.msr = good;
    krc.msr.header.send_seq = sequence;
    if (n % 7 == 1) krc.msr.data.jnt_pos[0] = std::nanf("");
    if (n % 7 == 2) krc.msr.data.cmd_jnt_pos[0] = std::nanf("");
    if (n % 7 == 3) krc.msr.interface.quality = fri::Quality::kBad;
    if (n % 7 != 4) krc.send();
    if (n % 11 == 5) krc.send_bytes(std::as_bytes(std::span("no packet")));
    taken += count([&] {
      const auto sample = driver->read(std::chrono::microseconds(500));
      const Wrench wrench{Vec3(n % 13 ? 10.0 : 1e6, 0, 0), Vec3::Zero()};
      const bool written = sample && driver->write(wrench);
      (written ? pushed : failed) += 1;
      if (!written) driver->stop();
      (void)driver->status();
    });
    krc.receive();
  }
  EXPECT_EQ(taken, 0);
  EXPECT_GT(pushed, 100);
  EXPECT_GT(failed, 100);
  std::remove(options.capture_file.c_str());
}
#else
TEST(LwrNoAllocation, IsNotCountedUnderASanitiser) { GTEST_SKIP() << "the sanitiser owns malloc"; }
#endif

}  // namespace
}  // namespace voxtouch::test
