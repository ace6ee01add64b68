#pragma once
/// Where an effect may be while changes of it are on their way.
#include <span>
#include <vector>

#include "core/effects/effect_spec.hpp"

namespace voxtouch::effects {

/// All values between those that an effect has had and those that it goes to. Each number goes on a
/// straight line in its own time (EffectChain), so that two that change one after the other may
/// meet in any combination.
class EffectReach {
 public:
  /// At rest at the values of `spec`.
  explicit EffectReach(EffectSpec spec)
      : spec_(std::move(spec)),
        low_(spec_.values),
        high_(spec_.values) {}

  /// It goes there as well, from wherever it is. Of the same kind.
  void widen(const EffectSpec& to);
  /// All that `to` may come to is reached as well. Of the same kind.
  void widen(const EffectReach& to);

  const EffectSpec& spec() const noexcept { return spec_; }  ///< where it comes to rest
  /// Of any state on the way, at full gain: the most over all combinations of least and largest
  /// numbers. That is all of it where a kind's bound rises or falls with each number by itself,
  /// which a test holds every kind to. Directions and points, which no bound looks at, stay as they
  /// were last.
  EffectBound bound() const;

 private:
  EffectSpec spec_;
  EffectValues low_, high_;
};

/// Effects that are where they are to be.
std::vector<EffectReach> at_rest(std::span<const EffectSpec> effects);

}  // namespace voxtouch::effects
