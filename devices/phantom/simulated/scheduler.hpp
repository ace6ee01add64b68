#pragma once
/// Callbacks of the servo loop, in order of priority.
#include <condition_variable>
#include <mutex>
#include <vector>

#include "devices/phantom/hdapi.hpp"

namespace voxtouch::hd_sim {

/// Guarded by the mutex of the owner. Functions are called with the lock held, callbacks run
/// without it.
class CallbackList {
 public:
  static constexpr std::size_t kMaxEntries = 64;
  using Lock = std::unique_lock<std::recursive_mutex>;

  /// Inserts it after those of equal priority. 0: no room.
  phantom::hd::HDSchedulerHandle add(phantom::hd::HDSchedulerCallback callback, void* data,
                                     phantom::hd::HDushort priority);
  /// Number of scheduled callbacks.
  std::size_t size() const noexcept { return entries_.size(); }
  /// Removes a callback, and waits until it is not running, unless `from_servo`. Returns false if
  /// it is unknown.
  bool remove(phantom::hd::HDSchedulerHandle handle, Lock& lock, bool from_servo);
  /// Calls each callback once, by decreasing priority, the older first among equals. Callbacks
  /// added meanwhile wait for the next tick.
  void run(Lock& lock);
  /// Removes all; none may be running.
  void clear() noexcept { entries_.clear(); }

 private:
  struct Entry {
    phantom::hd::HDSchedulerHandle handle = 0;
    phantom::hd::HDSchedulerCallback callback = nullptr;
    void* data = nullptr;
    phantom::hd::HDushort priority = 0;
  };
  bool contains(phantom::hd::HDSchedulerHandle handle) const noexcept;
  void erase(phantom::hd::HDSchedulerHandle handle) noexcept;

  std::vector<Entry> entries_, round_;
  phantom::hd::HDSchedulerHandle newest_ = 0, running_ = 0;
  std::condition_variable_any over_;
};

}  // namespace voxtouch::hd_sim
