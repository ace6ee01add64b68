#pragma once
/// Common interface of all effects: the input of one sample, and the wrench that an effect adds.
#include <cstdint>
#include <span>

#include "core/contact/contact_model.hpp"
#include "core/effects/effect_kind.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::effects {

/// The contact of one static object with the tool in this sample.
struct ObjectContact {
  std::uint32_t object = 0;  ///< index in the scene's list of static objects
  const contact::ContactResult* contact = nullptr;
  Twist twist;  ///< of the object, about the tool's origin; zero at rest
};

/// Distance to the static surface, smoothed over a length h: twice differentiable except for jumps
/// of the curvature.
struct ProximitySample {
  double distance_m = 0.0;        ///< signed, negative inside; never above the built range
  Vec3 gradient = Vec3::Zero();   ///< of that distance, W; at most sqrt(3), and 1 away from edges
  Mat3 curvature = Mat3::Zero();  ///< second derivatives [1/m], W; symmetric, norm at most 6 / h
};

/// Distances to the static surface. Real-time safe.
class Proximity {
 public:
  virtual ~Proximity() = default;
  /// Sample at `x` in W. Below the requested range the distance is valid and continuous with its
  /// gradient. Elsewhere it is only a lower bound.
  virtual ProximitySample at(const Vec3& x) const noexcept = 0;
};

/// A point that represents a part of the tool's surface.
struct ToolPoint {
  Vec3 position = Vec3::Zero();  ///< T
  double fraction = 0.0;         ///< of the tool's area; the fractions sum to 1
};

/// The wrench requested by a program outside the ring.
struct ExternalWrench {
  Wrench wrench;  ///< W, torque about the tool's origin; unchecked, may be NaN
  double taken_s =
      0.0;  ///< time of the first sample that used it, on the clock of EffectFrame::time_s
};

/// Input of one sample, in W. Refers to storage of the caller that is valid during the call.
struct EffectFrame {
  Pose tool;                                ///< T in W
  Twist twist;                              ///< of the tool's origin; zero if no effect needs it
  double dt_s = 0.0;                        ///< since the last sample, > 0
  double time_s = 0.0;                      ///< of the sample, since the start of the session
  std::span<const ObjectContact> contacts;  ///< empty if no effect needs them
  const Proximity* proximity = nullptr;     ///< null if no effect needs it
  std::span<const ToolPoint> tool_points;   ///< empty if `proximity` is null
  const ExternalWrench* external =
      nullptr;  ///< the newest one taken; null without one, or if no writer is followed
  double fraction =
      1.0;  ///< 0..1, remaining after gain and region; used by EffectKind::scales_inside
};

/// Sum of the effects of one sample. W axes; torque and stiffness about the tool's origin.
struct EffectForce {
  Wrench wrench;
  /// Symmetric positive semidefinite, at least that of the force law.
  Mat6 stiffness = Mat6::Zero();
  /// Upper bound of the spectral norm of its translational part.
  double stiffness_bound_n_per_m = 0.0;
  double potential_j = 0.0;  ///< conservative kinds only
  /// Energy generated since the last sample, for kinds with an energy budget; negative: absorbed.
  /// Includes gain and region.
  double energy_generated_j = 0.0;
};

/// State of an effect, if it has any. The chain owns its parameters and ramps them when they
/// change.
class Effect {
 public:
  virtual ~Effect() = default;
  /// Adds this effect's wrench to `push`. All values in `frame` are finite. Real-time safe.
  virtual void apply(const EffectFrame& frame, const EffectValues& values,
                     EffectForce& push) noexcept = 0;
  /// Clears the state, for a new session or an intended jump. Real-time safe.
  virtual void reset() noexcept {}
};

}  // namespace voxtouch::effects
