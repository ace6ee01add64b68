#pragma once
/// A recorder that is told to take part has a run in real time from its first sample on. In
/// lockstep everybody is waited for: participation.hpp.
#include <atomic>
#include <cstdint>
#include <optional>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::runtime {

/// DDS does not say when both ends know each other, and what a writer of a stream writes before it
/// knows a reader is lost to that one. A node therefore begins its first session when the logger
/// reads what it writes. Once open the gate stays open: a logger that goes, or comes too late,
/// costs samples in the bag and no force.
class RecorderGate {
 public:
  /// The longest that a logger which does not come keeps a node from beginning [ns]. A test that
  /// goes by what comes, and by no clock, sets it before it makes a node.
  static inline std::atomic<std::int64_t> patience_ns{5'000'000'000};

  explicit RecorderGate(const NodeOptions& options)
      : open_(options.lockstep || !options.has_peer("logger")) {}

  /// From the housekeeping, at each look, with the node's writer of a stream.
  template <class Writer>
  void look(const NodeRegistry& registry, const Writer& writer,
            std::int64_t now_ns = monotonic_ns()) {
    if (open())
      return;
    if (!begin_ns_)
      begin_ns_ = now_ns;
    if (has_matched(registry, writer.matched(), {"logger"}) || now_ns - *begin_ns_ > patience_ns)
      open_.store(true, std::memory_order_release);
  }
  /// Whether samples may be answered. Any thread; real-time safe.
  bool open() const noexcept { return open_.load(std::memory_order_acquire); }

 private:
  std::atomic<bool> open_;
  std::optional<std::int64_t> begin_ns_;  ///< of the first look
};

}  // namespace voxtouch::runtime
