#pragma once
/// Whose samples a reader takes in: those of one writer. DDS asks before it stores a sample, so
/// what others write, however fast, takes no place in the reader's history and wakes no thread.
#include <array>
#include <atomic>
#include <map>
#include <vector>

#include "nodes/bus/participant.hpp"

namespace voxtouch::bus {

/// Samples of one participant that a reader refused.
struct RefusedSamples {
  Guid participant{};  ///< all zero: it went before it was known
  std::uint64_t count = 0;
};

/// `follow` and all that allocates: one slow thread. `writer`: any thread, real-time safe. Its
/// address stays: the reader keeps it.
class Following {
 public:
  enum class WhileUnbound : bool {
    kTakeNothing,  ///< streams: a sample of an unknown writer is of no use
    kTakeAll,  ///< latched values, which come before it is known whose is needed; also while the
               ///< one that is followed has gone
  };
  explicit Following(WhileUnbound rule) noexcept : rule_(rule) {}
  Following(const Following&) = delete;
  Following& operator=(const Following&) = delete;

  /// From now on the writer of `participant`. False, and no writer is followed, where this reader
  /// has matched none of it.
  bool follow(const Guid& participant);
  void follow_none() noexcept { writer_.store(0, std::memory_order_release); }
  /// Nothing of `writer` is taken while no writer is followed, for one that sends what cannot be
  /// ours. The last 16 are remembered.
  void refuse(dds_instance_handle_t writer) noexcept;
  /// Its publication handle; 0: none's.
  dds_instance_handle_t writer() const noexcept { return writer_.load(std::memory_order_acquire); }

  /// Whether this reader has matched a writer of `participant`.
  bool has_matched(const Guid& participant) const;
  /// Whether the writer that is followed is still there.
  bool has_writer() const;
  /// Samples of others that came while a writer was followed; any thread.
  std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }
  /// What was refused since the last call, of the first kMaxCounted writers.
  std::vector<RefusedSamples> take_refused();

  // Of the reader.
  /// Throws Error. From now on it is notified which writers leave.
  void attach(dds_entity_t reader);
  /// A writer has gone; remembered where it is the one that is followed. In a thread of DDS.
  void see_go(dds_instance_handle_t writer) noexcept;
  /// What DDS asks before it stores a sample.
  dds_topic_filter filter() noexcept;
  /// Whether a sample of `writer` is to be taken; counts. Real-time safe.
  bool admits(dds_instance_handle_t writer) noexcept;

 private:
  dds_instance_handle_t writer_of(const Guid& participant) const;
  WhileUnbound rule_;
  dds_entity_t reader_ = 0;
  std::atomic<dds_instance_handle_t> writer_{0};
  std::atomic<bool> has_gone_{
      false};  ///< the writer that is followed has gone, and `follow` has not been called since
  std::atomic<std::uint64_t> refused_{0};
  std::array<std::atomic<dds_instance_handle_t>, 16> unwanted_{};
  std::size_t unwanted_count_ = 0;
  static constexpr std::size_t kMaxCounted = 32;
  struct Counted {
    std::atomic<dds_instance_handle_t> writer{0};
    std::atomic<std::uint64_t> count{0};
  };
  std::array<Counted, kMaxCounted> counted_{};  ///< a writer's place is the first that was free
  std::map<dds_instance_handle_t, Guid> participants_;  ///< of writers that were refused
};

}  // namespace voxtouch::bus
