#pragma once
/// One interface for all effects: what one sample gives, and what an effect adds to the wrench.
#include <cstdint>
#include <span>

#include "core/contact/contact_model.hpp"
#include "core/effects/effect_kind.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::effects {

/// One static object as the tool meets it this sample.
struct ObjectContact {
  std::uint32_t object = 0;  ///< place in the scene's list of static objects
  const contact::ContactResult* contact = nullptr;
  Twist twist;  ///< of the object, about the tool's origin; zero for one that rests
};

/// The distance to the static surface, smoothed over a length h: twice differentiable but for jumps
/// of the curvature.
struct ProximitySample {
  double distance_m = 0.0;       ///< signed, negative inside; never above what was built for
  Vec3 gradient = Vec3::Zero();  ///< of that distance, W; at most sqrt(3), 1 but for edges
  Mat3 curvature =
      Mat3::Zero();  ///< its second derivatives [1/m], W; symmetric, no norm above 6 / h
};

/// Looks up distances to the static surface. Real-time safe.
class Proximity {
 public:
  virtual ~Proximity() = default;
  /// At `x` in W: wherever the distance is below what was asked for it is right, and continuous
  /// with its gradient; elsewhere it says no more than that it is not below.
  virtual ProximitySample at(const Vec3& x) const noexcept = 0;
};

/// A point that stands for a piece of the tool's surface.
struct ToolPoint {
  Vec3 position = Vec3::Zero();  ///< T
  double fraction = 0.0;         ///< of the tool's area; all of them sum to 1
};

/// The wrench that a program outside the ring requests.
struct ExternalWrench {
  Wrench wrench;  ///< W, torque about the tool's origin; may be anything, also no number
  double taken_s =
      0.0;  ///< time of the first sample that saw it, on the clock of EffectFrame::time_s
};

/// What one sample gives. All in W; points into storage of the caller that lives for the call.
struct EffectFrame {
  Pose tool;                                ///< T in W
  Twist twist;                              ///< of the tool's origin; zero where no effect needs it
  double dt_s = 0.0;                        ///< since the last sample, > 0
  double time_s = 0.0;                      ///< of the sample, since the session began
  std::span<const ObjectContact> contacts;  ///< empty where no effect needs them
  const Proximity* proximity = nullptr;     ///< null where no effect needs it
  std::span<const ToolPoint> tool_points;   ///< empty where `proximity` is null
  const ExternalWrench* external =
      nullptr;  ///< the newest that was taken; null where none was, or no writer is followed
  double fraction =
      1.0;  ///< 0..1, what gain and region leave; of matter to EffectKind::scales_inside
};

/// What the effects of one sample add up to. W axes; torque and stiffness about the tool's origin.
struct EffectForce {
  Wrench wrench;
  Mat6 stiffness = Mat6::Zero();  ///< symmetric positive semidefinite, at least the law's own
  double stiffness_bound_n_per_m = 0.0;  ///< spectral norm of its translational part at most
  double potential_j = 0.0;              ///< conservative kinds only
  double energy_generated_j = 0.0;  ///< since the last sample, by kinds that keep to a budget of
                                    ///< their own; below 0: taken. Gain and region are in it
};

/// An effect's state, if it has any. Its parameters stay with the chain, which moves them smoothly
/// when they are changed.
class Effect {
 public:
  virtual ~Effect() = default;
  /// Adds this effect's part to `push`. Anything that is not finite in `frame` has been refused
  /// before. Real-time safe.
  virtual void apply(const EffectFrame& frame, const EffectValues& values,
                     EffectForce& push) noexcept = 0;
  /// Forgets the past: a new session, a jump that was meant. Real-time safe.
  virtual void reset() noexcept {}
};

}  // namespace voxtouch::effects
