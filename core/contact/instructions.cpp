#include "core/contact/instructions.hpp"

#include <algorithm>
#include <atomic>

namespace voxtouch::contact {
namespace {

std::atomic<Instructions>& in_use() noexcept {
  static std::atomic<Instructions> chosen = widest_instructions();
  return chosen;
}

}  // namespace

Instructions widest_instructions() noexcept {
#if VOXTOUCH_WIDE_KERNELS
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
    return Instructions::kAny;
  const bool all = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  return all ? Instructions::kAvx512 : Instructions::kAvx2;
#else
  return Instructions::kAny;
#endif
}

Instructions instructions() noexcept { return in_use().load(std::memory_order_relaxed); }

void use_instructions(Instructions most) noexcept {
  in_use().store(std::min(most, widest_instructions()), std::memory_order_relaxed);
}

}  // namespace voxtouch::contact
