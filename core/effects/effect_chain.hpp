#pragma once
/// The scene's effects in the order of its list, each with its region and gain, summed.
#include <memory>
#include <vector>

#include "core/coupling/ramp.hpp"
#include "core/effects/effect.hpp"
#include "core/effects/effect_change.hpp"
#include "core/effects/effect_spec.hpp"

namespace voxtouch::effects {

/// All effects of one tool. The constructor allocates, `apply` does not. One thread at a time.
///
/// Region and gain: a conservative effect of potential U becomes one of potential g w U,
///
///     F = g (w F - U grad w)
///
/// Other wrenches are scaled, so a dissipative effect stays dissipative. Changes: gains and numbers
/// ramp linearly over kEffectRampS, directions along the chord. No change causes a step of the
/// force.
class EffectChain {
 public:
  static constexpr double kEffectRampS = 0.1;

  /// Throws std::invalid_argument with the sentence of check_values for invalid values.
  explicit EffectChain(std::vector<EffectSpec> effects);

  /// Sum over all effects with a gain above zero, always finite. An effect with a non-finite result
  /// is skipped in this sample and counted. Real-time safe.
  EffectForce apply(const EffectFrame& frame) noexcept { return apply(frame, nullptr); }
  /// The same with a virtual tool. Effects that depend on the contact receive `surface`, the tool
  /// at the contact; all others receive `frame`, the tool at the hand. Kinds with a `friction`
  /// function give nothing, since the virtual tool applies the friction. `softened` (optional): the
  /// frame of conservative, contact-independent kinds, which act behind a spring. Real-time safe.
  EffectForce apply(const EffectFrame& frame, const EffectFrame* surface,
                    const EffectFrame* softened = nullptr) noexcept;
  /// Forces of conservative, contact-independent kinds in `frame` with the present gains and
  /// numbers. Has no side effects, so repeated calls give equal results. Real-time safe.
  EffectForce of_position(const EffectFrame& frame) const noexcept;
  /// Sum of the friction coefficients behind their gains and regions, for a tool at `x` in W in
  /// contact with `object`. Real-time safe.
  double friction_at(const Vec3& x, std::uint32_t object) const noexcept;
  /// Clears the state of each effect, for a new session. Gains and values stay. Real-time safe.
  void reset() noexcept;

  std::size_t size() const noexcept { return links_.size(); }
  bool empty() const noexcept { return links_.empty(); }
  const EffectSpec& spec(std::size_t effect) const noexcept { return links_[effect].goal; }
  /// Present values, which ramp to those of the specification.
  const EffectValues& values(std::size_t effect) const noexcept { return links_[effect].now; }
  /// Upper bound of the energy that effects may have generated since construction, over a path of
  /// `metres` [J].
  double max_energy_generated_j(double metres) const noexcept { return per_metre_j_ * metres; }
  /// Applies a command validated by `judge`: a switch, a gain or a parameter. Call it between two
  /// calls of `apply`. Real-time safe.
  void carry_out(const EffectCommand& command) noexcept;

  /// Whether all numbers have reached their goals (gains may still ramp). Real-time safe.
  bool at_rest() const noexcept;

  /// Number of samples in which an effect was not finite, since construction.
  std::uint64_t not_finite() const noexcept { return not_finite_; }

 private:
  struct Link {
    EffectSpec goal;    ///< as requested
    EffectValues now;   ///< ramps to goal.values
    EffectValues rate;  ///< per second, per number
    coupling::Ramp gain;
    std::unique_ptr<Effect> effect;
  };
  static void advance(Link& link, double dt_s) noexcept;
  static void weigh(const Link& link, const RegionWeight& weight, const EffectForce& own,
                    EffectForce& sum) noexcept;

  std::vector<Link> links_;
  double per_metre_j_ = 0.0;  ///< sum over all kinds bounded per metre, at full gain
  std::uint64_t not_finite_ = 0;
};

}  // namespace voxtouch::effects
