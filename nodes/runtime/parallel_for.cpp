#include "nodes/runtime/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::runtime {
namespace {

using Body = std::function<void(std::size_t)>;

/// One loop: its threads take the next index until none is left or one has failed. Indices are
/// taken in order, so all indices below a failed one have been taken. The lowest failure is
/// therefore the one of a serial loop.
class Loop {
 public:
  Loop(std::size_t count, const Body& body) : count_(count), body_(body) {}

  void run(std::size_t threads) {
    std::vector<std::jthread> pool;  // joined by its destructor
    try {
      while (pool.size() < threads)
        pool.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
      if (pool.empty()) {  // no thread could be started: the calling thread does the work
        const AtOrdinaryPriority here;
        work();
      }
    }
    pool.clear();
    if (failure_)
      std::rethrow_exception(failure_);
  }

 private:
  void work() {
    ordinary_priority();
    for (std::size_t i;
         !failed_.load(std::memory_order_relaxed) && (i = next_.fetch_add(1)) < count_;) {
      try {
        body_(i);
      } catch (...) {
        fail(i);
      }
    }
  }
  void fail(std::size_t index) {
    const std::lock_guard lock(mutex_);
    if (!failure_ || index < failed_at_)
      failure_ = std::current_exception(), failed_at_ = index;
    failed_ = true;
  }

  const std::size_t count_;
  const Body& body_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::exception_ptr failure_;
  std::size_t failed_at_ = 0;
};

}  // namespace

std::size_t processors() noexcept { return std::max(1U, std::thread::hardware_concurrency()); }

ParallelFor threaded_for(std::size_t threads) {
  if (threads <= 1)
    return serial_for();
  return [threads](std::size_t count, const Body& body) {
    if (count <= 1)
      return serial_for()(count, body);
    Loop(count, body).run(std::min(threads, count));
  };
}

}  // namespace voxtouch::runtime
