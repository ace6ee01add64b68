#include "nodes/bag/bag_recorder.hpp"

#include <algorithm>
#include <new>

#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {

namespace {
// each different sentence once; a broken disk must not fill the memory with them
constexpr std::size_t kMaxErrors = 64;
constexpr std::chrono::milliseconds kTickPeriod{20};  // a sink needs ten per second
}  // namespace

BagRecorder::BagRecorder(std::unique_ptr<BagSink> sink, const RecorderOptions& options)
    : options_(options),
      sink_(std::move(sink)),
      counts_(options.max_topics),
      last_report_(std::chrono::steady_clock::now()),
      last_tick_(last_report_) {
  thread_ = std::thread([this] { run(); });
}

BagRecorder::~BagRecorder() { (void)stop(); }

Result<TopicId> BagRecorder::add_topic(const TopicInfo& topic) {
  const std::scoped_lock lock(table_mutex_);
  if (topics_.size() >= counts_.size())
    return refuse("'{}' is topic number {}, limit {}. Raise max_topics.", topic.name,
                  topics_.size() + 1, counts_.size());
  topics_.push_back(topic);
  disk_counts_.push_back({.name = topic.name});
  const auto id = static_cast<TopicId>(topics_.size() - 1);
  topic_count_.store(id + 1, std::memory_order_release);
  return id;
}

PushResult BagRecorder::push(TopicId topic, std::int64_t time_ns,
                             std::span<const std::byte> bytes) noexcept {
  if (topic >= topic_count_.load(std::memory_order_acquire))
    return PushResult::kUnknownTopic;
  Counts& counts = counts_[topic];
  counts.received.fetch_add(1, std::memory_order_relaxed);
  PushResult result = PushResult::kDropped;
  try {
    result = enqueue(topic, time_ns, bytes);
  } catch (const std::bad_alloc&) {  // no memory is no room
  }
  if (result != PushResult::kQueued)
    counts.dropped.fetch_add(1, std::memory_order_relaxed);
  return result;
}

PushResult BagRecorder::enqueue(TopicId topic, std::int64_t time_ns,
                                std::span<const std::byte> bytes) {
  if (bytes.size() > options_.queue_bytes)
    return PushResult::kTooLarge;
  const auto has_room = [&] {
    return queue_.size() < options_.queue_messages &&
           queued_bytes_ + bytes.size() <= options_.queue_bytes;
  };
  std::unique_lock lock(queue_mutex_);
  if (options_.lockstep)
    room_.wait(lock, [&] { return !accepting_ || has_room(); });
  if (!accepting_)
    return PushResult::kStopped;
  if (!has_room())
    return PushResult::kDropped;
  queue_.push_back({topic, time_ns, {bytes.begin(), bytes.end()}});
  queued_bytes_ += bytes.size();
  return PushResult::kQueued;
}

bool BagRecorder::is_stopping() {
  const std::scoped_lock lock(queue_mutex_);
  return !accepting_;
}

const BagRecorder::Message* BagRecorder::front() {
  const std::scoped_lock lock(queue_mutex_);
  return queue_.empty() ? nullptr : &queue_.front();
}

void BagRecorder::pop() {
  {
    const std::scoped_lock lock(queue_mutex_);
    queued_bytes_ -= queue_.front().bytes.size();
    queue_.pop_front();
  }
  room_.notify_all();
}

void BagRecorder::note(const BagError& error) {
  const std::scoped_lock lock(table_mutex_);
  if (errors_.size() < kMaxErrors && std::ranges::find(errors_, error.sentence) == errors_.end())
    errors_.push_back(error.sentence);
}

void BagRecorder::add_new_topics() {
  const std::uint32_t known = topic_count_.load(std::memory_order_acquire);
  while (sink_topics_.size() < known) {
    TopicInfo topic;
    {
      const std::scoped_lock lock(table_mutex_);
      topic = topics_[sink_topics_.size()];
    }
    sink_topics_.push_back(place(topic));
    unassigned_.push_back(0);
  }
}

std::optional<TopicId> BagRecorder::place(const TopicInfo& topic) {
  const auto added = sink_->add_topic(topic);
  if (added)
    return *added;
  note(added.error());
  return std::nullopt;
}

void BagRecorder::place_refused_topics() {
  for (std::size_t i = 0; i < sink_topics_.size(); ++i) {
    if (sink_topics_[i])
      continue;
    std::unique_lock lock(table_mutex_);
    const TopicInfo topic = topics_[i];
    lock.unlock();
    sink_topics_[i] = place(topic);
  }
}

// At most one queue length at a time, so that a flood does not delay commits.
std::size_t BagRecorder::drain() {
  std::size_t written = 0;
  for (; written < options_.queue_messages; ++written) {
    const Message* const message = front();
    if (!message)
      break;
    disk_steps_.fetch_add(1, std::memory_order_relaxed);
    if (message->topic >= sink_topics_.size())
      add_new_topics();
    if (const auto topic = sink_topics_[message->topic]) {
      if (auto appended = sink_->append(*topic, message->time_ns, message->bytes); !appended)
        note(appended.error());
    } else {
      ++unassigned_[message->topic];
    }
    pop();
    if (std::chrono::steady_clock::now() - last_tick_ >= kTickPeriod)
      maintenance(false);
  }
  return written;
}

void BagRecorder::maintenance(bool closing) {
  const auto now = last_tick_ = std::chrono::steady_clock::now();
  auto ticked = closing ? sink_->close() : sink_->tick();
  if (!ticked)
    note(ticked.error());
  // in the sink's order, which leaves refused topics out
  std::vector<TopicReport> in_sink(sink_topics_.size());
  sink_->fill_counts(in_sink);
  {
    const std::scoped_lock lock(table_mutex_);
    for (std::size_t i = 0; i < sink_topics_.size(); ++i) {
      const TopicReport counted = sink_topics_[i] ? in_sink[*sink_topics_[i]] : TopicReport{};
      disk_counts_[i].written = counted.written;
      disk_counts_[i].lost = counted.lost + unassigned_[i];
    }
    closed_ = closed_ || closing;
  }
  if (!closing && now - last_report_ < options_.report_period)
    return;
  last_report_ = now;
  if (!closing)
    place_refused_topics();
  if (auto reported = sink_->report(report()); !reported)
    note(reported.error());
}

void BagRecorder::run() {
  while (true) {
    const bool last = is_stopping();
    disk_steps_.fetch_add(1, std::memory_order_relaxed);
    add_new_topics();
    const std::size_t written = drain();
    if (last && written == 0)
      break;
    maintenance(false);
    if (written == 0)
      std::this_thread::sleep_for(options_.poll_period);
  }
  maintenance(true);
}

RecordingReport BagRecorder::report() const {
  RecordingReport report;
  report.lockstep = options_.lockstep;
  const std::scoped_lock lock(table_mutex_);
  report.closed = closed_;
  report.errors = errors_;
  report.topics = disk_counts_;
  for (std::size_t i = 0; i < report.topics.size(); ++i) {
    // Read `dropped` before `received`, so that a report never has more dropped than received
    // messages.
    report.topics[i].dropped = counts_[i].dropped.load(std::memory_order_acquire);
    report.topics[i].received = counts_[i].received.load(std::memory_order_acquire);
  }
  return report;
}

RecordingReport BagRecorder::stop() {
  {
    const std::scoped_lock lock(queue_mutex_);
    accepting_ = false;
  }
  room_.notify_all();
  if (thread_.joinable())
    thread_.join();
  return report();
}

}  // namespace voxtouch::bag
