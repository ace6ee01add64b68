#pragma once
/// Nodes as threads of a test, in a private rig.
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "nodes/runtime/options.hpp"

namespace voxtouch::test {

/// Test cases run as processes side by side: the pid keeps their rigs apart.
inline constexpr std::uint32_t kDomain = 60;
inline std::string own_rig(const std::string& name = "r") {
  return name + std::to_string(getpid());
}

template <class Options>
Options node_options(const std::string& rig, const std::string& scene = {}) {
  Options options;
  options.rig = rig;
  options.domain = kDomain;
  options.network_interface =
      "lo";  // a process has one for all its participants of a domain, and those of tests name it
  if (!scene.empty())
    options.scene = std::string(VOXTOUCH_DEPLOY) + "/scenes/" + scene + ".yaml";
  return options;
}

/// Runs `node(stop)`; an exception counts as status 1, its text is kept.
class NodeThread {
 public:
  explicit NodeThread(std::function<int(const std::atomic<bool>&)> node)
      : thread_([this, node = std::move(node)] {
          int status = 1;
          try {
            status = node(stop_);
          } catch (const std::exception& e) {
            error_ = e.what();
          }
          status_.store(status, std::memory_order_release);
        }) {}
  ~NodeThread() { end(); }
  /// Exit status, -1 while it runs.
  int status() const { return status_.load(std::memory_order_acquire); }
  int wait() {
    if (thread_.joinable())
      thread_.join();
    return status();
  }
  int end() {
    stop_.store(true);
    return wait();
  }
  void request_stop() { stop_.store(true); }
  const std::string& error() const { return error_; }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<int> status_{-1};
  std::string error_;
  std::thread thread_;
};

inline bool wait_until(const std::function<bool()>& holds,
                       std::chrono::milliseconds patience = std::chrono::seconds(15)) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until)
      return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace voxtouch::test
