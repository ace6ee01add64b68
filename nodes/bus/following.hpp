#pragma once
/// Sample filter of a reader: it accepts the samples of one writer. DDS filters first and then
/// stores, so other writers occupy no history and wake no thread.
#include <array>
#include <atomic>
#include <map>
#include <vector>

#include "nodes/bus/participant.hpp"

namespace voxtouch::bus {

/// Samples of one participant that a reader refused.
struct RefusedSamples {
  Guid participant{};  ///< all zero: it left without being identified
  std::uint64_t count = 0;
};

/// One slow thread calls `follow` and all other allocating methods. `writer`: any thread, real-time
/// safe. The object must not move, since the reader refers to it.
class Following {
 public:
  enum class WhileUnbound : bool {
    kTakeNothing,  ///< streams: a sample of an unknown writer is useless
    /// Latched values, which arrive while the relevant writer is unknown; also after the followed
    /// writer has left.
    kTakeAll,
  };
  explicit Following(WhileUnbound rule) noexcept : rule_(rule) {}
  Following(const Following&) = delete;
  Following& operator=(const Following&) = delete;

  /// Follows the writer of `participant`. Returns false, and follows no writer, if the reader has
  /// matched none of its writers.
  bool follow(const Guid& participant);
  void follow_none() noexcept { writer_.store(0, std::memory_order_release); }
  /// Blocks `writer` while no writer is followed, after it has sent invalid data. The last 16 such
  /// writers are stored.
  void refuse(dds_instance_handle_t writer) noexcept;
  /// Publication handle of the followed writer; 0 if there is none.
  dds_instance_handle_t writer() const noexcept { return writer_.load(std::memory_order_acquire); }

  /// Whether this reader has matched a writer of `participant`.
  bool has_matched(const Guid& participant) const;
  /// Whether the followed writer is still present.
  bool has_writer() const;
  /// Number of samples from other writers received while a writer was followed; any thread.
  std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }
  /// Samples refused since the last call, for the first kMaxCounted writers.
  std::vector<RefusedSamples> take_refused();

  // Called by the reader.
  /// Subscribes to notifications about departing writers. Throws Error.
  void attach(dds_entity_t reader);
  /// Handles the departure of a writer; stored if it is the followed one. Called in a thread of
  /// DDS.
  void see_go(dds_instance_handle_t writer) noexcept;
  /// The filter that DDS applies to each received sample.
  dds_topic_filter filter() noexcept;
  /// Whether to accept a sample of `writer`; counts refusals. Real-time safe.
  bool admits(dds_instance_handle_t writer) noexcept;

 private:
  dds_instance_handle_t writer_of(const Guid& participant) const;
  WhileUnbound rule_;
  dds_entity_t reader_ = 0;
  std::atomic<dds_instance_handle_t> writer_{0};
  std::atomic<bool> has_gone_{
      false};  ///< the followed writer has left, and `follow` has not been called since
  std::atomic<std::uint64_t> refused_{0};
  std::array<std::atomic<dds_instance_handle_t>, 16> unwanted_{};
  std::size_t unwanted_count_ = 0;
  static constexpr std::size_t kMaxCounted = 32;
  struct Counted {
    std::atomic<dds_instance_handle_t> writer{0};
    std::atomic<std::uint64_t> count{0};
  };
  std::array<Counted, kMaxCounted> counted_{};  ///< each writer has the slot that was free first
  std::map<dds_instance_handle_t, Guid> participants_;  ///< participants of refused writers
};

}  // namespace voxtouch::bus
