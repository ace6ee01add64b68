// Shortened forms of the long runs; the long ones are the commands of tests/experiments/long_runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "tests/experiments/long_runs/long_runs.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::long_runs {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::uint64_t kShorter = 10;
#else
constexpr std::uint64_t kShorter = 1;
#endif

void expect_well(const Findings& f) {
  for (const std::string& line : f.lines)
    std::printf("%s\n", line.c_str());
  std::printf(
      "last tenth over first tenth: %.2f of CPU time; memory grew by %lld bytes, the heap by "
      "%lld\n",
      f.slow_down, static_cast<long long>(f.resident_growth),
      static_cast<long long>(f.heap_growth));
  for (const std::string& fault : f.faults)
    ADD_FAILURE() << fault;
}

TEST(H2BillionSteps, ConstantContactNeitherDriftsNorJumps) {
  FilterRunOptions ask;
  ask.steps = 20'000'000 / kShorter, ask.seed = testing::seed(2);
  SCOPED_TRACE(testing::seed_trace(ask.seed));
  expect_well(run_filter(ask));
}

TEST(LongContact, LongMotionLeavesNoTrace) {
  for (const char* model : {"original", "field"}) {
    ContactRunOptions ask;
    ask.scene = VOXTOUCH_DEPLOY "/scenes/cup_field.yaml", ask.model = model;
    ask.frames = 100'000 / kShorter, ask.seed = testing::seed(3);
    SCOPED_TRACE(testing::seed_trace(ask.seed));
    expect_well(run_contact(ask));
  }
}

TEST(F8OrientationDrift, StaysARotationOverAMillionIncrements) {
  TumbleRunOptions ask;
  ask.steps = 1'000'000;
  expect_well(run_tumble(ask));
}

TEST(HostileCommands, OnlyFiniteLimitedOnesReachADriver) {
  CommandRunOptions ask;
  ask.commands = 1'000'000, ask.seed = testing::seed(5);
  SCOPED_TRACE(testing::seed_trace(ask.seed));
  expect_well(run_commands(ask));
}

/// VOXTOUCH_TRAP_FRAMES sets how many; `long_runs traps` runs a million.
TEST(FloatingPointTraps, RandomContactRaisesNone) {
  TrapRunOptions ask;
  const char* frames = std::getenv("VOXTOUCH_TRAP_FRAMES");
  ask.frames =
      frames ? std::strtoull(frames, nullptr, 10) : 78'000 / std::min<std::uint64_t>(kShorter, 3);
  ask.scenes = VOXTOUCH_DEPLOY "/scenes", ask.seed = testing::seed(4);
  SCOPED_TRACE(testing::seed_trace(ask.seed));
  expect_well(run_traps(ask));
}

TEST(FloatingPointTraps, EndTheProcessAndNameTheFrame) {
  TrapRunOptions ask;
  ask.scenes = VOXTOUCH_DEPLOY "/scenes", ask.frames = 1300, ask.seed = 7, ask.trip_at = 50;
  EXPECT_EXIT(run_traps(ask), ::testing::KilledBySignal(SIGFPE), "original, frame 50, seed 7");
}

}  // namespace
}  // namespace voxtouch::long_runs
