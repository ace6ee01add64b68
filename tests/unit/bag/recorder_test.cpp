#include "nodes/bag/bag_recorder.hpp"

#include <condition_variable>
#include <fstream>
#include <nlohmann/json.hpp>

#include "nodes/bag/bag_writer.hpp"
#include "tests/support/whole_bag.hpp"
#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag {
namespace {

using namespace test;
using namespace std::chrono_literals;

const TopicInfo kTopic{"/t", "p/msg/T", "cdr", "", 0};

/// A disk that blocks while its gate is shut, and refuses on request. Its state outlives the
/// recorder.
struct DiskState {
  std::mutex mutex;
  std::condition_variable changed;
  bool shut = false;
  bool waiting = false;  // the disk thread waits at the gate
  bool refuse_topics = false, refuse_messages = false;
  std::vector<std::pair<std::int64_t, std::vector<std::byte>>> written;
  std::uint64_t lost = 0;
  int closes = 0;
  RecordingReport last_report;

  void set_shut(bool value) {
    const std::scoped_lock lock(mutex);
    shut = value;
    changed.notify_all();
  }
  void wait_until_stalled() {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return waiting; });
  }
  bool stalled() {
    const std::scoped_lock lock(mutex);
    return waiting;
  }
};

class FakeDisk final : public BagSink {
 public:
  explicit FakeDisk(std::shared_ptr<DiskState> state) : state_(std::move(state)) {}
  Result<TopicId> add_topic(const TopicInfo&) override {
    const std::scoped_lock lock(state_->mutex);
    if (state_->refuse_topics)
      return std::unexpected(BagError{"no topics today"});
    return topics_++;
  }
  Result<void> append(TopicId, std::int64_t time_ns, std::span<const std::byte> bytes) override {
    std::unique_lock lock(state_->mutex);
    state_->waiting = state_->shut;
    state_->changed.notify_all();
    state_->changed.wait(lock, [&] { return !state_->shut; });
    state_->waiting = false;
    if (state_->refuse_messages) {
      ++state_->lost;
      return std::unexpected(BagError{"the disk is full"});
    }
    state_->written.emplace_back(time_ns, std::vector(bytes.begin(), bytes.end()));
    return {};
  }
  Result<void> tick() override { return {}; }
  void fill_counts(std::vector<TopicReport>& topics) const override {
    const std::scoped_lock lock(state_->mutex);
    if (topics.empty())
      return;
    topics[0].written = state_->written.size();
    topics[0].lost = state_->lost;
  }
  Result<void> report(const RecordingReport& report) override {
    const std::scoped_lock lock(state_->mutex);
    state_->last_report = report;
    return {};
  }
  Result<void> close() override {
    const std::scoped_lock lock(state_->mutex);
    ++state_->closes;
    return {};
  }

 private:
  std::shared_ptr<DiskState> state_;
  TopicId topics_ = 0;
};

TEST(BagRecorder, PushNeverBlocksAndDropsAreCounted) {
  auto disk = std::make_shared<DiskState>();
  disk->shut = true;
  BagRecorder recorder(std::make_unique<FakeDisk>(disk),
                       {.queue_bytes = 1 << 20, .queue_messages = 100});
  const TopicId topic = expect_value(recorder.add_topic(kTopic));
  ASSERT_EQ(recorder.push(topic, 0, ring_message(1, 0)), PushResult::kQueued);
  disk->wait_until_stalled();  // with message 0 in its hands, which still takes its place in the
                               // queue
  std::uint64_t queued = 1, dropped = 0;
  for (std::uint64_t i = 1; i < 5000; ++i) {
    const auto pushed = recorder.push(topic, static_cast<std::int64_t>(i), ring_message(1, i));
    queued += pushed == PushResult::kQueued;
    dropped += pushed == PushResult::kDropped;
  }
  EXPECT_TRUE(disk->stalled());  // all 5000 calls returned before the disk continued
  EXPECT_EQ(queued, 100u);
  EXPECT_EQ(dropped, 4900u);
  EXPECT_EQ(recorder.report().topics[0].dropped,
            4900u);  // queries do not wait for the disk either
  ASSERT_TRUE(recorder.add_topic({"/later", "p/msg/T", "cdr", "", 0}));
  EXPECT_TRUE(disk->stalled());
  disk->set_shut(false);
  const RecordingReport report = recorder.stop();
  EXPECT_TRUE(report.closed);
  EXPECT_EQ(report.topics[0].received, 5000u);
  EXPECT_EQ(report.topics[0].written, 100u);
  EXPECT_EQ(report.topics[0].dropped, 4900u);
  ASSERT_EQ(disk->written.size(), 100u);
  for (std::uint64_t i = 0; i < 100; ++i)
    EXPECT_EQ(disk->written[i].second, ring_message(1, i));
}

TEST(BagRecorder, LosesNothingInLockstepForAnyQueue) {
  auto disk = std::make_shared<DiskState>();
  disk->shut = true;
  BagRecorder recorder(std::make_unique<FakeDisk>(disk),
                       {.queue_bytes = 4096, .queue_messages = 4, .lockstep = true});
  const TopicId topic = expect_value(recorder.add_topic(kTopic));
  std::atomic<std::uint64_t> pushed{0};
  std::thread pusher([&] {
    for (std::uint64_t i = 0; i < 2000; ++i) {
      if (recorder.push(topic, static_cast<std::int64_t>(i), ring_message(1, i)) ==
          PushResult::kQueued)
        ++pushed;
    }
  });
  disk->wait_until_stalled();
  std::this_thread::sleep_for(50ms);
  EXPECT_LE(pushed.load(), 4u);  // it waits
  disk->set_shut(false);
  pusher.join();
  const RecordingReport report = recorder.stop();
  EXPECT_EQ(pushed.load(), 2000u);
  EXPECT_EQ(report.topics[0].written, 2000u);
  EXPECT_EQ(report.topics[0].dropped, 0u);
  EXPECT_TRUE(report.lockstep);
  for (std::uint64_t i = 0; i < 2000; ++i)
    ASSERT_EQ(disk->written[i].first, static_cast<std::int64_t>(i));
}

