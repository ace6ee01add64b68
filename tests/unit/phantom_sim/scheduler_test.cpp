// The servo loop: order, ends, rates; in virtual time and with its own thread.
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "library.hpp"

namespace voxtouch::hd_sim_test {
namespace {

using Errors = std::vector<phantom::hd::HDerror>;

/// A callback that notes its calls.
struct Note {
  std::vector<int>* calls = nullptr;
  int name = 0;
  int lasts = 1000000;  // calls until it is done
  static phantom::hd::HDCallbackCode run(void* self) {
    auto* note = static_cast<Note*>(self);
    note->calls->push_back(note->name);
    return --note->lasts > 0 ? phantom::hd::kCallbackContinue : phantom::hd::kCallbackDone;
  }
};

class Scheduler : public SimulatedLibrary {
 protected:
  phantom::hd::HDSchedulerHandle add(Note& note, phantom::hd::HDushort priority) {
    note.calls = &calls;
    return api.hdScheduleAsynchronous(Note::run, &note, priority);
  }
  std::vector<int> calls;
};

TEST_F(Scheduler, CallsInFallingPriorityAndOlderFirst) {
  Note low{nullptr, 1}, high{nullptr, 2}, first{nullptr, 3}, second{nullptr, 4};
  add(low, phantom::hd::kMinPriority);
  add(first, phantom::hd::kDefaultPriority);
  add(high, phantom::hd::kMaxPriority);
  add(second, phantom::hd::kDefaultPriority);
  api.hdStartScheduler();
  sim.step();
  EXPECT_EQ(calls, (std::vector<int>{2, 3, 4, 1}));
  sim.step();
  EXPECT_EQ(calls.size(), 8u);
}

TEST_F(Scheduler, DoneEndsACallback) {
  Note note{nullptr, 1, 2};
  const auto handle = add(note, phantom::hd::kDefaultPriority);
  api.hdStartScheduler();
  sim.step();
  EXPECT_EQ(state().callbacks, 1u);
  sim.step();
  sim.step();
  EXPECT_EQ(calls.size(), 2u);
  EXPECT_EQ(state().callbacks, 0u);
  EXPECT_EQ(errors(), Errors{});
  api.hdUnschedule(handle);
  EXPECT_EQ(errors(), Errors{phantom::hd::kInvalidOperation});
}

TEST_F(Scheduler, UnscheduledIsNotCalledAgain) {
  Note note{nullptr, 1};
  const auto handle = add(note, phantom::hd::kDefaultPriority);
  api.hdStartScheduler();
  sim.step();
  api.hdUnschedule(handle);
  sim.step();
  EXPECT_EQ(calls.size(), 1u);
  api.hdStopScheduler();
  EXPECT_EQ(state().callbacks, 0u);
}

TEST_F(Scheduler, CallbacksOutliveAStopAndCanBeTakenOutThen) {
  Note note{nullptr, 1};
  const auto handle = add(note, phantom::hd::kDefaultPriority);
  api.hdStartScheduler();
  api.hdStopScheduler();
  EXPECT_EQ(state().callbacks, 1u);
  api.hdUnschedule(handle);
  EXPECT_EQ(errors(), Errors{});
}

TEST_F(Scheduler, StoppingFromACallbackIsRefused) {
  open_and_start();
  tick([&] { api.hdStopScheduler(); });
  EXPECT_EQ(errors(), Errors{phantom::hd::kInvalidOperation});
  EXPECT_TRUE(state().scheduler_running);
}

TEST_F(Scheduler, ReportsAFullScheduler) {
  Note note{&calls, 1};
  for (int i = 0; i < 64; ++i)
    EXPECT_NE(add(note, 1), 0u);
  EXPECT_EQ(add(note, 1), 0u);
  EXPECT_EQ(errors(), Errors{phantom::hd::kSchedulerFull});
}

TEST_F(Scheduler, RatesAreThoseOfTheBus) {
  open();
  for (const phantom::hd::HDulong rate : {500ul, 1000ul, 2000ul})
    api.hdSetSchedulerRate(rate);
  EXPECT_EQ(errors(), Errors{});
  for (const phantom::hd::HDulong rate : {0ul, 750ul, 1600ul, 4000ul})
    api.hdSetSchedulerRate(rate);
  EXPECT_EQ(errors(), Errors(4, phantom::hd::kInvalidValue));
  shut();
  sim.set_model("omni");
  device = api.hdInitDevice(nullptr);
  for (const phantom::hd::HDulong rate : {500ul, 1000ul, 1143ul, 1333ul, 1600ul, 2000ul})
    api.hdSetSchedulerRate(rate);
  EXPECT_EQ(errors(), Errors{});
  api.hdSetSchedulerRate(1500);
  EXPECT_EQ(errors(), Errors{phantom::hd::kInvalidValue});
}

TEST_F(Scheduler, TickTakesOnePeriodOfItsRate) {
  for (const phantom::hd::HDulong rate : {500ul, 1000ul, 2000ul}) {
    ASSERT_EQ(sim.power_cycle(), 0);
    open_and_start();
    api.hdSetSchedulerRate(rate);
    for (int i = 0; i < 100; ++i)
      tick();
    EXPECT_DOUBLE_EQ(state().time, 100.0 / double(rate));
    shut();
  }
}

TEST_F(Scheduler, StepNeedsVirtualTimeAndAStart) {
  EXPECT_EQ(sim.step(), -1);
  EXPECT_NE(std::string(sim.last_message()), "");
  ASSERT_EQ(sim.use_virtual_time(0), 0);
  api.hdStartScheduler();
  EXPECT_EQ(sim.step(), -1);
}

// --- with a separate thread

class RealTime : public SimulatedLibrary {
 protected:
  void SetUp() override {
    SimulatedLibrary::SetUp();
    ASSERT_EQ(sim.use_virtual_time(0), 0);
  }
  static void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }
};

struct Counter {
  std::atomic<int> calls{0};
  std::atomic<bool> on_other_thread{false};
  std::thread::id caller = std::this_thread::get_id();
  static phantom::hd::HDCallbackCode run(void* self) {
    auto* c = static_cast<Counter*>(self);
    c->on_other_thread = std::this_thread::get_id() != c->caller;
    ++c->calls;
    return phantom::hd::kCallbackContinue;
  }
};

TEST_F(RealTime, TicksAtItsRateOnAThreadOfItsOwn) {
  Counter counter;
  open();
  api.hdScheduleAsynchronous(Counter::run, &counter, phantom::hd::kMaxPriority);
  api.hdStartScheduler();
  sleep_ms(300);
  api.hdStopScheduler();
  const hdsim_state s = state();
  EXPECT_TRUE(counter.on_other_thread);
  EXPECT_GT(counter.calls, 20);  // a busy machine misses ticks, but time advances
  EXPECT_LT(counter.calls, 600);
  EXPECT_GT(s.time, 0.2);
  EXPECT_GE(s.ticks, static_cast<std::uint64_t>(counter.calls));
  const int calls = counter.calls;
  sleep_ms(20);
  EXPECT_EQ(counter.calls, calls);
}

TEST_F(RealTime, UnscheduleReturnsOnlyWhenTheCallbackIsOver) {
  struct Slow {
    std::atomic<bool> inside{false}, over{false};
    static phantom::hd::HDCallbackCode run(void* self) {
      auto* s = static_cast<Slow*>(self);
      s->inside = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
      s->over = true;
      return phantom::hd::kCallbackContinue;
    }
  } slow;
  const auto handle = api.hdScheduleAsynchronous(Slow::run, &slow, 1);
  api.hdStartScheduler();
  while (!slow.inside)
    sleep_ms(1);
  api.hdUnschedule(handle);
  EXPECT_TRUE(slow.over);
}

TEST_F(RealTime, ArmMovesOnDuringALateTick) {
  open();
  api.hdStartScheduler();
  sleep_ms(20);
  const double before = state().time;
  const auto missed = state().ticks_without_callbacks;
  sim.inject(HDSIM_LATE_TICK, 0.1);
  sleep_ms(160);
  EXPECT_GT(state().time - before, 0.1);
  EXPECT_GE(state().ticks_without_callbacks - missed, 90u);
}

}  // namespace
}  // namespace voxtouch::hd_sim_test
