#pragma once
/// The spring-damper coupling, with which the paper compares its filter. Real-time safe.
#include "core/coupling/coupling.hpp"
#include "core/coupling/law_input.hpp"
#include "core/coupling/ramp.hpp"

namespace voxtouch::coupling {

/// The spring-damper law for one vector: a massless object, connected to the device by a spring c
/// and a damper r, is pushed out of the static scene.
///
/// Let delta be the displacement of the object from the pose of the device. The contact is computed
/// at the pose of the device, where its force is f. An object displaced by delta receives, to first
/// order, f - k delta, with k the stiffness bound of the contact. Without mass both forces balance:
///
///     f - k delta = c delta + r delta'
///
/// With the backward difference delta' = (delta - delta_prev)/T, which allows any stiffness at a
/// given step,
///
///     delta = (f + r delta_prev / T) / (k + c + r / T),
///     F     = c delta + r (delta - delta_prev) / T = f - k delta.
///
/// At rest F = c/(c + k) f: two springs in series. The law applies along f. Across f there is no
/// contact force, and the object returns to the device by spring and damper alone. The same holds
/// along f in free space and once the object has left the surface, where F would pull. F never
/// opposes f and is never longer than f.
struct UnilateralSpringDamper {
  Vec3 delta = Vec3::Zero();  ///< [m], W axes
  /// F of one sample, for the contact's force `f` [N or Nm], its stiffness `k`, spring `c` [N/m],
  /// damper `r` [Ns/m] and the period [s]. Real-time safe.
  Vec3 step(const Vec3& f, double k, double c, double r, double dt_s) noexcept;
};

/// Applies the same law, with the same c, r and k, to force and torque. The torque is the sum of
/// (arm x force) over the contact's points, and a law linear in the forces applies to that sum. The
/// torque thus keeps its ratio to the force, without a rotational stiffness to tune.
class SpringDamper {
 public:
  /// Takes c and r of a validated `spec`.
  explicit SpringDamper(const CouplingSpec& spec) noexcept
      : c_(spec.stiffness_n_per_m),
        r_(spec.damping_ns_per_m) {}

  /// One sample of the law for force and torque [N, Nm], W axes, faded in from the start force.
  Wrench step(const LawInput& input) noexcept;
  /// Restarts from the force `start` without a jump.
  void start_at(const Wrench& start) noexcept;
  /// Sets c > 0 and r >= 0 at run time; both ramp linearly over kDefaultRampS.
  void redesign(const CouplingSpec& spec) noexcept;
  /// Displacement of the object from the device [m], W axes.
  const Vec3& object_offset() const noexcept { return force_.delta; }

 private:
  Ramp c_, r_;
  UnilateralSpringDamper force_, torque_;
  Wrench start_;
};

}  // namespace voxtouch::coupling
