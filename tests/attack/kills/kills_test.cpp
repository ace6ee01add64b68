// Each process of the ring killed and stopped in contact, once or twice; kill_campaign does it a
// hundred times.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/attack/kills/round.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::attack {
namespace {

struct Case {
  const char* victim;
  int signal;
  int times;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.victim << (c.signal == SIGKILL ? " killed" : " stopped");
}

class KilledOrStopped : public testing::TestWithParam<Case> {};

TEST_P(KilledOrStopped, LeavesTheDeviceAtZeroAndNothingBehind) {
  for (int n = 0; n < GetParam().times; ++n) {
    const RoundResult r =
        play({.victim = GetParam().victim,
              .signal = GetParam().signal,
              .domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain())),
              .after_ms = 150 * n});
    if (r.zero_ms)
      std::printf(
          "zero after %.1f ms of samples, %.1f ms by this clock; the machine stood still for %.1f "
          "ms\n",
          *r.zero_ms, *r.zero_wall_ms, r.machine_ms);
    for (const std::string& fault : r.faults)
      ADD_FAILURE() << fault;
  }
}

INSTANTIATE_TEST_SUITE_P(Ring, KilledOrStopped,
                         testing::Values(Case{"rendering", SIGKILL, 2},
                                         Case{"rendering", SIGSTOP, 1},
                                         Case{"coupling", SIGKILL, 2}, Case{"coupling", SIGSTOP, 1},
                                         Case{"device", SIGKILL, 1}, Case{"device", SIGSTOP, 1},
                                         Case{"logger", SIGKILL, 1}, Case{"validator", SIGSTOP, 1},
                                         Case{"up", SIGKILL, 1}),
                         [](const auto& c) {
                           return std::string(c.param.victim) +
                                  (c.param.signal == SIGKILL ? "_killed" : "_stopped");
                         });

}  // namespace
}  // namespace voxtouch::attack
