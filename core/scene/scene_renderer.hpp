#pragma once
/// One sample of the whole scene: contact, then the effects that the scene lists, then their sum.
#include <optional>
#include <span>

#include "core/contact/contact_renderer.hpp"
#include "core/effects/effect_chain.hpp"
#include "core/scene/device_mapping.hpp"

namespace voxtouch {

/// W axes, torque about the tool's origin.
struct SceneFrame {
  StageResult touch;   ///< contact alone
  EffectPush effects;  ///< effects alone; all zero where the scene lists none
  Wrench wrench;       ///< sum of both
  Mat6 stiffness = Mat6::Zero();
  double stiffness_bound_n_per_m = 0.0;
};

/// One thread at a time. `contact` must outlive it.
class SceneRenderer {
 public:
  /// Time steps that effects are given lie within these: a first sample, or one after a gap, counts as one of `kUsualStepS`.
  static constexpr double kUsualStepS = 0.001, kLeastStepS = 1e-5, kLongestStepS = 0.05;

  SceneRenderer(ContactRenderer& contact, std::vector<EffectSpec> effects)
      : contact_(contact), effects_(std::move(effects)) {}

  /// `time_s` counts from the session's begin. A pose that cannot be looked up gives no force from anything. Real-time safe.
  SceneFrame render(const ToolState& tool, double time_s) noexcept;
  /// Forgets all samples so far.
  void reset() noexcept;

  /// What the effects are given for a sample `step_s` after the last one; points into `contacts`. Real-time safe.
  EffectFrame look(const ToolState& tool, double step_s, double time_s, std::span<const ObjectContact> contacts) const noexcept;

  EffectChain& effects() noexcept { return effects_; }
  const EffectChain& effects() const noexcept { return effects_; }

 private:
  void add_effects(const ToolState& tool, double time_s, SceneFrame& frame) noexcept;

  ContactRenderer& contact_;
  EffectChain effects_;
  std::optional<double> last_s_;
};

}  // namespace voxtouch
