#pragma once
/// The scene that runs, and the one that takes its place while a hand is in contact.
#include "core/rendering/build.hpp"
#include "core/rendering/latched_rotation.hpp"

namespace voxtouch::rendering {

/// Renders one scene; after `swap_to`, for kFadeS, the old and the new one, and gives (1 - w) old +
/// w new with w on a straight line from 0 to 1. Force, torque, stiffness and its bound are all
/// blended so: a convex sum of symmetric positive semidefinite matrices is one, and the bound stays
/// a bound. Between two samples the blend adds to what each scene does at most |new - old| dt /
/// kFadeS. What cannot be blended (hits, normal, deepest point, model) is taken from the one with
/// more weight.
///
/// On a device that returns no torque, `series_spring` says so, the tool's rotation is the one of
/// latched_rotation.hpp.
///
/// Owns no scene: whoever gave the old one takes it back from `retired`. Costs twice a frame while
/// it fades. Real-time safe.
class LiveScene {
 public:
  static constexpr double kFadeS = 0.2;

  /// `first` must outlive this, or be given back by `retired`.
  explicit LiveScene(BuiltScene& first) noexcept : dominant_(&first), now_(&first) {}

  /// One sample: T in W as the device holds it, `time_s` since the session's begin. Wrenches in N
  /// and Nm, W axes.
  SceneFrame render(const ToolState& tool, double time_s) noexcept;
  /// Not while one is still fading in. Where both have a virtual tool, the next one's begins at the
  /// present one's place, if that is free.
  void swap_to(BuiltScene& next) noexcept;
  /// Of a virtual tool, in all scenes from now on: the spring's stiffness in W [N/m], and that it
  /// is placed anew; see SceneRenderer.
  void set_spring_target(double n_per_m) noexcept;
  /// Without a virtual tool, likewise: the spring in series with the contact; see SceneRenderer.
  void set_series_target(const Compliance& spring) noexcept;
  double spring_n_per_m() const noexcept { return spring_n_per_m_; }
  const Compliance& series_spring() const noexcept { return series_; }
  /// What the effect `external` of every scene follows from the next sample on.
  void external_is(const effects::ExternalWrench& newest) noexcept;
  /// The hand may be anywhere in the next sample; see SceneRenderer.
  void lose_tool() noexcept;
  bool fading() const noexcept { return old_ != nullptr; }
  /// Ends a fade at once, where it is not displayed: no session runs.
  void finish() noexcept;
  /// Forgets all samples so far, and a fade with them: a new session.
  void reset() noexcept;
  /// The scene that is not rendered any more, once; null where there is none.
  BuiltScene* retired() noexcept;

  effects::EffectChain& effects() noexcept {
    return now_->scene_renderer().effects();
  }  ///< of the newest scene
  /// The scene that the last frame's hits, normal and model belong to.
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
  LatchedRotation turn_;
  std::optional<effects::ExternalWrench> external_;
  double last_s_ = -1.0;  ///< time of the last frame; below 0: none
  double supplied_j_ = 0.0, supplied_now_j_ = 0.0,
         supplied_old_j_ = 0.0;  ///< displayed to the hand; by each scene so far
};

}  // namespace voxtouch::rendering
