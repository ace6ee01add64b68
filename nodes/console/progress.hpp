#pragma once
/// Progress of long steps on a terminal.
#include <chrono>
#include <functional>
#include <string>

#include "nodes/console/log.hpp"

namespace voxtouch::console {

/// For the progress callbacks of the core: prints "<who>: <step>" on a terminal, at most once a
/// second, and nothing in the first second.
inline std::function<void(const std::string&)> log_each_second(std::string who) {
  using Clock = std::chrono::steady_clock;
  return [who = std::move(who),
          next = Clock::now() + std::chrono::seconds(1)](const std::string& step) mutable {
    if (Clock::now() < next)
      return;
    show_progress("{}: {}", who, step);
    next = Clock::now() + std::chrono::seconds(1);
  };
}

}  // namespace voxtouch::console
