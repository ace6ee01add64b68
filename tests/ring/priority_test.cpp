// Scheduling priority: a ring in real time has it while samples are to be answered, and no other
// thread has it.
#include <gtest/gtest.h>

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "nodes/runtime/realtime.hpp"
#include "tests/ring/ring_run.hpp"

namespace {

std::atomic<int> policy_at_lock = -1;

}  // namespace

/// Replaces the C library's, to observe the priority during the call.
extern "C" int mlockall(int) noexcept {
  policy_at_lock = sched_getscheduler(0);
  return 0;
}

namespace voxtouch::test {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<pid_t> threads_of(pid_t process) {
  std::vector<pid_t> threads;
  std::error_code gone;
  for (const auto& task :
       std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task", gone))
    threads.push_back(std::stoi(task.path().filename()));
  return threads;
}

/// Of all nodes of a ring that has begun.
int urgent_threads(const Process& up) {
  int urgent = 0;
  for (const pid_t node : children_of(up.pid()))
    for (const pid_t thread : threads_of(node))
      urgent += sched_getscheduler(thread) == SCHED_FIFO;
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
  std::vector<std::string> words{VOXTOUCH_BIN "/voxtouch",
                                 "up",
                                 shipped_scene("cup"),
                                 "--motion",
                                 "slide",
                                 "--no-record",
                                 "--domain",
                                 fresh_domain()};
  words.insert(words.end(), more.begin(), more.end());
  return Process(words);
}

bool comes(const std::function<bool()>& holds) {
  for (const auto until = Clock::now() + std::chrono::seconds(20); !holds();
       std::this_thread::sleep_for(std::chrono::milliseconds(5)))
    if (Clock::now() > until)
      return false;
  return true;
}

/// It never rests: as urgent as a ring in real time, it would keep one on the same machine from
/// running.
TEST(Priority, OfARingInLockstepIsOrdinary) {
  if (!granted())
    GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  const Process up = start({"--lockstep", "--duration", "600"});
  ASSERT_TRUE(comes([&] { return children_of(up.pid()).size() == 4; }));
  for (int n = 0; n < 300; ++n) {
    ASSERT_EQ(urgent_threads(up), 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST(Priority, IsRealTimeOnlyWhileTheRingRuns) {
  if (!granted())
    GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  const Process up = start({"--duration", "600"});
  pid_t rendering = 0;
  ASSERT_TRUE(
      comes([&] { return (rendering = child_called(up.pid(), "voxtouch_rendering")) != 0; }));
  // Its participant is there when Cyclone's threads are; the scene is built before.
  bool ordinary_while_building = false;
  ASSERT_TRUE(comes([&] {
    const bool alone = threads_of(rendering).size() < 4;
    ordinary_while_building |= alone && sched_getscheduler(rendering) == SCHED_OTHER;
    return !alone && sched_getscheduler(rendering) == SCHED_FIFO;
  })) << up.err();
  EXPECT_TRUE(ordinary_while_building);
  EXPECT_TRUE(comes([&] { return urgent_threads(up) > 10; }));
}

/// All memory is mapped at once, including the stacks of DDS's threads: at the loop's priority this
/// would stall every ring of the machine.
TEST(Priority, IsSetAfterMemoryIsLocked) {
  if (!granted())
    GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  int policy = -1;
  std::size_t stack_bytes = 0;
  std::thread([&] {
    EXPECT_TRUE(runtime::enter_realtime({}).empty());
    policy = sched_getscheduler(0);
    pthread_attr_t next;
    pthread_getattr_default_np(&next);
    pthread_attr_getstacksize(&next, &stack_bytes);
    pthread_attr_destroy(&next);
  }).join();
  EXPECT_EQ(policy_at_lock, SCHED_OTHER);
  EXPECT_EQ(policy, SCHED_FIFO);
  EXPECT_LE(stack_bytes, 1U << 20);
}

/// Empty if the thread has ended.
cpu_set_t cpus_of(pid_t thread) {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  sched_getaffinity(thread, sizeof cpus, &cpus);
  return cpus;
}

/// Device, rendering and coupling of one process run in turn, so they use one processor; threads
/// that they started earlier stay free. An ordinary thread would wait there behind others.
TEST(Priority, OfALoopKeepsItOnItsCpuIfGranted) {
  if (!granted())
    GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  if (cpu_set_t all = cpus_of(0); CPU_COUNT(&all) < 2)
    GTEST_SKIP() << "there is one CPU";
  const runtime::RealtimeOptions asked{.loop_cpu = sched_getcpu()};
  int urgent = 0, ordinary = 0;
  std::thread([&] {
    runtime::enter_loop(asked);
    cpu_set_t cpus = cpus_of(0);
    ordinary = CPU_COUNT(&cpus);
    EXPECT_TRUE(runtime::enter_realtime(asked).empty());
    runtime::enter_loop(asked);
    cpus = cpus_of(0);
    urgent = CPU_COUNT(&cpus);
    EXPECT_TRUE(CPU_ISSET(*asked.loop_cpu, &cpus));
  }).join();
  EXPECT_EQ(urgent, 1);
  EXPECT_GT(ordinary, 1);
}

TEST(Priority, OfARingInOneProcessIsOnOneCpu) {
  if (!granted())
    GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  if (cpu_set_t all = cpus_of(0); CPU_COUNT(&all) < 2)
    GTEST_SKIP() << "there is one CPU";
  const Process up = start({"--one-process", "--duration", "600"});
  cpu_set_t first;
  const auto loops = [&] {  // of the same CPU
    int alike = 0;
    for (const pid_t thread : threads_of(up.pid())) {
      cpu_set_t cpus = cpus_of(thread);
      if (CPU_COUNT(&cpus) != 1)
        continue;
      if (alike == 0)
        first = cpus;
      alike += CPU_EQUAL(&first, &cpus) ? 1 : 0;
    }
    return alike;
  };
  EXPECT_TRUE(comes([&] { return loops() == 3; })) << loops();
}

/// As in the kernel, including inherited priority: -1 - n for priority n of SCHED_FIFO, 20 and its
/// nice value for an ordinary thread.
int effective_priority(pid_t thread) {
  std::ifstream in("/proc/self/task/" + std::to_string(thread) + "/stat");
  std::string text((std::istreambuf_iterator<char>(in)), {});
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string field;
  for (int n = 0; n < 16; ++n)
    fields >> field;
  return std::stoi(field);
}

/// A loop that waits for a lock of Cyclone waits for the holder, and that thread for every other
/// program of the machine.
TEST(Priority, IsInheritedByTheLockHolder) {
  if (!granted())
    GTEST_SKIP() << "SCHED_FIFO is not allowed here";
  runtime::flush_denormals();  // of the object that brings the locks
  pthread_mutex_t mutex;
  ASSERT_EQ(pthread_mutex_init(&mutex, nullptr), 0);
  std::atomic<pid_t> holder = 0;
  std::atomic<bool> release = false;
  std::thread holds([&] {
    pthread_mutex_lock(&mutex);
    holder = gettid();
    while (!release)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    pthread_mutex_unlock(&mutex);
  });
  ASSERT_TRUE(comes([&] { return holder != 0; }));
  EXPECT_EQ(effective_priority(holder), 20 + getpriority(PRIO_PROCESS, 0));
  std::thread waits([&] {
    const sched_param urgent{.sched_priority = 3};
    sched_setscheduler(0, SCHED_FIFO, &urgent);
    pthread_mutex_lock(&mutex);
    pthread_mutex_unlock(&mutex);
  });
  EXPECT_TRUE(comes([&] { return effective_priority(holder) == -4; }))
      << effective_priority(holder);
  release = true;
  waits.join();
  holds.join();
  pthread_mutex_destroy(&mutex);
}

/// The linker's word for it that Cyclone's mutexes are made by the node.
TEST(Priority, IsInheritedThroughDdsLocksInEachNode) {
  for (const char* node :
       {"voxtouch_device", "voxtouch_rendering", "voxtouch_coupling", "voxtouch"}) {
    Process node_says({"/usr/bin/env", "LD_DEBUG=bindings", "LD_BIND_NOW=1",
                       std::string(VOXTOUCH_BIN "/") + node, "--version"});
    const Finished run = node_says.wait();
    std::istringstream lines(run.err);
    std::string line;
    bool bound = false;
    while (std::getline(lines, line))
      bound |= line.find("`pthread_mutex_init'") != line.npos &&
               line.find("libddsc") != line.npos &&
               line.find(std::string("/") + node + " [") != line.npos;
    EXPECT_TRUE(bound) << node;
  }
}

}  // namespace
}  // namespace voxtouch::test
