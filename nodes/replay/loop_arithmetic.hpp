#pragma once
/// The processor's arithmetic as the threads have it that answer samples: numbers too small for
/// full precision are zero.
#include <cfenv>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::replay {

/// Active during its lifetime. Code that runs next to a loop uses the default arithmetic, and is
/// bit-identical only with it.
class LoopArithmetic {
 public:
  LoopArithmetic() noexcept {
    std::fegetenv(&before_);
    runtime::flush_denormals();
  }
  ~LoopArithmetic() { std::fesetenv(&before_); }
  LoopArithmetic(const LoopArithmetic&) = delete;
  LoopArithmetic& operator=(const LoopArithmetic&) = delete;

 private:
  std::fenv_t before_{};
};

}  // namespace voxtouch::replay
