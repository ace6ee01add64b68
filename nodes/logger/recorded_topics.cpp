#include "nodes/logger/recorded_topics.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "nodes/bag/names.hpp"

namespace voxtouch::logger {
namespace {

/// The ring's messages begin with session, sequence, sample time: eight bytes each after the 4-byte encapsulation.
constexpr std::size_t kSessionOffset = 4, kSampleTimeOffset = 4 + 16;
constexpr std::int32_t kDepth = 4096;

template <class T>
T value_or_throw(bus::OpaqueResult<T> result) {
  if (!result) throw bus::Error(result.error().sentence);
  return std::move(*result);
}

/// A profile of the table as the value that opaque endpoints take.
bus::EndpointQos offered_by(const qos::Profile& p, double rate_hz) {
  bus::EndpointQos q;
  q.reliability = p.reliable ? bus::Reliability::kReliable : bus::Reliability::kBestEffort;
  q.durability = p.transient_local ? bus::Durability::kTransientLocal : bus::Durability::kVolatile;
  q.history = p.keep_all ? bus::History::kKeepAll : bus::History::kKeepLast;
  q.depth = p.id == qos::ProfileId::kStatus ? 1 : p.depth;
  if (p.deadline_periods > 0 && rate_hz > 0) q.deadline_ns = std::llround(p.deadline_periods / rate_hz * 1e9);
  return q;
}

bus::EndpointQos recording(const qos::Profile& p, const bus::EndpointQos& offered) {
  bus::EndpointQos q = bus::recorder_qos(offered, kDepth);
  if (p.id != qos::ProfileId::kLockstep) return q;
  q.history = bus::History::kKeepAll;  // nothing may be lost: a full reader holds the writer up
  q.max_samples = p.depth;
  return q;
}

}  // namespace

RecordedTopics::RecordedTopics(const bus::Participant& participant, const runtime::NodeOptions& options,
                               std::vector<std::string> wanted, bag::BagRecorder& recorder, bus::WaitSet& wait_set)
    : participant_(participant), options_(options), wanted_(std::move(wanted)), recorder_(recorder),
      wait_set_(wait_set), discovery_(value_or_throw(bus::WriterDiscovery::create(participant.get()))) {
  for (const qos::Topic& row : qos::kTopics) {
    if (!(row.readers & qos::kLogger)) continue;
    const qos::Profile& profile = qos::profile_in(row, options.mode());
    const bus::EndpointQos offered = offered_by(profile, row.rate_hz);
    const bool from_outside = row.path == qos::kEffectChange.path;  // whoever asks knows no sample's time
    const bool flows = !from_outside && (row.profile == qos::ProfileId::kStream || row.profile == qos::ProfileId::kEvent);
    const std::lock_guard lock(numbers_mutex_);
    add(qos::dds_name(row, options.rig), bag::dds_type_name(row.type), recording(profile, offered), offered,
        flows                                    ? Stamp::kSampleTime
        : from_outside || row.profile == qos::ProfileId::kStatus ? Stamp::kNewest
                                                 : Stamp::kZero);
    if (row.profile == qos::ProfileId::kStream) {
      entries_.back().stream = qos::figure_name(row);
    }
  }
}

void RecordedTopics::add(const std::string& name, const std::string& type, const bus::EndpointQos& qos,
                         const bus::EndpointQos& offered, Stamp stamp) {
  auto topic = value_or_throw(bus::OpaqueTopic::create(participant_.get(), name, type));
  auto reader = value_or_throw(bus::OpaqueReader::create(topic, qos));
  bus::Entity unread(dds_create_readcondition(reader.handle(), DDS_ANY_STATE), "a read condition could not be made");
  const auto id = recorder_.add_topic({.name = bag::ros_topic_name(name),
                                       .type = bag::ros_type_name(type),
                                       .offered_qos = bag::offered_qos_text({&offered, 1})});
  if (!id) throw bus::Error(id.error().sentence);
  wait_set_.attach(unread.get());
  entries_.push_back({name, std::move(topic), std::move(reader), std::move(unread), *id, stamp});
  known_.insert(name);
}

bool RecordedTopics::wants(const std::string& topic) const {
  return std::any_of(wanted_.begin(), wanted_.end(), [&](const std::string& w) {
    return w.ends_with('*') ? topic.starts_with(w.substr(0, w.size() - 1)) : topic == w;
  });
}

std::vector<std::string> RecordedTopics::discover() {
  std::vector<std::string> sentences;
  const auto seen = discovery_.take([&](const bus::DiscoveredWriter& writer) {
    if (!writer.alive || !writer.topic.starts_with("rt/") || known_.contains(writer.topic) || !wants(writer.topic))
      return;
    known_.insert(writer.topic);
    if (writer.keyed) {
      sentences.push_back(
          fmt::format("topic {} has a key and cannot be recorded; ROS 2 topics have none", writer.topic));
      return;
    }
    try {
      const std::lock_guard lock(numbers_mutex_);
      add(writer.topic, writer.type_name, bus::recorder_qos(writer.qos, kDepth), writer.qos, Stamp::kNewest);
    } catch (const bus::Error& error) {
      sentences.push_back(fmt::format("topic {} is not recorded: {}", writer.topic, error.what()));
    }
  });
  if (!seen) sentences.push_back(seen.error().sentence);
  return sentences;
}

std::int64_t RecordedTopics::time_of(const Entry& entry, const bus::RawSample& sample) {
  if (!options_.lockstep) return sample.reception_time_ns;
  if (entry.stamp == Stamp::kSampleTime && sample.bytes.size() >= kSampleTimeOffset + 8) {
    std::int64_t time_ns = 0;
    std::memcpy(&time_ns, sample.bytes.data() + kSampleTimeOffset,
                sizeof time_ns);  // our own writers: this machine's order
    newest_ns_ = std::max(newest_ns_, time_ns);
    return time_ns;
  }
  return entry.stamp == Stamp::kZero ? 0 : newest_ns_;
}

std::size_t RecordedTopics::drain() {
  std::size_t count = 0;
  for (Entry& entry : entries_) {
    const auto taken = entry.reader.take([&](const bus::RawSample& sample) {
      if (!sample.valid) return;
      const auto pushed = recorder_.push(entry.id, time_of(entry, sample), sample.bytes);
      if (pushed == bag::PushResult::kQueued && !entry.stream.empty()) note(entry, sample.bytes);
      ++count;
    });
    (void)taken;  // an error here is an empty reader; the next turn asks again
  }
  return count;
}

void RecordedTopics::note(Entry& entry, std::span<const std::byte> bytes) {
  std::uint64_t session = 0, sequence = 0;
  if (bytes.size() < kSampleTimeOffset) return;
  std::memcpy(&session, bytes.data() + kSessionOffset, sizeof session);
  std::memcpy(&sequence, bytes.data() + kSessionOffset + sizeof session, sizeof sequence);
  const std::lock_guard lock(numbers_mutex_);
  entry.numbers.add(session, sequence);
}

void RecordedTopics::tell(std::uint64_t session, runtime::Figures& figures) const {
  const std::lock_guard lock(numbers_mutex_);
  for (const Entry& entry : entries_) {
    if (entry.stream.empty()) continue;
    const SequenceCount::Count count = entry.numbers.of(session);
    figures[entry.stream + "_recorded"] = {count.samples, "samples"};
    figures[entry.stream + "_gaps"] = {count.gaps(), "samples"};
    if (count.samples > 0) figures[entry.stream + "_first"] = {count.first, "sample number"};
  }
}

std::vector<runtime::Link> RecordedTopics::links() const {
  std::vector<runtime::Link> links;
  for (const qos::Topic& row : qos::kTopics)
    for (const Entry& entry : entries_)
      if (row.writers != qos::kEveryNode && entry.name == qos::dds_name(row, options_.rig))
        links.push_back({std::string(row.path), [handle = entry.reader.handle()] { return bus::matched_writers(handle); },
                         qos::names_of(row.writers)});
  return links;
}

}  // namespace voxtouch::logger
