#pragma once
/// Records that a replay follows: what the participant wrote that plays the role is for the bag,
/// and what others wrote is not.
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <vector>

#include "nodes/bag/bag_sink.hpp"
#include "nodes/bus/graph.hpp"

namespace voxtouch::logger {

/// A record may come before it is known who plays the role: it is kept until then. One whose writer
/// is not authorised is kept for two looks at the statuses, as a rendering that was started again
/// may be received before it is bound. What is refused then is counted. `entitle` and `looked`: the
/// housekeeping. `take`, `settle` and `end`: the thread that reads. Allocates; not for the loop of
/// a ring.
class RoleRecords {
 public:
  struct Record {
    bag::TopicId topic = 0;
    std::int64_t time_ns = 0;  ///< the bag's, of when it was taken
    std::vector<std::byte> bytes{};
  };

  /// Of one writer and of all that are kept [bytes]; what is beyond is refused. A change takes
  /// about 200, a value of the outside wrench 80.
  static constexpr std::size_t kMaxOfOne = 1'000'000, kMaxOfAll = 16'000'000;

  /// While the role was not bound, and at the end if it never was.
  enum class Unknown : bool {
    kRefuse,  ///< what a replay follows
    kRecord,  ///< streams: beyond the limits above, what is kept is recorded
  };
  explicit RoleRecords(Unknown unknown = Unknown::kRefuse) noexcept : unknown_(unknown) {}

  /// This participant plays the role. What it wrote counts, also after it has gone.
  void entitle(const bus::Guid& participant);
  /// All that one check of the statuses gives has been reported. `bound`: the role is bound.
  void looked(bool bound);

  /// `writer`: the participant that wrote it; all zero where it has gone before it was known.
  void take(const bus::Guid& writer, Record record);
  /// Calls push(const Record&) for each that is now known to be the role's, in the order that they
  /// came.
  template <class Push>
  void settle(Push&& push) {
    for (const Record& record : decided())
      push(record);
  }
  /// No participant comes any more that might be authorised: what is still kept is refused, or
  /// recorded if none ever was and kRecord holds.
  template <class Push>
  void end(Push&& push) {
    release_unknown();
    settle(push);
    refuse_kept();
  }

  /// Any thread: how many were for the bag, and how many were not.
  std::uint64_t settled() const;
  std::uint64_t refused() const;
  /// How many of each writer were not; the first sixteen writers.
  std::map<bus::Guid, std::uint64_t> refused_writers() const;

 private:
  struct Kept {
    bus::Guid writer;
    Record record;
    std::uint64_t
        decided_at;  ///< the look after which it is known whether the writer is authorised
  };
  std::vector<Record> decided();
  void release_unknown();
  void refuse_kept();
  void refuse(const bus::Guid& writer);

  const Unknown unknown_;
  mutable std::mutex mutex_;
  bool released_ = false;  ///< all that is kept is recorded
  std::deque<bus::Guid> authorised_;
  std::deque<Kept> kept_;
  std::map<bus::Guid, std::size_t> kept_bytes_;  ///< of each writer
  std::size_t all_bytes_ = 0;
  std::uint64_t looks_ = 0, settled_ = 0, refused_ = 0;
  bool bound_ = false;
  std::map<bus::Guid, std::uint64_t> refused_writers_;
};

}  // namespace voxtouch::logger
