#pragma once
/// One hash for names of content and of runs.
#include <cstdint>
#include <string_view>

namespace voxtouch {

/// 64-bit FNV-1a (Fowler, Noll, Vo) of all bytes that were added. It finds changes, it does not
/// stop a forger. Real-time safe.
class Fnv1a {
 public:
  /// Further bytes, behind all before.
  constexpr void add(std::string_view bytes) noexcept {
    for (const char byte : bytes)
      state_ = (state_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  }
  constexpr std::uint64_t value() const noexcept { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325U;  // the offset basis
};

}  // namespace voxtouch
