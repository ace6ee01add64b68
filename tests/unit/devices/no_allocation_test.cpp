/// Counts heap allocations, beneath `operator new` too, during the calls of the loop.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include "devices/force_guard.hpp"
#include "devices/registry.hpp"
#include "tests/support/heap_count/heap_count.hpp"

namespace voxtouch::devices {
namespace {

TEST(NoAllocation, ReadGuardWriteAndStopTakeNothingFromTheHeap) {
  if (!test::heap_is_counted())
    GTEST_SKIP() << "the sanitiser owns malloc";
  for (const char* name : {"sim-phantom", "sim-lwr"}) {
    DeviceOptions options;
    options.hand = usual_hand(name);
    options.hand->tremor_n = 0.1;
    options.motion.emplace().path = {Vec3::Zero(), Vec3(0.05, 0, 0)};
    options.is_led = name == std::string_view("sim-lwr");
    const auto device = open_device(name, options);
    ForceGuard guard(guard_config(device->description()));
    CommandGate gate(1);
    const Quat turn(Eigen::AngleAxisd(0.1, Vec3::UnitZ()));
    EXPECT_EQ(test::heap_count_of([&] {
                for (std::uint64_t i = 0; i < 500; ++i) {
                  device->lead_hand({Vec3(0.001 * static_cast<double>(i % 9), 0, 0), turn});
                  const auto sample = device->read(std::chrono::microseconds(0));
                  guard.count(gate.accept(1, 1, i / 2, i));
                  const GuardInput input{{Vec3(i % 7 ? 1.0 : 1e9, 0, 0), Vec3::Zero()},
                                         sample->time_ns + 3'000'000};
                  (void)device->write(guard.pass(input, sample->time_ns));
                  if (i % 10 == 0)
                    (void)device->read(std::chrono::microseconds(0));
                  if (i % 11 == 0)
                    (void)device->write({Vec3(std::nan(""), 0, 0), Vec3::Zero()});
                }
                device->stop();
                guard.stop();
              }),
              0);
  }
}

}  // namespace
}  // namespace voxtouch::devices
