#pragma once
/// The readers of a recording. Those of the ring exist from the start, others are created when
/// their writers appear.
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "nodes/bag/bag_recorder.hpp"
#include "nodes/bus/following.hpp"
#include "nodes/bus/raw_reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer_discovery.hpp"
#include "nodes/logger/role_records.hpp"
#include "nodes/logger/sequence_count.hpp"
#include "nodes/runtime/figure.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/participation.hpp"
#include "voxtouch_msgs/all_types.hpp"

namespace voxtouch::logger {

class RecordedTopics {
 public:
  /// Creates readers for every row of the topic table that is recorded. Throws bus::Error.
  RecordedTopics(const bus::Participant& participant, const runtime::NodeOptions& options,
                 std::vector<std::string> requested, bag::BagRecorder& recorder,
                 bus::WaitSet& wait_set);

  /// Creates readers for selected topics whose writers have appeared. Returns sentences about
  /// topics that cannot be recorded, for example because their type is not compiled in.
  std::vector<std::string> discover();
  /// Takes all waiting samples into the recorder; returns their number.
  std::size_t drain();
  /// The last call: records kept for an absent participant are refused.
  void end();
  /// Readers of the topics of a role. Their addresses do not change.
  std::vector<bus::Following*> readers_of(std::string_view role) const;
  /// Topics that only the participant in a role may write: the streams, and the records that a
  /// replay uses.
  struct OfRole {
    std::string_view role;
    std::unique_ptr<RoleRecords> records;
    bool followed;  ///< used by a replay
  };
  std::span<const OfRole> of_roles() const noexcept { return of_roles_; }
  /// The matches required for the start of a lockstep run.
  std::vector<runtime::Link> links() const;
  /// Reports which samples of `session` were recorded, for each stream of the ring. Any thread.
  void publish_figures(std::uint64_t session, runtime::Figures& figures) const;

 private:
  /// Source of a message's time stamp in lockstep, where clocks are not used.
  enum class Stamp { kSampleTime, kZero, kNewest };
  struct Entry {
    std::string name;
    std::unique_ptr<bus::Following>
        following;  ///< filter of the reader, which it outlives; only for topics of a role
    bus::RawReader reader;
    bus::GraphEntry graph_entry;  ///< entry for ROS 2 tools
    bag::TopicId id;
    Stamp stamp;
    std::string stream{};             ///< "device_state"; empty if samples have no number
    SequenceCount numbers{};          ///< guarded by `numbers_mutex_`
    bool latched = false;             ///< an unchanged value is not recorded again
    std::vector<std::byte> newest{};  ///< the newest value of a latched topic
    std::string_view role{};          ///< the role that writes the topic; empty: any node
    RoleRecords* records =
        nullptr;  ///< filter for the messages of the role; null: all are recorded
    std::map<dds_instance_handle_t, bus::Guid>
        writers{};  ///< discovered writers, if `records` is set
  };
  Entry& add(const std::string& name, const msg::AnyType& type, const qos::Qos& qos,
             const dds_qos_t* offered, Stamp stamp);
  bool selects(const std::string& topic) const;
  void note(Entry& entry, std::span<const std::byte> bytes);
  void push(const RoleRecords::Record& record);
  void push(Entry& entry, std::int64_t time_ns, std::span<const std::byte> bytes);
  static void look_for_writers(Entry& entry);
  static bus::Guid writer_of(Entry& entry, dds_instance_handle_t writer);
  std::int64_t time_of(const Entry& entry, std::span<const std::byte> bytes);

  const bus::Participant& participant_;
  const runtime::NodeOptions& options_;
  std::vector<std::string> requested_;
  bag::BagRecorder& recorder_;
  bus::WaitSet& wait_set_;
  bus::WriterDiscovery discovery_;
  std::deque<Entry> entries_;  // addresses do not change
  std::set<std::string> known_;
  std::vector<OfRole> of_roles_;
  std::int64_t newest_ns_ = 0;
  std::int64_t pushed_ns_ = 0;  ///< real time: the newest time in the bag
  mutable std::mutex numbers_mutex_;
};

}  // namespace voxtouch::logger
