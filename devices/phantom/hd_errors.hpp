#pragma once
/// Classifies the errors of the library and records them for the threads of the loop.
#include <atomic>
#include <cstdint>
#include <string>

#include "devices/driver.hpp"
#include "devices/phantom/hdapi.hpp"

namespace voxtouch::phantom {

enum class HdSeverity : std::uint8_t {
  kNone,
  /// Too warm, too fast, or too much force: the device dropped its force and will accept it again.
  kForceDropped,
  kRefused,  ///< it refused a call or the call was invalid; the next tick may succeed
  kFatal,    ///< the device or the servo loop is lost
};
struct HdVerdict {
  HdSeverity severity = HdSeverity::kNone;
  devices::DeviceError error = devices::DeviceError::kFault;  ///< valid unless kNone
};
/// Classes as in the vendor's utilities, with additions: 0x202 is a force error; 0x300 and unknown
/// codes are fatal.
HdVerdict classify(hd::HDerror code) noexcept;

/// "0x0302 (the library's sentence)". Allocates.
std::string error_text(const hd::Api& api, hd::HDerror code);

/// Errors since the device was opened. Any thread may write and read; real-time safe.
class HdErrorLog {
 public:
  void note(hd::HDerror code) noexcept;
  /// Pops the library's stack until it is empty.
  void drain(const hd::Api& api) noexcept;

  /// The first fatal error; kSuccess without one. It is kept.
  hd::HDerror fatal() const noexcept { return fatal_.load(std::memory_order_acquire); }
  /// Increases with every error that is not fatal.
  std::uint64_t count() const noexcept { return count_.load(std::memory_order_acquire); }
  /// The newest error that is not fatal.
  hd::HDerror newest() const noexcept { return newest_.load(std::memory_order_acquire); }
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::atomic<hd::HDerror> fatal_{hd::kSuccess}, newest_{hd::kSuccess};
  std::atomic<std::uint64_t> count_{0}, dropped_{0};
};

}  // namespace voxtouch::phantom
