#pragma once
/// Errors wait here until they are read, the newest first.
#include <array>
#include <cstddef>

#include "devices/phantom/hdapi.hpp"

namespace voxtouch::hd_sim {

/// Fixed size: when full, the oldest entry is lost. Real-time safe.
class ErrorStack {
 public:
  static constexpr std::size_t kCapacity = 128;

  /// `internal`: the vendor's second number, unused here.
  void push(phantom::hd::HDerror code, phantom::hd::HHD device, int internal = 0) noexcept {
    top_ = (top_ + 1) % kCapacity;
    entries_[top_] = {code, internal, device};
    if (count_ < kCapacity)
      ++count_;
  }
  /// Removes and returns the newest; kSuccess if empty.
  phantom::hd::HDErrorInfo pop() noexcept {
    if (count_ == 0)
      return {};
    const phantom::hd::HDErrorInfo newest = entries_[top_];
    top_ = (top_ + kCapacity - 1) % kCapacity;
    --count_;
    return newest;
  }
  std::size_t size() const noexcept { return count_; }  ///< number of waiting errors

 private:
  std::array<phantom::hd::HDErrorInfo, kCapacity> entries_{};
  std::size_t top_ = 0, count_ = 0;
};

}  // namespace voxtouch::hd_sim
