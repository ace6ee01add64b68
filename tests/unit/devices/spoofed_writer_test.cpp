// A participant that sends under the coupling's identity passes every filter of the network. Gate
// and guard bound its effect.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "devices/command_gate.hpp"
#include "devices/force_guard.hpp"
#include "devices/sim/parameters.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::devices {
namespace {

constexpr std::uint64_t kWriter = 5, kSession = 7;
constexpr std::int64_t kPeriodNs = 1'000'000;

struct Loop {
  explicit Loop(const DeviceDescription& device) : guard(guard_config(device)) {}
  void offer(std::uint64_t sequence, double force_n, std::int64_t valid_until_ns) {
    const GateVerdict verdict = gate.accept(kWriter, kSession, sequence, sample);
    guard.count(verdict);
    if (verdict == GateVerdict::kAccepted)
      newest = GuardInput{{Vec3(force_n, 0, 0), Vec3::Zero()}, valid_until_ns};
  }
  double cycle() {
    const double force =
        guard.pass(newest, static_cast<std::int64_t>(sample) * kPeriodNs).force.x();
    newest.reset();
    ++sample;
    return force;
  }
  CommandGate gate{kSession};
  ForceGuard guard;
  std::uint64_t sample = 0;
  std::optional<GuardInput> newest;
};

TEST(SpoofedWriter, IsLimitedAndTheCouplingTakesOverAfterwards) {
  const DeviceDescription device = sim::sim_phantom().description;
  const auto chosen = testing::seed(1);
  SCOPED_TRACE(testing::seed_trace(chosen));
  std::mt19937_64 random(chosen);
  Loop loop(device);
  const auto genuine = [&] {
    loop.offer(loop.sample, 0.3, static_cast<std::int64_t>(loop.sample + 5) * kPeriodNs);
  };
  for (int i = 0; i < 1000; ++i)
    genuine(), loop.cycle();
  double last = loop.cycle();
  const double most_step = device.max_force_rate_n_per_s * 1e-3 * (1 + 1e-9);
  const double forces[] = {1e300,
                           -1e300,
                           8.5,
                           -8.5,
                           std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()};
  for (int i = 0; i < 5000; ++i) {
    for (int k = 0; k < 5; ++k)
      loop.offer(k == 0 ? std::numeric_limits<std::uint64_t>::max() - random() % 3
                        : loop.sample - random() % 2,
                 forces[random() % std::size(forces)],
                 std::numeric_limits<std::int64_t>::max() - random() % 2);
    genuine();
    const double force = loop.cycle();
    ASSERT_TRUE(std::isfinite(force));
    ASSERT_LE(std::abs(force), device.max_force_n);
    ASSERT_LE(std::abs(force - last), most_step) << "sample " << loop.sample;
    last = force;
  }
  // Its last command, valid for ever, is repeated no longer than any command.
  int periods = 0;
  while (std::abs(last - 0.3) > 1e-6 && periods < 1000)
    genuine(), last = loop.cycle(), ++periods;
  EXPECT_LT(periods, 150) << "the coupling is displayed again";
  loop.offer(loop.sample, 8.5, std::numeric_limits<std::int64_t>::max());
  for (int i = 0; i < 30; ++i)
    last = loop.cycle();
  EXPECT_EQ(last, 0.0)
      << "a command that is valid for ever fades as any other where nothing follows it";
}

}  // namespace
}  // namespace voxtouch::devices
