#include "devices/phantom/hd_errors.hpp"

#include <fmt/format.h>

namespace voxtouch::phantom {
namespace {

// More than any stack holds: a library that never reports an empty stack must not block the servo
// thread.
constexpr int kMaxAtOnce = 256;

}  // namespace

HdVerdict classify(hd::HDerror code) noexcept {
  switch (code) {
    case hd::kSuccess:
      return {};
    case hd::kWarmMotors:
    case hd::kExceededMaxForce:
    case hd::kExceededMaxForceImpulse:
    case hd::kExceededMaxVelocity:
    case hd::kForceError:
      return {HdSeverity::kForceDropped, devices::DeviceError::kRecoverable};
    case hd::kInvalidEnum:
    case hd::kInvalidValue:
    case hd::kInvalidOperation:
    case hd::kInvalidInputType:
    case hd::kIllegalBegin:
    case hd::kIllegalEnd:
    case hd::kFrameError:
      return {HdSeverity::kRefused, devices::DeviceError::kProtocol};
    case hd::kBadHandle:  // the device was disabled by other code
    case hd::kCommError:
    case hd::kCommConfigError:
      return {HdSeverity::kFatal, devices::DeviceError::kDisconnected};
    default:
      return {HdSeverity::kFatal, devices::DeviceError::kFault};
  }
}

std::string error_text(const hd::Api& api, hd::HDerror code) {
  const hd::HDstring text = api.hdGetErrorString(code);
  return fmt::format("{:#06x} ({})", code, text != nullptr ? text : "no text");
}

void HdErrorLog::note(hd::HDerror code) noexcept {
  const HdSeverity severity = classify(code).severity;
  if (severity == HdSeverity::kNone)
    return;
  if (severity == HdSeverity::kFatal) {
    hd::HDerror none = hd::kSuccess;
    fatal_.compare_exchange_strong(none, code, std::memory_order_acq_rel);
    return;
  }
  if (severity == HdSeverity::kForceDropped)
    dropped_.fetch_add(1, std::memory_order_relaxed);
  newest_.store(code, std::memory_order_release);
  count_.fetch_add(1, std::memory_order_acq_rel);
}

void HdErrorLog::drain(const hd::Api& api) noexcept {
  for (int i = 0; i < kMaxAtOnce; ++i) {
    const hd::HDerror code = api.hdGetError().error_code;
    if (code == hd::kSuccess)
      return;
    note(code);
  }
}

}  // namespace voxtouch::phantom
