#include "devices/phantom/simulated/scheduler.hpp"

#include <algorithm>

namespace voxtouch::hd_sim {

phantom::hd::HDSchedulerHandle CallbackList::add(phantom::hd::HDSchedulerCallback callback,
                                                 void* data, phantom::hd::HDushort priority) {
  if (entries_.size() >= kMaxEntries)
    return 0;
  const Entry entry{++newest_, callback, data, priority};
  const auto behind = std::find_if(entries_.begin(), entries_.end(),
                                   [&](const Entry& e) { return e.priority < priority; });
  entries_.insert(behind, entry);
  return entry.handle;
}

bool CallbackList::contains(phantom::hd::HDSchedulerHandle handle) const noexcept {
  return std::any_of(entries_.begin(), entries_.end(),
                     [handle](const Entry& e) { return e.handle == handle; });
}

void CallbackList::erase(phantom::hd::HDSchedulerHandle handle) noexcept {
  std::erase_if(entries_, [handle](const Entry& e) { return e.handle == handle; });
  over_.notify_all();
}

bool CallbackList::remove(phantom::hd::HDSchedulerHandle handle, Lock& lock, bool from_servo) {
  if (!contains(handle))
    return false;
  erase(handle);
  if (!from_servo)
    over_.wait(lock, [&] { return running_ != handle; });
  return true;
}

void CallbackList::run(Lock& lock) {
  round_ = entries_;
  for (std::size_t i = 0; i < round_.size(); ++i) {
    const Entry entry = round_[i];
    if (!contains(entry.handle))
      continue;  // removed by an earlier callback
    running_ = entry.handle;
    lock.unlock();
    const phantom::hd::HDCallbackCode code = entry.callback(entry.data);
    lock.lock();
    running_ = 0;
    if (code == phantom::hd::kCallbackDone)
      erase(entry.handle);
    over_.notify_all();
  }
}

}  // namespace voxtouch::hd_sim
