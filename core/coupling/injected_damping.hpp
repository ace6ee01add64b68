#pragma once
/// Damping that the coupling injects during contact, and the rule that it never turns a contact
/// force into a pull.
#include "core/coupling/coupling.hpp"
#include "core/coupling/ramp.hpp"

namespace voxtouch::coupling {

/// Directions of the contact force: P = K / lambda_max(K) of one 3x3 block of the stiffness matrix,
/// symmetric with 0 <= P <= I.
/// P is zero across these directions, so sliding over a plane stays free; in a corner both
/// directions are damped. If the matrix is zero, P is the projector on `contact_force`; if that is
/// zero too, P is zero. Requires finite inputs. Real-time safe.
Mat3 contact_directions(const Mat3& stiffness, const Vec3& contact_force) noexcept;

/// Removes from `sum` its component against `contact_force`, so that contact_force . sum >= 0.
/// Two walls of a corner act as one here; only their resultant is kept from pulling. A zero
/// `contact_force` has no effect. `part`: fraction of the component to remove, [0, 1]. Real-time
/// safe.
void never_pull(Vec3& sum, const Vec3& contact_force, double part = 1.0) noexcept;
/// Fraction of the never-pull rule by coherence: 0 up to 0.2, 1 from 0.5 on, smooth between.
/// Between opposite walls the resultant passes through zero, and a pull only reduces the force of
/// one wall. Under the full rule damping would act on the outward path only, so a tool in a slot
/// would oscillate. Real-time safe.
double one_sided(double coherence) noexcept;

/// Limits the part of `damping` that is along or across `contact_force` to the length `most`; the
/// part against `contact_force` is kept. With a zero `contact_force`, all of it is limited to
/// `free`. Returns true if it was limited. Real-time safe.
bool bound_addition(Vec3& damping, const Vec3& contact_force, double most, double free) noexcept;

/// Wrench that injected damping adds to the law's wrench, W axes.
struct InjectedWrench {
  Wrench wrench;
  bool bounded = false;  ///< the force exceeded its bound and was limited
};

/// Injected damping whose coefficients change continuously, W axes:
///
///     force = -B P v,   torque = -B_r P_r omega
///
/// The part of the force that adds to the law's force is limited to a ratio of that force plus a
/// force below perception. It thus begins with the law's force when the tool touches, and
/// `never_pull` ends it when the tool leaves. The torque has no such limit.
class InjectedDamping {
 public:
  /// Takes the dampings of a validated `spec` [Ns/m, Nms/rad].
  explicit InjectedDamping(const CouplingSpec& spec) noexcept
      : linear_(spec.injected_damping_ns_per_m),
        angular_(spec.injected_damping_nms_per_rad),
        parts_(parts_of(spec)),
        free_(spec.damping_force_offset_n) {}
  /// Ramps to the dampings and the force ratio of `spec` over `over_s` > 0 [s]. Real-time safe.
  void redesign(const CouplingSpec& spec, double over_s) noexcept {
    linear_.head_for(spec.injected_damping_ns_per_m, over_s);
    angular_.head_for(spec.injected_damping_nms_per_rad, over_s);
    parts_.head_for(parts_of(spec), over_s);
    free_.head_for(spec.damping_force_offset_n, over_s);
  }
  /// Advances the ramps by `dt_s` [s]. Real-time safe.
  void advance(double dt_s) noexcept {
    linear_.advance(dt_s), angular_.advance(dt_s), parts_.advance(dt_s), free_.advance(dt_s);
  }
  /// The damping wrench for `contact`, the law's force `law_force` and the velocity estimate v^. It
  /// is zero for a contact without stiffness. Real-time safe.
  InjectedWrench of(const CouplingInput& contact, const Vec3& law_force,
                    const Twist& velocity) const noexcept;

 private:
  static double parts_of(const CouplingSpec& spec) noexcept {
    return spec.damping_force_ratio > 0.0 ? 1.0 / spec.damping_force_ratio : 0.0;
  }

  Ramp linear_, angular_;
  Ramp parts_;  ///< inverse of the ratio; 0: no bound
  Ramp free_;   ///< additional force allowed [N]
};

}  // namespace voxtouch::coupling
