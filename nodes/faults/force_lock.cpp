#include "nodes/faults/force_lock.hpp"

#include <random>

#include <fmt/format.h>

#include "qos/topics.hpp"

namespace voxtouch::faults {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

/// splitmix64 (Steele, Lea and Flood 2014): each number occurs once in 2^64.
std::uint64_t next(std::uint64_t& state) noexcept {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

}  // namespace

ForceLock::ForceLock() {
  std::random_device device;
  state_ = (static_cast<std::uint64_t>(device()) << 32U) | device();
}

void ForceLock::engage(const char* reason) noexcept {
  if (engaged())
    return;
  std::uint64_t number = 0;
  while (number == 0)
    number = next(state_);
  reason_.store(reason, kRelaxed);
  asked_.store(0, kRelaxed);
  count_.fetch_add(1, kRelaxed);
  number_.store(number, std::memory_order_release);
}

bool ForceLock::opened() noexcept {
  const std::uint64_t number = number_.load(kRelaxed);
  if (number == 0 || asked_.load(std::memory_order_acquire) != number)
    return false;
  number_.store(0, std::memory_order_release);
  return true;
}

void ForceLock::report_to(runtime::NodeReport& report, bool runs) const {
  report.figures[kCount] = {count_.load(kRelaxed), "times"};
  const std::uint64_t number = number_.load(std::memory_order_acquire);
  if (number == 0 || !runs)
    return;
  const char* reason = reason_.load(kRelaxed);
  report.values[kNumber] = fmt::to_string(number);
  report.values[kReason] = reason;
  report.message = fmt::format(
      "latched at zero force: {}. Find the cause, release the device, then run `voxtouch recover`",
      reason);
}

LockKeeper::LockKeeper(const bus::Participant& participant, const std::string& rig)
    : words_(participant, qos::kRecover, rig, qos::profile(qos::ProfileId::kEvent)) {}

void LockKeeper::listen(std::uint64_t session, ForceLock& lock) {
  constexpr int kMaxWords = 16;
  msg::Recover word;
  for (int n = 0; n < kMaxWords && words_.take(word); ++n)
    if (word.session_id == session)
      lock.open(word.lock);
}

}  // namespace voxtouch::faults
