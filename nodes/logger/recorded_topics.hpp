#pragma once
/// The readers of a recording: those of the ring from the start, others as their writers appear.
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
  /// Makes readers for every row of the table that is recorded. Throws bus::Error.
  RecordedTopics(const bus::Participant& participant, const runtime::NodeOptions& options,
                 std::vector<std::string> requested, bag::BagRecorder& recorder,
                 bus::WaitSet& wait_set);

  /// Makes readers for selected topics whose writers have appeared since. Returns sentences about
  /// what cannot be recorded: a topic whose type is not compiled in is one.
  std::vector<std::string> discover();
  /// Takes all that is there into the recorder; how many samples that was.
  std::size_t drain();
  /// The last call: what is kept for an absent participant is refused.
  void end();
  /// Readers of what who plays the role writes. Their addresses stay.
  std::vector<bus::Following*> readers_of(std::string_view role) const;
  /// What those who play the roles alone may write: the streams, and the records that a replay
  /// follows.
  struct OfRole {
    std::string_view role;
    std::unique_ptr<RoleRecords> records;
    bool followed;  ///< by a replay
  };
  std::span<const OfRole> of_roles() const noexcept { return of_roles_; }
  /// Who must have matched what before a lockstep run.
  std::vector<runtime::Link> links() const;
  /// Which samples of `session` were taken to be written, for each stream of the ring. Any thread.
  void publish_figures(std::uint64_t session, runtime::Figures& figures) const;

 private:
  /// How a message's time in the bag is found in lockstep, where no clock may be asked.
  enum class Stamp { kSampleTime, kZero, kNewest };
  struct Entry {
    std::string name;
    std::unique_ptr<bus::Following>
        following;  ///< who has matched the reader, which it outlives; where a role asks for it
    bus::RawReader reader;
    bus::GraphEntry shown;  ///< to ROS 2 tools
    bag::TopicId id;
    Stamp stamp;
    std::string stream{};     ///< "device_state"; empty where samples bear no number
    SequenceCount numbers{};  ///< under `numbers_mutex_`
    bool latched = false;     ///< a value that is the newest one again is not recorded again
    std::vector<std::byte> newest{};  ///< of a latched one
    std::string_view role{};          ///< who plays it writes the topic; empty: any node
    RoleRecords* records =
        nullptr;  ///< only what who plays the role writes is for the bag; null: all is
    std::map<dds_instance_handle_t, bus::Guid>
        writers{};  ///< those that have been seen, where it has `records`
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
  std::deque<Entry> entries_;  // addresses stay
  std::set<std::string> known_;
  std::vector<OfRole> of_roles_;
  std::int64_t newest_ns_ = 0;
  std::int64_t pushed_ns_ = 0;  ///< real time: the newest time in the bag
  mutable std::mutex numbers_mutex_;
};

}  // namespace voxtouch::logger
