#include "nodes/logger/recorded_topics.hpp"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "nodes/logger/recording_qos.hpp"
#include "nodes/runtime/clock.hpp"
#include "voxtouch_msgs/definitions.hpp"

namespace voxtouch::logger {
namespace {

/// Messages of the ring begin with session, sequence number and sample time, eight bytes each,
/// after the 4-byte encapsulation header.
constexpr std::size_t kSessionOffset = 4, kSampleTimeOffset = 4 + 16;
constexpr std::string_view kRosPrefix = "rt";  ///< prefix of every ROS 2 topic on DDS

constexpr const msg::AnyType* type_of(const qos::Topic& row) {
  return std::ranges::find(msg::kAllTypes, row.type, &msg::AnyType::ros_name);
}
static_assert(std::ranges::none_of(qos::kTopics, [](const qos::Topic& row) {
  return type_of(row) == std::end(msg::kAllTypes);
}));

/// Topics that the ring accepts only from the participant in a role. `binds`: a participant must
/// write this topic to hold the role.
struct RoleTopic {
  std::string_view path, role;
  bool followed, binds;
};
constexpr RoleTopic kRoleTopics[] = {{qos::kDeviceState.path, "device", false, false},
                                     {qos::kDeviceDescription.path, "device", false, false},
                                     {qos::kContactState.path, "rendering", false, true},
                                     {qos::kScenePlan.path, "rendering", false, true},
                                     {qos::kEffectMade.path, "rendering", true, true},
                                     {qos::kExternalSample.path, "rendering", true, false},
                                     {qos::kForceCommand.path, "coupling", false, true},
                                     {qos::kCouplingDesign.path, "coupling", false, false}};

}  // namespace

RecordedTopics::RecordedTopics(const bus::Participant& participant,
                               const runtime::NodeOptions& options,
                               std::vector<std::string> requested, bag::BagRecorder& recorder,
                               bus::WaitSet& wait_set)
    : participant_(participant),
      options_(options),
      requested_(std::move(requested)),
      recorder_(recorder),
      wait_set_(wait_set),
      discovery_(participant.get()) {
  using Unknown = RoleRecords::Unknown;
  for (const std::string_view role : {"device", "rendering", "coupling"})
    of_roles_.push_back({role, std::make_unique<RoleRecords>(Unknown::kRecord), false});
  of_roles_.push_back({"rendering", std::make_unique<RoleRecords>(Unknown::kRefuse), true});
  for (const qos::Topic& row : qos::kTopics) {
    if (!(row.readers & qos::kLogger))
      continue;
    const qos::Profile& profile = qos::profile_in(row, options.mode());
    const qos::Qos offered =
        qos::make_qos(profile, qos::Endpoint::kWriter, row.rate_hz > 0 ? 1.0 / row.rate_hz : 0.0);
    // In lockstep no message may be lost: a full reader blocks the writer.
    const qos::Qos requested_qos = profile.id == qos::ProfileId::kLockstep
                                       ? qos::make_qos(profile, qos::Endpoint::kReader, 0.0)
                                       : recording_qos(offered.get());
    const bool from_outside = row.path == qos::kEffectChange.path;  // its sender has no sample time
    const bool flows = !from_outside && (row.profile == qos::ProfileId::kStream ||
                                         row.profile == qos::ProfileId::kEvent);
    const std::lock_guard lock(numbers_mutex_);
    Entry& entry = add(qos::dds_name(row, options.rig), *type_of(row), requested_qos, offered.get(),
                       flows ? Stamp::kSampleTime
                       : from_outside || row.profile == qos::ProfileId::kStatus ||
                               row.profile == qos::ProfileId::kRecord
                           ? Stamp::kNewest
                           : Stamp::kZero);
    if (row.profile == qos::ProfileId::kStream)
      entry.stream = qos::figure_name(row);
    entry.latched = row.profile == qos::ProfileId::kLatched;
    const auto own = std::ranges::find(kRoleTopics, row.path, &RoleTopic::path);
    if (own == std::end(kRoleTopics))
      continue;
    entry.role = own->role;
    for (const OfRole& one : of_roles_)
      if (one.role == own->role && one.followed == own->followed)
        entry.records = one.records.get();
    if (!own->binds)
      continue;
    entry.following = std::make_unique<bus::Following>(bus::Following::WhileUnbound::kTakeAll);
    entry.following->attach(entry.reader.get());
  }
}

RecordedTopics::Entry& RecordedTopics::add(const std::string& name, const msg::AnyType& type,
                                           const qos::Qos& qos, const dds_qos_t* offered,
                                           Stamp stamp) {
  bus::announce(qos.get(), type);
  bus::RawReader reader(participant_.get(), name, *type.descriptor, qos.get());
  bus::GraphEntry graph_entry = participant_.enter(reader.get(), qos::Endpoint::kReader);
  const auto id =
      recorder_.add_topic({.name = name.substr(kRosPrefix.size()),
                           .type = std::string(type.ros_name),
                           .offered_qos = offered_qos_text(offered),
                           .type_hash = std::string(type.hash),
                           .definition = std::string(msg::definition_of(type.ros_name))});
  if (!id)
    throw bus::Error(id.error().sentence);
  wait_set_.attach(reader.condition());
  known_.insert(name);
  return entries_.emplace_back(
      Entry{name, nullptr, std::move(reader), std::move(graph_entry), *id, stamp});
}

bool RecordedTopics::selects(const std::string& topic) const {
  return std::any_of(requested_.begin(), requested_.end(), [&](const std::string& w) {
    return w.ends_with('*') ? topic.starts_with(w.substr(0, w.size() - 1)) : topic == w;
  });
}

std::vector<std::string> RecordedTopics::discover() {
  std::vector<std::string> sentences;
  for (Entry& entry : entries_)
    if (entry.records)
      look_for_writers(entry);
  discovery_.take([&](const dds_builtintopic_endpoint_t& writer) {
    const std::string name = writer.topic_name, type_name = writer.type_name;
    if (!name.starts_with("rt/") || !selects(name) || !known_.insert(name).second)
      return;
    const auto type = std::ranges::find_if(msg::kAllTypes, [&](const msg::AnyType& t) {
      return type_name == t.descriptor->m_typename;
    });
    if (type == std::end(msg::kAllTypes)) {
      sentences.push_back(fmt::format(
          "topic {} is not recorded: its type {} is not compiled in (see idl/)", name, type_name));
      return;
    }
    try {
      const std::lock_guard lock(numbers_mutex_);
      add(name, *type, recording_qos(writer.qos), writer.qos, Stamp::kNewest);
    } catch (const bus::Error& error) {
      sentences.push_back(fmt::format("topic {} is not recorded: {}", name, error.what()));
    }
  });
  return sentences;
}

std::int64_t RecordedTopics::time_of(const Entry& entry, std::span<const std::byte> bytes) {
  if (!options_.lockstep)
    return runtime::realtime_ns();  // time of the take, as in ros2 bag: DDS keeps no time of
                                    // arrival
  if (entry.stamp == Stamp::kSampleTime && bytes.size() >= kSampleTimeOffset + 8) {
    std::int64_t time_ns = 0;
    std::memcpy(&time_ns, bytes.data() + kSampleTimeOffset, sizeof time_ns);
    newest_ns_ = std::max(newest_ns_, time_ns);
    return time_ns;
  }
  return entry.stamp == Stamp::kZero ? 0 : newest_ns_;
}

std::size_t RecordedTopics::drain() {
  std::size_t count = 0;
  for (Entry& entry : entries_)
    count += entry.reader.take([&](std::span<const std::byte> bytes, dds_instance_handle_t writer) {
      const std::int64_t time_ns = time_of(entry, bytes);
      if (entry.records)
        return entry.records->take(writer_of(entry, writer),
                                   {entry.id, time_ns, {bytes.begin(), bytes.end()}});
      push(entry, time_ns, bytes);
    });
  for (const OfRole& one : of_roles_)
    one.records->settle([this](const RoleRecords::Record& record) { push(record); });
  return count;
}

void RecordedTopics::end() {
  for (const OfRole& one : of_roles_)
    one.records->end([this](const RoleRecords::Record& record) { push(record); });
}

void RecordedTopics::push(const RoleRecords::Record& record) {
  push(*std::ranges::find(entries_, record.topic, &Entry::id), record.time_ns, record.bytes);
}

void RecordedTopics::push(Entry& entry, std::int64_t time_ns, std::span<const std::byte> bytes) {
  // Messages that waited until their writer's role was determined must not go back in time: readers
  // of a file without an index refuse that. In lockstep, times are those of the samples.
  if (!options_.lockstep)
    pushed_ns_ = time_ns = std::max(time_ns, pushed_ns_);
  if (entry.latched && std::ranges::equal(entry.newest, bytes))
    return;  // repeated for late readers
  if (entry.latched)
    entry.newest.assign(bytes.begin(), bytes.end());
  const auto pushed = recorder_.push(entry.id, time_ns, bytes);
  if (pushed == bag::PushResult::kQueued && !entry.stream.empty())
    note(entry, bytes);
}

/// A writer that leaves after one record cannot be queried afterwards.
void RecordedTopics::look_for_writers(Entry& entry) {
  const std::vector<dds_instance_handle_t> matched =
      bus::matched_writer_handles(entry.reader.get());
  constexpr std::size_t kMaxWriters = 256;
  if (entry.writers.size() > kMaxWriters)
    std::erase_if(entry.writers, [&](const auto& one) {
      return std::ranges::find(matched, one.first) == matched.end();
    });
  for (const dds_instance_handle_t writer : matched)
    if (entry.writers.size() <= kMaxWriters)
      writer_of(entry, writer);
}

bus::Guid RecordedTopics::writer_of(Entry& entry, dds_instance_handle_t writer) {
  if (const auto known = entry.writers.find(writer); known != entry.writers.end())
    return known->second;
  const bus::Guid participant = bus::participant_of_writer(entry.reader.get(), writer);
  if (participant != bus::Guid{})
    entry.writers.emplace(writer, participant);
  return participant;
}

std::vector<bus::Following*> RecordedTopics::readers_of(std::string_view role) const {
  std::vector<bus::Following*> all;
  for (const Entry& entry : entries_)
    if (entry.following && entry.role == role)
      all.push_back(entry.following.get());
  return all;
}

void RecordedTopics::note(Entry& entry, std::span<const std::byte> bytes) {
  std::uint64_t session = 0, sequence = 0;
  if (bytes.size() < kSampleTimeOffset)
    return;
  std::memcpy(&session, bytes.data() + kSessionOffset, sizeof session);
  std::memcpy(&sequence, bytes.data() + kSessionOffset + sizeof session, sizeof sequence);
  const std::lock_guard lock(numbers_mutex_);
  entry.numbers.add(session, sequence);
}

void RecordedTopics::publish_figures(std::uint64_t session, runtime::Figures& figures) const {
  const std::lock_guard lock(numbers_mutex_);
  for (const Entry& entry : entries_) {
    if (entry.stream.empty())
      continue;
    const SequenceCount::Count count = entry.numbers.of(session);
    figures[entry.stream + "_recorded"] = {count.samples, "samples"};
    figures[entry.stream + "_gaps"] = {count.gaps(), "samples"};
    if (count.samples > 0)
      figures[entry.stream + "_first"] = {count.first, "sample number"};
  }
}

std::vector<runtime::Link> RecordedTopics::links() const {
  std::vector<runtime::Link> links;
  for (const qos::Topic& row : qos::kTopics)
    for (const Entry& entry : entries_)
      if (row.writers != qos::kEveryNode && !row.with_external &&
          entry.name == qos::dds_name(row, options_.rig))
        links.push_back({std::string(row.path),
                         [handle = entry.reader.get()] { return bus::matched_writers(handle); },
                         qos::names_of(row.writers)});
  return links;
}

}  // namespace voxtouch::logger
