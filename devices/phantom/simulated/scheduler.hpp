#pragma once
/// Callbacks of the servo loop, in order of their priority.
#include <condition_variable>
#include <mutex>
#include <vector>

#include "devices/phantom/hdapi.hpp"

namespace voxtouch::hd_sim {

/// Guarded by the mutex that the owner gives; functions are called with it held, callbacks run
/// without it.
class CallbackList {
 public:
  static constexpr std::size_t kMaxEntries = 64;
  using Lock = std::unique_lock<std::recursive_mutex>;

  /// Behind those of the same priority. 0: there is no room.
  phantom::hd::HDSchedulerHandle add(phantom::hd::HDSchedulerCallback callback, void* data,
                                     phantom::hd::HDushort priority);
  std::size_t size() const noexcept { return entries_.size(); }  ///< callbacks that are scheduled
  /// Takes it out; waits until it is not running, unless `from_servo`. False: there is none.
  bool remove(phantom::hd::HDSchedulerHandle handle, Lock& lock, bool from_servo);
  /// Each callback once, in falling priority, the older first among equals. What comes meanwhile
  /// waits for the next tick.
  void run(Lock& lock);
  /// Takes out all; none may be running.
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
