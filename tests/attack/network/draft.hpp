#pragma once
/// A datagram in the making: bytes, numbers in RTPS's two orders, and chance of a seed.
#include <cstdint>
#include <random>
#include <utility>

#include "tests/attack/network/neighbours.hpp"

namespace voxtouch::attack {

class Draft {
 public:
  /// The same pair gives the same datagram.
  Draft(std::uint64_t seed, std::uint64_t i)
      : random_((seed + 1) * 0x9e3779b97f4a7c15U ^ (i + 1) * 0xbf58476d1ce4e5b9U) {}

  std::uint64_t any() { return random_(); }
  std::uint64_t below(std::uint64_t n) { return any() % n; }
  bool one_in(std::uint64_t n) { return below(n) == 0; }
  template <std::size_t N, class T>
  T one_of(const T (&choices)[N]) {
    return choices[below(N)];
  }

  void byte(std::uint64_t value) { bytes_.push_back(static_cast<std::uint8_t>(value)); }
  template <class T>
  void number(T value) {  // little endian
    for (std::size_t n = 0; n < sizeof value; ++n)
      byte(static_cast<std::uint64_t>(value) >> (8 * n));
  }
  void noise(std::size_t count) {
    while (count-- > 0)
      byte(any());
  }
  void big_endian(std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
      byte(value >> shift);
  }
  template <class Range>
  void append(const Range& range) {
    bytes_.insert(bytes_.end(), range.begin(), range.end());
  }
  /// Overwrites 16 bits, little endian: a length that is known afterwards.
  void set_length(std::size_t at, std::size_t value) {
    bytes_[at] = static_cast<std::uint8_t>(value),
    bytes_[at + 1] = static_cast<std::uint8_t>(value >> 8);
  }
  std::size_t size() const noexcept { return bytes_.size(); }
  Bytes take() && { return std::move(bytes_); }

 protected:
  Bytes bytes_;

 private:
  std::mt19937_64 random_;
};

}  // namespace voxtouch::attack
