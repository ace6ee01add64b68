#pragma once
/// Bounds of an effect while its changes are in progress.
#include <span>
#include <vector>

#include "core/effects/effect_spec.hpp"

namespace voxtouch::effects {

/// All values between past values and goals of an effect. Each number ramps linearly in its own
/// time (EffectChain), so two numbers that change one after the other may occur in any combination.
class EffectReach {
 public:
  /// Starts at rest at the values of `spec`.
  explicit EffectReach(EffectSpec spec)
      : spec_(std::move(spec)),
        low_(spec_.values),
        high_(spec_.values) {}

  /// Adds a goal of the same kind, reached from any present value.
  void widen(const EffectSpec& to);
  /// Adds all values that `to` may reach. Same kind.
  void widen(const EffectReach& to);

  const EffectSpec& spec() const noexcept { return spec_; }  ///< final values
  /// Bound of any state during the ramps, at full gain: the maximum over all combinations of
  /// smallest and largest numbers. It is exact if a kind's bound is monotone in each number, which
  /// a test checks for every kind. Directions and points, on which no bound depends, keep their
  /// last values.
  EffectBound bound() const;

 private:
  EffectSpec spec_;
  EffectValues low_, high_;
};

/// Effects without changes in progress.
std::vector<EffectReach> at_rest(std::span<const EffectSpec> effects);

}  // namespace voxtouch::effects
