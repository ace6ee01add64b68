// Who runs before all else on a machine, and when: a ring in real time while it has samples to answer, and nobody else.
#include <gtest/gtest.h>

#include <sched.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<pid_t> threads_of(pid_t process) {
  std::vector<pid_t> threads;
  std::error_code gone;
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task", gone))
    threads.push_back(std::stoi(task.path().filename()));
  return threads;
}

/// Of all nodes of a ring that has begun.
int urgent_threads(const Process& up) {
  int urgent = 0;
  for (const pid_t node : children_of(up.pid()))
    for (const pid_t thread : threads_of(node)) urgent += sched_getscheduler(thread) == SCHED_FIFO;
  return urgent;
}

bool granted() {
  bool is = false;
  std::thread([&] {
    const sched_param lowest{.sched_priority = 1};
    is = sched_setscheduler(0, SCHED_FIFO, &lowest) == 0;
  }).join();
  return is;
}

Process start(const std::vector<std::string>& more) {
  std::vector<std::string> words{VOXTOUCH_BIN "/voxtouch", "up", shipped_scene("cup"), "--motion", "slide", "--no-record", "--domain", fresh_domain()};
  words.insert(words.end(), more.begin(), more.end());
  return Process(words);
}

bool comes(const std::function<bool()>& holds) {
  for (const auto until = Clock::now() + std::chrono::seconds(20); !holds(); std::this_thread::sleep_for(std::chrono::milliseconds(5)))
    if (Clock::now() > until) return false;
  return true;
}

/// It never rests: as urgent as a ring in real time, it would keep one on the same machine from running.
TEST(Priority, OfARingInLockstepIsThatOfAnyProgram) {
  if (!granted()) GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  const Process up = start({"--lockstep", "--duration", "600"});
  ASSERT_TRUE(comes([&] { return children_of(up.pid()).size() == 4; }));
  for (int n = 0; n < 300; ++n) {
    ASSERT_EQ(urgent_threads(up), 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST(Priority, OfARingInRealTimeIsAboveAllOthersWhileItRunsAndNotWhileItIsBuilt) {
  if (!granted()) GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  const Process up = start({"--duration", "600"});
  pid_t rendering = 0;
  ASSERT_TRUE(comes([&] { return (rendering = child_called(up.pid(), "voxtouch_rendering")) != 0; }));
  // Its participant is there when Cyclone's threads are; the scene is built before.
  bool ordinary_while_building = false;
  ASSERT_TRUE(comes([&] {
    const bool alone = threads_of(rendering).size() < 4;
    ordinary_while_building |= alone && sched_getscheduler(rendering) == SCHED_OTHER;
    return !alone && sched_getscheduler(rendering) == SCHED_FIFO;
  }));
  EXPECT_TRUE(ordinary_while_building);
  EXPECT_TRUE(comes([&] { return urgent_threads(up) > 10; }));
}

}  // namespace
}  // namespace voxtouch::test
