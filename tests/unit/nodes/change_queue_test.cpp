// Changes requested from the loop: in order, at their sample, or not at all.
#include "nodes/rendering/change_queue.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "core/scene/scene_file.hpp"

namespace voxtouch::rendering_node {
namespace {

using What = ChangeReport::What;

TEST(SpscQueue, GivesAnotherThreadEverythingOnceAndInOrder) {
  runtime::SpscQueue<int, 8> queue;
  constexpr int kCount = 100'000;
  std::thread pusher([&] {
    for (int i = 0; i < kCount;)
      if (queue.push(i))
        ++i;
      else
        std::this_thread::yield();
  });
  for (int i = 0; i < kCount;) {
    if (const int* front = queue.front()) {
      ASSERT_EQ(*front, i++);
      queue.pop();
    } else {
      std::this_thread::yield();
    }
  }
  pusher.join();
}

TEST(SpscQueue, RefusesItemsWhenFull) {
  runtime::SpscQueue<int, 2> queue;
  EXPECT_EQ(queue.room(), 2U);
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.push(2));
  EXPECT_FALSE(queue.push(3));
  EXPECT_EQ(queue.room(), 0U);
  queue.pop();
  EXPECT_EQ(*queue.front(), 2);
}

class ChangeQueueTest : public testing::Test {
 protected:
  ChangeQueueTest() {
    scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
    const effects::EffectKind* kind = effects::find_effect_kind("viscosity");
    scene.effects = {effects::EffectSpec{.name = "viscosity",
                                         .kind = kind,
                                         .values = effects::EffectValues(kind->parameters),
                                         .region = {}}};
    scene.effects[0].values.at(0)[0] = 1.0;
    built_ = rendering::build_scene(scene, serial_for());
    next_ = rendering::build_scene(scene, serial_for());
    live_.emplace(*built_);
  }
  void ask(std::uint64_t ticket, std::uint64_t from_sample = 0, double gain = 0.5,
           std::uint64_t session = 0) {
    Change change{.ticket = ticket,
                  .session = session,
                  .from_sample = from_sample,
                  .epoch = epoch_,
                  .effect = {}};
    change.effect = {.action = effects::EffectAction::kGain, .value = {gain, 0.0, 0.0}};
    ASSERT_TRUE(line_.push(change));
  }
  std::vector<ChangeReport> reports() {
    std::vector<ChangeReport> all;
    ChangeReport report;
    while (line_.next_report(report))
      all.push_back(report), epoch_ = report.epoch;
    return all;
  }
  double gain() { return live_->effects().spec(0).gain; }

  std::unique_ptr<rendering::BuiltScene> built_, next_;
  std::optional<rendering::LiveScene> live_;
  ChangeQueue line_;
  std::uint64_t epoch_ = 0;
};

TEST_F(ChangeQueueTest, AppliesAnImmediateChangeAtTheNextSample) {
  ask(1);
  line_.apply_due(*live_, 7, true);
  EXPECT_EQ(gain(), 0.5);
  const auto said = reports();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].what, What::kApplied);
  EXPECT_EQ(said[0].ticket, 1U);
  EXPECT_EQ(said[0].sample, 7U);
  EXPECT_EQ(line_.applied(), 1U);
}

TEST_F(ChangeQueueTest, WaitsForTheNamedSampleAndKeepsTheOrder) {
  ask(1, 9, 0.25), ask(2, 0, 0.75);
  for (std::uint64_t sample = 5; sample < 9; ++sample)
    line_.apply_due(*live_, sample, true);
  EXPECT_EQ(gain(), 1.0);
  line_.apply_due(*live_, 9, false);
  EXPECT_EQ(gain(), 1.0) << "sample 9 is not there yet";
  line_.apply_due(*live_, 9, true);
  EXPECT_EQ(gain(), 0.75) << "the second was asked for later";
  EXPECT_EQ(reports().size(), 2U);
}

