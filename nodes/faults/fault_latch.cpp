#include "nodes/faults/fault_latch.hpp"

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

FaultLatch::FaultLatch() {
  std::random_device device;
  state_ = (static_cast<std::uint64_t>(device()) << 32U) | device();
}

void FaultLatch::latch(const char* reason) noexcept {
  if (latched())
    return;
  std::uint64_t number = 0;
  while (number == 0)
    number = next(state_);
  reason_.store(reason, kRelaxed);
  reset_number_.store(0, kRelaxed);
  count_.fetch_add(1, kRelaxed);
  number_.store(number, std::memory_order_release);
}

bool FaultLatch::take_reset() noexcept {
  const std::uint64_t number = number_.load(kRelaxed);
  if (number == 0 || reset_number_.load(std::memory_order_acquire) != number)
    return false;
  number_.store(0, std::memory_order_release);
  return true;
}

void FaultLatch::report_to(runtime::NodeReport& report, bool runs) const {
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

ResetReceiver::ResetReceiver(const bus::Participant& participant, const std::string& rig)
    : resets_(participant, qos::kRecover, rig, qos::profile(qos::ProfileId::kEvent)) {}

void ResetReceiver::receive(std::uint64_t session, FaultLatch& latch) {
  constexpr int kMaxResets = 16;
  msg::Recover message;
  for (int n = 0; n < kMaxResets && resets_.take(message); ++n)
    if (message.session_id == session)
      latch.reset(message.fault_latch);
}

}  // namespace voxtouch::faults
