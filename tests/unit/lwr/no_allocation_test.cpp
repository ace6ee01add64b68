/// Counts heap allocations, beneath `operator new` too, while the driver's loop runs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "fake_controller.hpp"
#include "tests/support/heap_count/heap_count.hpp"

namespace voxtouch::test {
namespace {

TEST(LwrNoAllocation, NothingUsesTheHeap) {
  if (!heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  FakeController krc;
  lwr::LwrOptions options = quick_options();
  options.capture_file = testing::TempDir() + "voxtouch_lwr_no_allocation.pcap";
  options.capture_packets = 50;
  const auto driver = krc.open(options);
  ASSERT_TRUE(run_to_command(krc, *driver));
  const lwr::fri::MsrPacket good = krc.msr;
  long allocated = 0;
  int pushed = 0, failed = 0;
  for (int n = 0; n < 500; ++n) {
    const std::uint16_t sequence = krc.msr.header.send_seq;
    krc.msr = good;
    krc.msr.header.send_seq = sequence;
    if (n % 7 == 1)
      krc.msr.data.jnt_pos[0] = std::nanf("");
    if (n % 7 == 2)
      krc.msr.data.cmd_jnt_pos[0] = std::nanf("");
    if (n % 7 == 3)
      krc.msr.interface.quality = lwr::fri::Quality::kBad;
    if (n % 7 != 4)
      krc.send();
    if (n % 11 == 5)
      krc.send_bytes(std::as_bytes(std::span("no packet")));
    allocated += heap_count_of([&] {
      const auto sample = driver->read(std::chrono::microseconds(500));
      const Wrench wrench{Vec3(n % 13 ? 10.0 : 1e6, 0, 0), Vec3::Zero()};
      const bool written = sample && driver->write(wrench);
      (written ? pushed : failed) += 1;
      if (!written)
        driver->stop();
    });
    krc.receive();
  }
  EXPECT_EQ(allocated, 0);
  EXPECT_GT(pushed, 100);
  EXPECT_GT(failed, 100);
  std::remove(options.capture_file.c_str());
}

}  // namespace
}  // namespace voxtouch::test