TEST_F(ChangeQueueTest, RefusesAPastSampleAndDependentChanges) {
  ask(1, 3, 0.25), ask(2, 20, 0.75);
  line_.apply_due(*live_, 4, true);
  EXPECT_EQ(gain(), 1.0);
  auto said = reports();
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[0].what, What::kLate);
  EXPECT_EQ(said[1].what, What::kDropped);
  ask(3, 0, 0.5);
  line_.apply_due(*live_, 5, true);
  EXPECT_EQ(gain(), 0.5) << "judged anew, it runs";
}

TEST_F(ChangeQueueTest, MakesRelatedChangesInOneSampleOrNotAtAll) {
  const auto pair = [&](std::uint64_t ticket, std::uint64_t from_sample, double gain) {
    std::array<Change, 2> both{
        Change{.ticket = ticket,
               .from_sample = from_sample,
               .epoch = epoch_,
               .following = 1,
               .effect = {}},
        Change{.ticket = ticket + 1, .from_sample = from_sample, .epoch = epoch_, .effect = {}}};
    both[0].effect = {.action = effects::EffectAction::kGain, .value = {gain, 0.0, 0.0}};
    both[1].effect = {.action = effects::EffectAction::kSwitch, .value = {0.0, 0.0, 0.0}};
    return line_.push(both);
  };
  ASSERT_TRUE(pair(1, 3, 0.25));
  line_.apply_due(*live_, 4, true);
  for (const ChangeReport& late : reports())
    EXPECT_EQ(late.what, What::kLate);
  ASSERT_TRUE(pair(3, 0, 0.25));
  line_.cancel(3);
  line_.apply_due(*live_, 5, true);
  EXPECT_EQ(reports().size(), 2U);
  EXPECT_EQ(gain(), 1.0);
  EXPECT_TRUE(live_->effects().spec(0).on)
      << "what stands behind a change that is dropped is dropped with it";

  // The reports are not read: all but two places are full, and each of the pair needs one, with one
  // to spare.
  std::uint64_t ticket = 5, sample = 10;
  for (std::size_t n = 0; n < 4 * ChangeQueue::kCapacity - 2; ++n, ++ticket)
    ask(ticket, 0, 0.5), line_.apply_due(*live_, sample++, true);
  ASSERT_TRUE(pair(ticket, 0, 0.125));
  line_.apply_due(*live_, sample++, true);
  EXPECT_EQ(gain(), 0.5) << "half a pair was made";
  (void)reports();
  line_.apply_due(*live_, sample, true);
  EXPECT_EQ(gain(), 0.125);
  EXPECT_FALSE(live_->effects().spec(0).on);
  for (const ChangeReport& made : reports())
    EXPECT_TRUE(made.what == What::kApplied && made.sample == sample);
  for (std::size_t n = 0; n + 1 < ChangeQueue::kCapacity; ++n)
    ask(ticket + 2 + n);
  EXPECT_FALSE(pair(ticket + 100, 0, 0.0)) << "the queue has room for one";
}

TEST_F(ChangeQueueTest, NewSessionDropsPendingChanges) {
  ask(1, 9, 0.25);
  line_.begin_session(77);
  line_.apply_due(*live_, 0, true);
  EXPECT_TRUE(reports().empty()) << "asked for before any session, it waits for the first";
  line_.begin_session(78);
  for (std::uint64_t sample = 0; sample < 20; ++sample)
    line_.apply_due(*live_, sample, true);
  EXPECT_EQ(gain(), 1.0);
  const auto said = reports();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].what, What::kDropped);
}

TEST_F(ChangeQueueTest, NeverAppliesAChangeOfAnotherSession) {
  line_.begin_session(77);
  line_.approve(77);
  ask(1, 0, 0.25, 76);
  line_.apply_due(*live_, 1, true);
  EXPECT_EQ(gain(), 1.0);
  EXPECT_EQ(reports().at(0).what, What::kDropped);
  ask(2, 0, 0.25, 77);
  line_.apply_due(*live_, 2, true);
  EXPECT_EQ(gain(), 0.25);
}

