#pragma once
/// Filters the records that a replay uses: only those of the participant in the role are written to
/// the bag.
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <vector>

#include "nodes/bag/bag_sink.hpp"
#include "nodes/bus/graph.hpp"

namespace voxtouch::logger {

/// Keeps records until the participant in the role is determined.
/// A record of an unauthorised writer is kept for two polls of the statuses, because messages of a
/// restarted rendering may arrive while it is unbound. Records refused after that are counted. The
/// monitor thread calls `entitle` and `looked`; the reading thread calls `take`, `settle` and
/// `end`. Allocates; not for the loop of a ring.
class RoleRecords {
 public:
  struct Record {
    bag::TopicId topic = 0;
    std::int64_t time_ns = 0;  ///< time of the take, for the bag
    std::vector<std::byte> bytes{};
  };

  /// Limits for one writer and for all kept records [bytes]; records beyond them are refused. A
  /// change takes about 200 bytes, a value of the external wrench 80.
  static constexpr std::size_t kMaxOfOne = 1'000'000, kMaxOfAll = 16'000'000;

  /// Handling of records received while the role was unbound, also at the end if it never was
  /// bound.
  enum class Unknown : bool {
    kRefuse,  ///< records that a replay uses
    kRecord,  ///< streams: beyond the limits above, the kept records are written
  };
  explicit RoleRecords(Unknown unknown = Unknown::kRefuse) noexcept : unknown_(unknown) {}

  /// Authorises this participant. Its records are written, even after it has left.
  void entitle(const bus::Guid& participant);
  /// Marks the end of one poll of the statuses. `bound`: the role is bound.
  void looked(bool bound);

  /// `writer`: participant that wrote the record; all zero if it left without being identified.
  void take(const bus::Guid& writer, Record record);
  /// Calls push(const Record&) for each record now attributed to the role, in order of arrival.
  template <class Push>
  void settle(Push&& push) {
    for (const Record& record : decided())
      push(record);
  }
  /// No further participant will be authorised. Kept records are refused; with kRecord they are
  /// written if none ever was authorised.
  template <class Push>
  void end(Push&& push) {
    release_unknown();
    settle(push);
    refuse_kept();
  }

  /// Any thread: number of written and of refused records.
  std::uint64_t settled() const;
  std::uint64_t refused() const;
  /// Number of refused records of each writer, for the first sixteen writers.
  std::map<bus::Guid, std::uint64_t> refused_writers() const;

 private:
  struct Kept {
    bus::Guid writer;
    Record record;
    std::uint64_t decided_at;  ///< the poll that decides whether the writer is authorised
  };
  std::vector<Record> decided();
  void release_unknown();
  void refuse_kept();
  void refuse(const bus::Guid& writer);

  const Unknown unknown_;
  mutable std::mutex mutex_;
  bool released_ = false;  ///< all kept records are written
  std::deque<bus::Guid> authorised_;
  std::deque<Kept> kept_;
  std::map<bus::Guid, std::size_t> kept_bytes_;  ///< of each writer
  std::size_t all_bytes_ = 0;
  std::uint64_t polls_ = 0, settled_ = 0, refused_ = 0;
  bool bound_ = false;
  std::map<bus::Guid, std::uint64_t> refused_writers_;
};

}  // namespace voxtouch::logger
