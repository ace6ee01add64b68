#pragma once
/// The running scene, and its replacement during contact.
#include "core/rendering/build.hpp"
#include "core/rendering/latched_rotation.hpp"

namespace voxtouch::rendering {

/// Renders one scene. After `swap_to` it renders the old and the new scene for kFadeS and blends
/// them:
///
///     (1 - w) old + w new,   w linear from 0 to 1
///
/// Force, torque, stiffness and its bound are all blended. A convex sum of symmetric positive
/// semidefinite matrices is one too, and the bound remains a bound. Between two samples, the blend
/// changes the result by at most |new - old| dt / kFadeS in addition to the change of each scene.
/// Values that cannot be blended (hits, normal, deepest point, model) are taken from the scene with
/// the larger weight.
///
/// For a device without torque, as given by `series_spring`, the tool's rotation is that of
/// latched_rotation.hpp.
///
/// Owns no scene: the owner takes the old one back by `retired`. A frame costs twice as much during
/// the fade. Real-time safe.
class LiveScene {
 public:
  static constexpr double kFadeS = 0.2;

  /// `first` must outlive this object, or be returned by `retired`.
  explicit LiveScene(BuiltScene& first) noexcept : dominant_(&first), now_(&first) {}

  /// Renders one sample: T in W from the device, `time_s` since the start of the session. Wrenches
  /// in N and Nm, W axes.
  SceneFrame render(const ToolState& tool, double time_s) noexcept;
  /// Starts a fade to `next`. Must not be called during a fade. If both scenes have a virtual tool,
  /// the new one starts at the pose of the present one, if that is free.
  void swap_to(BuiltScene& next) noexcept;
  /// With a virtual tool, in all scenes from now on: sets the stiffness of the spring in W [N/m];
  /// see SceneRenderer.
  void set_spring_target(double n_per_m) noexcept;
  /// Without a virtual tool, in all scenes from now on: sets the spring in series with the contact;
  /// see SceneRenderer.
  void set_series_target(const Compliance& spring) noexcept;
  double spring_n_per_m() const noexcept { return spring_n_per_m_; }
  const Compliance& series_spring() const noexcept { return series_; }
  /// Sets the wrench that the effect `external` of every scene follows from the next sample on.
  void set_external_wrench(const effects::ExternalWrench& newest) noexcept;
  /// The hand may be anywhere in the next sample; see SceneRenderer.
  void reset_virtual_tool() noexcept;
  bool fading() const noexcept { return old_ != nullptr; }
  /// Ends a fade at once, when no session runs and no force is displayed.
  void finish() noexcept;
  /// Forgets all samples and ends a fade, for a new session.
  void reset() noexcept;
  /// Returns the scene that has been replaced, once; null without one.
  BuiltScene* retired() noexcept;

  /// Of the newest scene.
  effects::EffectChain& effects() noexcept { return now_->scene_renderer().effects(); }
  /// The scene that the hits, normal and model of the last frame belong to.
  BuiltScene& dominant() noexcept { return *dominant_; }

 private:
  SceneFrame render_scenes(const ToolState& tool, double time_s) noexcept;
  void advance(double time_s) noexcept;

  BuiltScene* dominant_;
  BuiltScene* now_;
  BuiltScene* old_ = nullptr;  ///< fading out
  BuiltScene* retired_ = nullptr;
  double weight_ = 1.0;  ///< of now_
  double spring_n_per_m_ = 0.0;
  Compliance series_;
  LatchedRotation latched_rotation_;
  std::optional<effects::ExternalWrench> external_;
  double last_s_ = -1.0;  ///< time of the last frame; negative: none
  double supplied_j_ = 0.0, supplied_now_j_ = 0.0,
         supplied_old_j_ = 0.0;  ///< displayed to the operator; then of each scene so far
};

}  // namespace voxtouch::rendering
