#pragma once
/// Where a recorder's disk thread writes messages: BagWriter, or a slow or faulty disk in tests.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "nodes/bag/bag_metadata.hpp"
#include "nodes/bag/error.hpp"

namespace voxtouch::bag {

using TopicId = std::uint32_t;  ///< index in the order of add_topic, from 0

/// Counts of one topic: received = written + dropped + lost, once closed.
struct TopicReport {
  std::string name;
  std::uint64_t received = 0;  ///< given to the recorder
  std::uint64_t written = 0;   ///< committed to the bag
  std::uint64_t dropped = 0;   ///< no room in the queue: the disk was too slow
  std::uint64_t lost = 0;      ///< the disk refused them: full, unwritable
};

struct RecordingReport {
  bool closed = false;
  bool lockstep = false;
  std::vector<TopicReport> topics;
  std::vector<std::string> errors;  ///< sentences, each once, in order of appearance
  std::uint64_t total(std::uint64_t TopicReport::*count) const noexcept {
    std::uint64_t sum = 0;
    for (const auto& topic : topics)
      sum += topic.*count;
    return sum;
  }
};

/// One thread makes all calls, which may block. Calls continue after an error: a disk with free
/// space again is used again.
class BagSink {
 public:
  virtual ~BagSink() = default;
  virtual Result<TopicId> add_topic(const TopicInfo& topic) = 0;
  /// time_ns >= 0. On error this message, and possibly all uncommitted ones, are lost; see
  /// fill_counts.
  virtual Result<void> append(TopicId topic, std::int64_t time_ns,
                              std::span<const std::byte> bytes) = 0;
  /// To be called at least ten times a second: commits, refreshes, when it is time to.
  virtual Result<void> tick() = 0;
  /// Sets `written` and `lost` of each topic, in the order of add_topic.
  virtual void fill_counts(std::vector<TopicReport>& topics) const = 0;
  /// Puts the report next to the bag.
  virtual Result<void> report(const RecordingReport& report) = 0;
  /// Commits pending messages and ends the bag.
  virtual Result<void> close() = 0;
};

}  // namespace voxtouch::bag
