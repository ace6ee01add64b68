#pragma once
/// Random numbers that are bit-identical results on every machine: the standard library's
/// distributions are not.
#include <cmath>
#include <cstdint>

namespace voxtouch::coupling_models {

/// SplitMix64 (Steele, Lea, Flood 2014) and the distributions that the experiments need. Only
/// integer arithmetic, products and square roots, which IEEE 754 fixes bit-identically; no exp or
/// log.
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed) {}
  /// A separate stream for member `index` of an experiment: one member can be repeated without the
  /// earlier ones.
  Random(std::uint64_t seed, std::uint64_t index) noexcept : state_(seed) {
    state_ = next() ^ (index * 0xd1342543de82ef95u);
    state_ = next();
  }

  std::uint64_t next() noexcept {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  double unit() noexcept { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) noexcept { return low + (high - low) * unit(); }
  bool chance(double probability) noexcept { return unit() < probability; }
  /// 0 .. count - 1; the bias for counts that are no power of two is below 2^-50 for small counts.
  unsigned below(unsigned count) noexcept { return static_cast<unsigned>(unit() * count); }

  /// Every decade equally often; 0 < low <= high. low (high/low)^u with u a 32-bit fraction, by one
  /// square root a bit.
  double log_uniform(double low, double high) noexcept {
    const std::uint64_t bits = next() >> 32;
    double value = low, root = high / low;
    for (int bit = 31; bit >= 0; --bit) {
      root = std::sqrt(root);
      if ((bits >> bit) & 1u)
        value *= root;
    }
    return value;
  }

 private:
  std::uint64_t state_;
};

}  // namespace voxtouch::coupling_models
