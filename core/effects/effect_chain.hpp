#pragma once
/// The scene's effects in the order of its list: each behind its region and gain, all summed.
#include <memory>
#include <vector>

#include "core/coupling/ramp.hpp"
#include "core/effects/effect.hpp"
#include "core/effects/effect_change.hpp"
#include "core/effects/effect_spec.hpp"

namespace voxtouch::effects {

/// All effects of one tool. Construction allocates, `apply` does not. One thread at a time.
///
/// Region and gain: a conservative effect of potential U becomes one of potential g w U, F = g (w F
/// - U grad w). The wrench of any other is scaled, so a dissipative one stays dissipative. Change:
/// gains and numbers go to their new value on a straight line over kEffectRampS, directions on the
/// chord. No change is a force step.
class EffectChain {
 public:
  static constexpr double kEffectRampS = 0.1;

  /// Throws std::invalid_argument with the sentence of check_values for values that cannot be used.
  explicit EffectChain(std::vector<EffectSpec> effects);

  /// Sum over all effects with a gain above zero. Never a number that is not finite: an effect that
  /// gives one is left out of this sample and counted. Real-time safe.
  EffectForce apply(const EffectFrame& frame) noexcept { return apply(frame, nullptr); }
  /// The same next to a virtual tool: kinds that feel the contact are given `surface`, the tool
  /// where it touches, all others `frame`, the tool at the hand. Kinds with a `friction` of their
  /// own give nothing: the virtual tool rubs. Real-time safe. `softened`: not null, for what a
  /// spring of its own softens: conservative kinds that do not feel the contact.
  EffectForce apply(const EffectFrame& frame, const EffectFrame* surface,
                    const EffectFrame* softened = nullptr) noexcept;
  /// What conservative kinds that do not feel the contact give in `frame`, gains and numbers as
  /// they are: the same as often as it is asked. Real-time safe.
  EffectForce of_position(const EffectFrame& frame) const noexcept;
  /// Sum of the coefficients of such kinds behind their gains and regions, for a tool at `x` in W
  /// that touches `object`. Real-time safe.
  double friction_at(const Vec3& x, std::uint32_t object) const noexcept;
  /// Each effect forgets what it remembers, as for a new session. Gains and values stay. Real-time
  /// safe.
  void reset() noexcept;

  std::size_t size() const noexcept { return links_.size(); }
  bool empty() const noexcept { return links_.empty(); }
  const EffectSpec& spec(std::size_t effect) const noexcept { return links_[effect].goal; }
  /// As they are now, on their way to what the spec says.
  const EffectValues& values(std::size_t effect) const noexcept { return links_[effect].now; }
  /// Energy that kinds which may give some were free to give since the chain was made, over a path
  /// of `metres` [J].
  double given_over(double metres) const noexcept { return per_metre_j_ * metres; }
  /// What `judge` has found good: a switch, a gain or a parameter. Between two calls of `apply`.
  /// Real-time safe.
  void carry_out(const EffectCommand& command) noexcept;

  /// All numbers have come to where they were to go (gains may still be on their way). Real-time
  /// safe.
  bool at_rest() const noexcept;

  /// Samples of effects that gave a number that is none, since the chain was made.
  std::uint64_t not_finite() const noexcept { return not_finite_; }

 private:
  struct Link {
    EffectSpec goal;    ///< as asked for
    EffectValues now;   ///< on their way to goal.values
    EffectValues rate;  ///< per second, per number
    coupling::Ramp gain;
    std::unique_ptr<Effect> effect;
  };
  static void advance(Link& link, double dt_s) noexcept;
  static void weigh(const Link& link, const RegionWeight& weight, const EffectForce& own,
                    EffectForce& sum) noexcept;

  std::vector<Link> links_;
  double per_metre_j_ = 0.0;  ///< by all kinds that are bounded per metre, at full gain
  std::uint64_t not_finite_ = 0;
};

}  // namespace voxtouch::effects
