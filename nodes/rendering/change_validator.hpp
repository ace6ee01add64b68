#pragma once
/// What runs and whether a requested change may follow it: no DDS, thread or clock.
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/device_fit/device_compatibility.hpp"
#include "nodes/rendering/pending_changes.hpp"

namespace voxtouch::rendering_node {

/// Judges by its own copy of what the effects are set to, and by the device that was described.
class ChangeValidator {
 public:
  ChangeValidator(const scene::Scene& scene, const rendering::BuiltScene& built);

  /// As read from the file that runs
  const scene::Scene& scene() const noexcept { return scene_; }
  /// As the loop has applied them
  const std::vector<effects::EffectSpec>& effects() const noexcept { return effects_; }
  /// With the bounds of the effects as they are now.
  const rendering::Plan& plan() const noexcept { return plan_; }
  double largest_shell_gap_m() const noexcept { return largest_shell_gap_m_; }
  /// Of all that is rendered now, at most
  const device_fit::SceneRequirements& demand() const noexcept { return demand_; }
  const device_fit::DeviceCompatibility& on_device() const noexcept { return on_device_; }

  /// Why a request cannot be made whatever it asks for; empty: it can. `sample`: the one that is
  /// answered.
  std::string check(const msg::EffectChange& m, std::uint64_t session, std::uint64_t sample,
                    const PendingChanges& pending) const;
  /// The same of what only a reload asks for.
  static std::string check_reload(const msg::EffectChange& m, const PendingChanges& pending);
  /// The changes for the loop, all in one sample, or why not.
  std::expected<std::vector<PendingChange>, std::string> judge(
      std::span<const msg::EffectChange> changes, std::vector<ChangeRequest> requests,
      const PendingChanges& pending);
  /// Why what is pending must not be made on the device that is known now.
  std::string judge(const PendingChanges& pending);
  /// What the effects of a scene read anew begin with, or why it must not follow. Nothing is
  /// pending.
  std::expected<std::vector<effects::EffectSpec>, std::string> judge(const scene::Scene& next,
                                                                     const rendering::Plan& plan);

  void set_device(const coupling::design::DeviceModel& device) { on_device_.device_is(device); }
  /// The coupling is fitted anew where bounds have changed; takes as long as a fit.
  void judge_running();
  // The loop has reported.
  void apply(PendingChange& done);
  void end_fade() { fading_.reset(); }
  void come_to_rest() { reach_ = effects::at_rest(effects_); }
  /// Sums up what the effects show as they are set now. True where that is another thing than
  /// before.
  bool sum_up();

 private:
  /// What will run when all that is pending has been done.
  struct Next {
    const scene::Scene& scene;
    rendering::StiffnessBounds contact_alone;
    std::vector<effects::EffectSpec> effects;
    std::vector<effects::EffectReach> reach;
    void carry_out(const effects::EffectCommand& command);
  };
  Next after(const PendingChanges& pending) const;
  std::string check_device(const Next& next) {
    return on_device_.check(next.scene, next.contact_alone, next.reach);
  }
  void set_plan(const rendering::BuiltScene& built);

  scene::Scene scene_;
  std::vector<effects::EffectSpec> effects_;
  /// Where the effects may be, until they are at rest
  std::vector<effects::EffectReach> reach_;
  std::optional<device_fit::SceneRequirements> fading_;  ///< of the scene that fades out, at most
  device_fit::SceneRequirements demand_;
  device_fit::DeviceCompatibility on_device_;
  rendering::Plan plan_;
  double largest_shell_gap_m_ = 0.0;
};

}  // namespace voxtouch::rendering_node
