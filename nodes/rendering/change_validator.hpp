#pragma once
/// Validates requested changes against the running scene. It uses no DDS, threads or clocks.
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/device_fit/device_compatibility.hpp"
#include "nodes/design_text/design_text.hpp"
#include "nodes/rendering/pending_changes.hpp"

namespace voxtouch::rendering_node {

/// Validates changes against its own copy of the effect settings and the described device.
class ChangeValidator {
 public:
  ChangeValidator(const scene::Scene& scene, const rendering::BuiltScene& built);

  /// As read from the file of the running scene.
  const scene::Scene& scene() const noexcept { return scene_; }
  /// As the loop has applied them.
  const std::vector<effects::EffectSpec>& effects() const noexcept { return effects_; }
  /// With the current bounds of the effects.
  const rendering::Plan& plan() const noexcept { return plan_; }
  double largest_shell_gap_m() const noexcept { return largest_shell_gap_m_; }
  /// Upper bound over everything that is rendered now.
  const device_fit::SceneRequirements& demand() const noexcept { return demand_; }
  const device_fit::DeviceCompatibility& on_device() const noexcept { return on_device_; }

  /// Returns why an effect request is invalid regardless of its values, or an empty text. `sample`
  /// is the one being answered.
  std::string check(const msg::EffectChange& m, std::uint64_t session, std::uint64_t sample,
                    const PendingChanges& pending) const;
  /// The same check for a reload request.
  static std::string check_reload(const msg::EffectChange& m, const PendingChanges& pending);
  /// Returns the changes for the loop, all applied in one sample, or the reason for refusal.
  std::expected<std::vector<PendingChange>, std::string> judge(
      std::span<const msg::EffectChange> changes, std::vector<ChangeRequest> requests,
      const PendingChanges& pending);
  /// Returns why the pending changes are invalid for the current device, or an empty text.
  std::string judge(const PendingChanges& pending);
  /// Returns the initial effect settings of a reloaded scene, or the reason for refusal. Requires
  /// that no change is pending.
  std::expected<std::vector<effects::EffectSpec>, std::string> judge(const scene::Scene& next,
                                                                     const rendering::Plan& plan);

  void set_device(const coupling::design::DeviceModel& device) { on_device_.set_device(device); }
  /// Refits the coupling if bounds have changed. Takes as long as a fit.
  void judge_running();
  // Called when the loop has reported.
  void apply(PendingChange& done);
  void end_fade() { fading_.reset(); }
  void come_to_rest() { reach_ = effects::at_rest(effects_); }
  /// Recomputes the bounds of the effects from their current settings. Returns true if a bound has
  /// changed.
  bool sum_up();

 private:
  /// State after all pending changes have been applied.
  struct Next {
    const scene::Scene& scene;
    rendering::StiffnessBounds contact_alone;
    std::vector<effects::EffectSpec> effects;
    std::vector<effects::EffectReach> reach;
    void carry_out(const effects::EffectCommand& command);
  };
  Next after(const PendingChanges& pending) const;
  std::string check_device(const Next& next) {
    return design_text::sentence_of(on_device_.check(next.scene, next.contact_alone, next.reach));
  }
  void set_plan(const rendering::BuiltScene& built);

  scene::Scene scene_;
  std::vector<effects::EffectSpec> effects_;
  /// Values that the effects may take until their ramps have ended.
  std::vector<effects::EffectReach> reach_;
  /// Of the scene that fades out, upper bound.
  std::optional<device_fit::SceneRequirements> fading_;
  device_fit::SceneRequirements demand_;
  device_fit::DeviceCompatibility on_device_;
  rendering::Plan plan_;
  double largest_shell_gap_m_ = 0.0;
};

}  // namespace voxtouch::rendering_node
