#pragma once
/// Records without blocking: reception threads push into a bounded queue, and a separate thread
/// writes to the disk.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "nodes/bag/bag_sink.hpp"

namespace voxtouch::bag {

/// Both bounds of the queue hold: at most `queue_messages` at a time, and `queue_bytes` of payload.
struct RecorderOptions {
  std::size_t queue_bytes = std::size_t{32}
                            << 20;  ///< the ring's five topics need 1 to 2 MB a second
  std::size_t queue_messages = 65536;
  std::size_t max_topics = 1024;
  /// push waits for space instead of dropping, so nothing is lost
  bool lockstep = false;
  /// how long the disk thread sleeps when there is nothing to write
  std::chrono::milliseconds poll_period{5};
  std::chrono::milliseconds report_period{500};
};

enum class PushResult : std::uint8_t {
  kQueued,
  kDropped,       ///< no room and not lockstep; counted
  kTooLarge,      ///< larger than the whole queue; counted as dropped
  kUnknownTopic,  ///< never added; not counted
  kStopped,       ///< after stop(); counted as dropped
};

class BagRecorder {
 public:
  /// Starts the disk thread, which owns `sink` from now on.
  BagRecorder(std::unique_ptr<BagSink> sink, const RecorderOptions& options = {});
  BagRecorder(const BagRecorder&) = delete;
  BagRecorder& operator=(const BagRecorder&) = delete;
  ~BagRecorder();  ///< stop()

  /// Announces a topic; the disk thread adds it to the bag. Never waits for the disk. Error: more
  /// than max_topics.
  Result<TopicId> add_topic(const TopicInfo& topic);

  /// Any thread of ordinary priority: copies the message, which allocates. In real time it never
  /// waits for the disk; in lockstep it blocks until there is room. time_ns becomes the bag's time:
  /// reception time, or simulated time in lockstep.
  PushResult push(TopicId topic, std::int64_t time_ns, std::span<const std::byte> bytes) noexcept;

  /// Counts up to now. Does not wait for the disk. With `closed` set they add up.
  RecordingReport report() const;

  /// Changes between two calls while the disk thread makes progress.
  std::uint64_t disk_steps() const noexcept { return disk_steps_.load(std::memory_order_relaxed); }

  /// Writes the queue, closes the bag, ends the thread. Waits for the disk. The report is final.
  /// Called by the thread that created the recorder.
  RecordingReport stop();

 private:
  struct Counts {
    std::atomic<std::uint64_t> received{0}, dropped{0};
  };
  struct Message {
    TopicId topic;
    std::int64_t time_ns;
    std::vector<std::byte> bytes;
  };
  PushResult enqueue(TopicId topic, std::int64_t time_ns, std::span<const std::byte> bytes);
  bool is_stopping();
  const Message* front();
  void pop();
  void run();
  std::size_t drain();
  void add_new_topics();
  void place_refused_topics();  // a disk that was full may have room again
  std::optional<TopicId> place(const TopicInfo& topic);
  void maintenance(bool closing);
  void note(const BagError& error);

  const RecorderOptions options_;
  std::unique_ptr<BagSink> sink_;  // the disk thread's alone
  std::vector<Counts> counts_;     // by topic, sized once
  std::atomic<std::uint32_t> topic_count_{0};
  std::atomic<std::uint64_t> disk_steps_{0};  // of the disk thread

  std::mutex queue_mutex_;  // not held during disk access
  std::condition_variable room_;
  std::deque<Message>
      queue_;  // only the disk thread pops; a message stays at the front while it is written
  std::size_t queued_bytes_ = 0;
  bool accepting_ = true;

  mutable std::mutex table_mutex_;  // names, disk counts, errors; not held during disk access
  std::vector<TopicInfo> topics_;
  std::vector<TopicReport> disk_counts_;
  std::vector<std::string> errors_;
  bool closed_ = false;

  // Used only by the disk thread.
  std::vector<std::optional<TopicId>> sink_topics_;
  std::vector<std::uint64_t> unassigned_;  // messages of topics that the sink refused
  std::chrono::steady_clock::time_point last_report_, last_tick_;
  std::thread thread_;
};

}  // namespace voxtouch::bag
