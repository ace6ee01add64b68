#pragma once
/// The spring-damper coupling that the paper compares its filter with. Real-time safe.
#include "core/coupling/coupling.hpp"
#include "core/coupling/law_input.hpp"
#include "core/coupling/ramp.hpp"

namespace voxtouch::coupling {

/// One vector's part of the spring-damper's law: a massless object hangs on the device by a spring
/// c and a damper r, and is pushed out of the static scene.
///
/// Let delta be how far the object stands off the device's pose. The contact is computed at the
/// device's pose, where it pushes with f; an object that yields by delta receives less, to first
/// order f - k delta, with k the contact's stiffness bound. It has no mass, so what pushes it is
/// what pulls it back: f - k delta = c delta + r delta'. With the backward difference delta' =
/// (delta - delta_prev)/T, which needs no smaller step for a stiff contact,
///
///     delta = (f + r delta_prev / T) / (k + c + r / T),     F = c delta + r (delta - delta_prev) /
///     T = f - k delta.
///
/// At rest F = c/(c + k) f: two springs in a row. The law holds along f. Across f there is nothing
/// to push with, and the object swings back to the device by spring and damper alone; likewise
/// along f once the object has left the surface (F would pull), and in free space. F is never
/// against f and never longer than f.
struct UnilateralSpringDamper {
  Vec3 delta = Vec3::Zero();
  /// F of one sample for the contact's force `f` [N or Nm], its stiffness `k`, spring `c` [N/m],
  /// damper `r` [Ns/m] and the period [s].
  Vec3 step(const Vec3& f, double k, double c, double r, double dt_s) noexcept;
};

/// Forces and torques take the same law with the same c, r and k: the torque is the sum of (arm x
/// force) over the contact's points, and a law that is linear in the forces acts on that sum as on
/// each of them. The torque thus keeps its proportion to the force, with no rotational stiffness to
/// be tuned.
class SpringDamper {
 public:
  /// c and r of `spec`, as `validate` accepts it.
  explicit SpringDamper(const CouplingSpec& spec) noexcept
      : c_(spec.stiffness_n_per_m),
        r_(spec.damping_ns_per_m) {}

  /// One sample of the law above for force and torque [N, Nm], W axes, faded in from the force
  /// given at the start.
  Wrench step(const LawInput& input) noexcept;
  /// Starts again, giving `start` without a jump.
  void start_at(const Wrench& start) noexcept;
  /// New parameters while running, c > 0 and r >= 0; both go there in a straight line over
  /// kDefaultRampS.
  void redesign(const CouplingSpec& spec) noexcept;
  const Vec3& object_offset() const noexcept {
    return force_.delta;
  }  ///< object relative to the device [m], W

 private:
  Ramp c_, r_;
  UnilateralSpringDamper force_, torque_;
  Wrench start_;
};

}  // namespace voxtouch::coupling