TEST_F(ChangeQueueTest, AppliesNothingUntilTheDeviceIsChecked) {
  ask(1, 0, 0.25);
  line_.begin_session(77);
  line_.apply_due(*live_, 1, true);
  EXPECT_EQ(gain(), 1.0);
  line_.approve(77);
  line_.apply_due(*live_, 2, true);
  EXPECT_EQ(gain(), 0.25);
  ask(2, 0, 0.5), ask(3, 0, 0.75);
  line_.cancel(2);
  line_.apply_due(*live_, 3, true);
  EXPECT_EQ(gain(), 0.25);
  const auto said = reports();
  ASSERT_EQ(said.size(), 3U);
  EXPECT_EQ(said[1].what, What::kDropped);
  EXPECT_EQ(said[2].what, What::kDropped) << "it was judged as if the one before had been made";
}

TEST_F(ChangeQueueTest, ReportsWhenAllValuesHaveArrived) {
  Change change{.ticket = 1,
                .effect = {.action = effects::EffectAction::kValue, .value = {0.5, 0.0, 0.0}}};
  ASSERT_TRUE(line_.push(change));
  rendering::ToolState tool;
  tool.pose.position = Vec3(0, 0, 0.05);
  std::uint64_t came = 0;
  for (std::uint64_t sample = 1; sample < 150; ++sample) {
    line_.apply_due(*live_, sample, true);
    for (const ChangeReport& report : reports())
      if (report.what == What::kAtRest)
        came = sample;
    live_->render(tool, 0.001 * static_cast<double>(sample));
  }
  EXPECT_NEAR(static_cast<double>(came), 101.0, 2.0);
}

TEST_F(ChangeQueueTest, ReturnsTheOldSceneAfterItsFade) {
  Change swap{.ticket = 1, .effect = {}, .scene = next_.get()};
  ASSERT_TRUE(line_.push(swap));
  line_.apply_due(*live_, 1, true);
  EXPECT_TRUE(live_->fading());
  ASSERT_EQ(reports().size(), 1U);
  rendering::ToolState tool;
  tool.pose.position = Vec3(0, 0, 0.05);
  for (int i = 0; i < 199; ++i) {
    line_.apply_due(*live_, 2, true);
    live_->render(tool, 0.001 * i);
    ASSERT_TRUE(reports().empty()) << i;
  }
  for (int i = 199; i < 202; ++i)
    live_->render(tool, 0.001 * i), line_.apply_due(*live_, 2, true);
  const auto said = reports();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].what, What::kRetired);
  EXPECT_EQ(said[0].scene, built_.get());
}

TEST_F(ChangeQueueTest, AcceptsNoMoreThanItCanReport) {
  for (std::uint64_t ticket = 1; ticket <= 1000; ++ticket) {
    Change change{.ticket = ticket,
                  .effect = {.action = effects::EffectAction::kGain, .value = {0.5, 0.0, 0.0}}};
    if (!line_.push(change)) {
      line_.apply_due(*live_, ticket, true);
      if (!line_.push(change))
        break;
    }
  }
  std::uint64_t expected = 1;
  ChangeReport report;
  const auto drain = [&] {
    while (line_.next_report(report))
      ASSERT_EQ(report.ticket, expected++) << "one was forgotten";
  };
  drain(), line_.apply_due(*live_, 5, true), drain();
  EXPECT_EQ(expected - 1, line_.applied());
}

TEST_F(ChangeQueueTest, HoldsTheLoopUntilTheSceneIsBuilt) {
  line_.pause_before(100);
  EXPECT_FALSE(line_.announce_sample(99));
  EXPECT_TRUE(line_.announce_sample(100));
  EXPECT_EQ(line_.answering(), 100U);
  line_.resume();
  EXPECT_FALSE(line_.announce_sample(100));
}

}  // namespace
}  // namespace voxtouch::rendering_node
