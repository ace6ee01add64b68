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

/// Distance to the static surface, smoothed over a length h. Distance and gradient are continuous;
/// the curvature may jump.
struct ProximitySample {
  double distance_m = 0.0;        ///< negative inside; at most the cut-off of the built field
  Vec3 gradient = Vec3::Zero();   ///< of that distance, W; at most sqrt(3), and 1 away from edges
  Mat3 curvature = Mat3::Zero();  ///< second derivatives [1/m], W; symmetric, norm at most 6 / h
};

/// Distances to the static surface. Real-time safe.
class Proximity {
 public:
  virtual ~Proximity() = default;
  /// Sample at `x` in W [m]. Below the range that the effects of the scene request, the distance is
  /// valid; elsewhere it is only a lower bound.
  virtual ProximitySample at(const Vec3& x) const noexcept = 0;
};

/// A point that represents a part of the tool's surface.
struct ToolPoint {
  Vec3 position = Vec3::Zero();  ///< T
  double fraction = 0.0;         ///< of the tool's area; all sum to 1
};

/// The wrench requested by a program outside the ring.
struct ExternalWrench {
  Wrench wrench;  ///< W, torque about the tool's origin; unchecked, may be NaN
  double taken_s =
      0.0;  ///< time of the first sample that used it, on the clock of EffectFrame::time_s
};

/// Input of one sample, in W. Pointers and spans are valid during the call only.
struct EffectFrame {
  Pose tool;                                ///< T in W
  Twist twist;                              ///< of the tool's origin; zero if no effect needs it
  double dt_s = 0.0;                        ///< since the last sample, > 0
  double time_s = 0.0;                      ///< since the start of the session
  std::span<const ObjectContact> contacts;  ///< empty if no effect needs them
  const Proximity* proximity = nullptr;     ///< null if no effect needs it
  std::span<const ToolPoint> tool_points;   ///< empty if `proximity` is null
  const ExternalWrench* external =
      nullptr;  ///< the newest one received in this session; null if there is none
  double fraction =
      1.0;  ///< product of gain and region weight, 0 to 1; see EffectKind::scales_inside
};

/// Sum of the effects of one sample. W axes; torque and stiffness about the tool's origin.
struct EffectForce {
  Wrench wrench;
  /// At least -d(wrench)/d(pose); symmetric positive semidefinite [N/m, N, Nm/rad].
  Mat6 stiffness = Mat6::Zero();
  /// Upper bound of the spectral norm of its translational part.
  double stiffness_bound_n_per_m = 0.0;
  double potential_j = 0.0;  ///< conservative kinds only
  /// Energy generated since the last sample, for kinds with an energy budget; negative: absorbed.
  /// Includes gain and region.
  double energy_generated_j = 0.0;
};

/// An effect with its state. EffectChain owns its parameters and ramps their changes.
class Effect {
 public:
  virtual ~Effect() = default;
  /// Adds wrench, stiffness and energy to `sum`. All values in `frame` are finite. Real-time safe.
  virtual void apply(const EffectFrame& frame, const EffectValues& values,
                     EffectForce& sum) noexcept = 0;
  /// Clears the state, for a new session or an intended jump. Real-time safe.
  virtual void reset() noexcept {}
};

}  // namespace voxtouch::effects