TEST(BagRecorder, RefusesOversizedMessagesInLockstep) {
  auto disk = std::make_shared<DiskState>();
  BagRecorder recorder(std::make_unique<FakeDisk>(disk),
                       {.queue_bytes = 64, .queue_messages = 4, .lockstep = true});
  const TopicId topic = expect_value(recorder.add_topic(kTopic));
  EXPECT_EQ(recorder.push(topic, 0, ring_message(1, 0, 100)), PushResult::kTooLarge);
  EXPECT_EQ(recorder.push(topic + 1, 0, ring_message(1, 0)), PushResult::kUnknownTopic);
  const RecordingReport report = recorder.stop();
  EXPECT_EQ(report.topics[0].received, 1u);
  EXPECT_EQ(report.topics[0].dropped, 1u);
  EXPECT_EQ(recorder.push(topic, 0, ring_message(1, 0)), PushResult::kStopped);
}

TEST(BagRecorder, WritesWhatWasQueuedBeforeItStops) {
  for (int round = 0; round < 20; ++round) {
    auto disk = std::make_shared<DiskState>();
    BagRecorder recorder(std::make_unique<FakeDisk>(disk));
    const TopicId topic = expect_value(recorder.add_topic(kTopic));
    std::uint64_t queued = 0;
    std::thread pusher([&] {
      for (std::uint64_t i = 0; i < 1000; ++i)
        queued += recorder.push(topic, 0, ring_message(1, i)) == PushResult::kQueued;
    });
    const RecordingReport report = recorder.stop();  // during it
    pusher.join();
    EXPECT_EQ(report.topics[0].written, queued);
    EXPECT_EQ(disk->closes, 1);
    EXPECT_TRUE(disk->last_report.closed);
  }
}

TEST(BagRecorder, CountsDiskRefusalsAndReportsThemOnce) {
  auto disk = std::make_shared<DiskState>();
  disk->refuse_messages = true;
  BagRecorder recorder(std::make_unique<FakeDisk>(disk));
  const TopicId topic = expect_value(recorder.add_topic(kTopic));
  for (std::uint64_t i = 0; i < 50; ++i)
    recorder.push(topic, 0, ring_message(1, i));
  const RecordingReport report = recorder.stop();
  EXPECT_EQ(report.topics[0].lost, 50u);
  EXPECT_EQ(report.errors, std::vector<std::string>{"the disk is full"});
}

TEST(BagRecorder, RetriesATopicRefusedByTheDisk) {
  auto disk = std::make_shared<DiskState>();
  disk->refuse_topics = true;
  BagRecorder recorder(std::make_unique<FakeDisk>(disk),
                       {.poll_period = 1ms, .report_period = 5ms});
  const TopicId topic = expect_value(recorder.add_topic(kTopic));
  recorder.push(topic, 0, ring_message(1, 0));
  for (int i = 0; i < 5000 && recorder.report().topics[0].lost == 0; ++i)
    std::this_thread::sleep_for(1ms);
  {
    const std::scoped_lock lock(disk->mutex);
    disk->refuse_topics = false;
  }
  std::uint64_t pushes = 1;
  while (recorder.report().topics[0].written == 0 && pushes < 5000) {
    recorder.push(topic, 0, ring_message(1, pushes++));
    std::this_thread::sleep_for(1ms);
  }
  const RecordingReport report = recorder.stop();
  EXPECT_GT(report.topics[0].written, 0u);
  EXPECT_EQ(report.topics[0].written + report.topics[0].lost, pushes);
  EXPECT_EQ(report.errors, std::vector<std::string>{"no topics today"});
}

TEST(BagRecorder, RefusesTooManyTopics) {
  auto disk = std::make_shared<DiskState>();
  BagRecorder recorder(std::make_unique<FakeDisk>(disk), {.max_topics = 1});
  EXPECT_TRUE(recorder.add_topic(kTopic));
  EXPECT_FALSE(recorder.add_topic(kTopic));
}

TEST(BagRecorder, WritesItsCountsNextToTheBag) {
  const TemporaryFolder folder;
  auto writer = std::make_unique<BagWriter>(expect_value(BagWriter::create(folder / "run")));
  BagRecorder recorder(std::move(writer));
  const TopicId first = expect_value(recorder.add_topic(kTopic));
  const TopicId second = expect_value(recorder.add_topic({"/u", "p/msg/U", "cdr", "", 0}));
  for (std::uint64_t i = 0; i < 300; ++i)
    recorder.push(i % 3 == 0 ? second : first, static_cast<std::int64_t>(i), ring_message(1, i));
  EXPECT_TRUE(recorder.stop().errors.empty());
  std::ifstream file(folder / "run/voxtouch_recording.json");
  const auto json = nlohmann::json::parse(file);
  EXPECT_EQ(json["closed"], true);
  EXPECT_EQ(json["topics"][0]["name"], "/t");
  EXPECT_EQ(json["topics"][0]["written"], 200);
  EXPECT_EQ(json["topics"][1]["received"], 100);
  EXPECT_EQ(json["topics"][1]["dropped"], 0);
  const auto bag = expect_value(WholeBag::open(folder / "run"));
  EXPECT_EQ(bag.message_count(), 300u);
}

}  // namespace
}  // namespace voxtouch::bag
