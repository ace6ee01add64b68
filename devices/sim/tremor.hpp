#pragma once
/// The unsteadiness of a hand: random, but the same for the same seed on every machine.
#include <cstdint>
#include <random>

#include "core/types/geometry.hpp"

namespace voxtouch::sim {

/// A random number close to normal, of variance one: twelve uniforms less six.
/// std::normal_distribution differs between libraries, and the usual transforms call a logarithm.
/// Real-time safe.
double near_normal(std::mt19937_64& random) noexcept;

/// A force of given standard deviation on each axis through a first-order low-pass; it starts at
/// zero. Real-time safe.
class Tremor {
 public:
  /// `sigma_n` [N] 0: no force, and no random number is drawn. `bandwidth_hz`: corner of the
  /// low-pass. `period_s`: time between calls.
  Tremor(double sigma_n, double bandwidth_hz, double period_s, std::uint64_t seed);
  /// The force over the next period [N].
  Vec3 next() noexcept;

 private:
  double sigma_n_, keep_, gain_;
  std::mt19937_64 random_;
  Vec3 force_ = Vec3::Zero();
};

}  // namespace voxtouch::sim
