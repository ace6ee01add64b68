#pragma once
/// How core code runs in parallel without knowing of threads: the caller gives the loop.
#include <cstddef>
#include <functional>

namespace voxtouch {

/// Calls `body(i)` for every i in [0, count), in any order, perhaps at once. Results may not depend
/// on that order.
using ParallelFor =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& body)>;

/// The loop that uses no threads.
inline ParallelFor serial_for() {
  return [](std::size_t count, const std::function<void(std::size_t)>& body) {
    for (std::size_t i = 0; i < count; ++i)
      body(i);
  };
}

}  // namespace voxtouch
