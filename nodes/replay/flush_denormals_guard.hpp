#pragma once
/// The arithmetic of the threads that answer samples: denormal numbers are zero.
#include <cfenv>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::replay {

/// Sets that arithmetic during its lifetime. Code outside a node's loop uses the default
/// arithmetic; a replay is bit-identical only if both are as in the run.
class FlushDenormalsGuard {
 public:
  FlushDenormalsGuard() noexcept {
    std::fegetenv(&before_);
    runtime::flush_denormals();
  }
  ~FlushDenormalsGuard() { std::fesetenv(&before_); }
  FlushDenormalsGuard(const FlushDenormalsGuard&) = delete;
  FlushDenormalsGuard& operator=(const FlushDenormalsGuard&) = delete;

 private:
  std::fenv_t before_{};
};

}  // namespace voxtouch::replay
