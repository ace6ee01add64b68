#pragma once
/// After some faults no force returns before a person has said so.
#include <atomic>
#include <cstdint>
#include <string>

#include "nodes/bus/reader.hpp"
#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::faults {

/// The loop engages it and asks whether it is open again; the monitor reports it and passes on the
/// reset. Each time that it is engaged it has another number, so that a word for one lock opens no
/// other, and one that was recorded opens none.
class ForceLock {
 public:
  ForceLock();

  /// The loop's thread; real-time safe. `reason`: a sentence without its end, that lives as long as
  /// the program.
  void engage(const char* reason) noexcept;
  bool engaged() const noexcept { return number_.load(std::memory_order_acquire) != 0; }
  /// True once, where a person has opened the lock that is engaged.
  bool opened() noexcept;

  /// Another thread. A number that is not the engaged lock's changes nothing.
  void open(std::uint64_t number) noexcept { asked_.store(number, std::memory_order_release); }
  /// What a status says of it. While the node runs, the sentence that a person has to read is its
  /// message, whatever else there was to say.
  void report_to(runtime::NodeReport& report, bool runs = true) const;

  static constexpr char kNumber[] = "lock", kReason[] = "locked_because", kCount[] = "locks";

 private:
  std::uint64_t state_;  ///< of the numbers, the loop's own
  std::atomic<std::uint64_t> number_{0}, asked_{0}, count_{0};
  std::atomic<const char*> reason_{nullptr};
};

/// Takes what people say to the nodes of a rig. Of the housekeeping's thread.
class LockKeeper {
 public:
  LockKeeper(const bus::Participant& participant, const std::string& rig);
  /// Opens `lock` where its number was said in this session.
  void listen(std::uint64_t session, ForceLock& lock);

 private:
  bus::Reader<msg::Recover> words_;
};

}  // namespace voxtouch::faults
