#pragma once
/// Damping that the coupling adds while the tool touches, and the rule that no addition may turn a
/// push into a pull.
#include "core/coupling/coupling.hpp"
#include "core/coupling/ramp.hpp"

namespace voxtouch::coupling {

/// Where a contact pushes: P = K / lambda_max(K) of one 3x3 block of its stiffness matrix,
/// symmetric with 0 <= P <= I. Across the pushing directions P is zero, so sliding over a plane
/// stays free; a corner is damped both ways. Where the matrix is zero, P is the projector on
/// `push`; where that is zero too, P is zero. Finite inputs. Real-time safe.
Mat3 pushing_directions(const Mat3& stiffness, const Vec3& push) noexcept;

/// Takes the part of `sum` that is against `push` out of it: afterwards push . sum >= 0. Two walls
/// of a corner push as one here; only their common force is kept from pulling. `push` zero: nothing
/// is done. `part`: of that, from 0 to 1. Real-time safe.
void never_pull(Vec3& sum, const Vec3& push, double part = 1.0) noexcept;
/// Where walls push against each other, their common force passes through zero in the middle, and a
/// pull is less push of one of them. That damping then counts only on the way out lets a tool in a
/// slot swing. 0 up to a coherence of 0.2, 1 from 0.5 on.
double one_sided(double coherence) noexcept;

/// Cuts the part of `damping` that is along `push` or across it to a length of at most `most`; what
/// is against `push` stays. Where `push` is zero nothing is left. True where something was cut.
/// Real-time safe.
bool bound_addition(Vec3& damping, const Vec3& push, double most) noexcept;

/// What injected damping adds to the law's wrench, W axes.
struct InjectedWrench {
  Wrench wrench;
  bool bounded = false;  ///< the force exceeded its bound and was cut
};

/// The damping coefficients, which change without a step. The force is -B P v, of which no more
/// than a fraction of the law's force, and a little below perception, is added to that: as the tool
/// touches it begins with the law, and as the tool leaves it ends from what `never_pull` has left
/// of it. The torque is not bounded: it begins with up to B P omega.
class InjectedDamping {
 public:
  /// The dampings of `spec`, as `validate` accepts it [Ns/m, Nms/rad].
  explicit InjectedDamping(const CouplingSpec& spec) noexcept
      : linear_(spec.injected_damping_ns_per_m),
        angular_(spec.injected_damping_nms_per_rad),
        parts_(parts_of(spec)),
        free_(spec.damper_free_n) {}
  /// Goes to the dampings and the force ratio of `spec` over `over_s` > 0. Real-time safe.
  void redesign(const CouplingSpec& spec, double over_s) noexcept {
    linear_.head_for(spec.injected_damping_ns_per_m, over_s);
    angular_.head_for(spec.injected_damping_nms_per_rad, over_s);
    parts_.head_for(parts_of(spec), over_s);
    free_.head_for(spec.damper_free_n, over_s);
  }
  /// Moves on by `dt_s` [s] on that way. Real-time safe.
  void advance(double dt_s) noexcept {
    linear_.advance(dt_s), angular_.advance(dt_s), parts_.advance(dt_s), free_.advance(dt_s);
  }
  /// What to add for `contact`, of which the law gives the force `law_force`, at velocity v^:
  /// nothing where it shows no stiffness at all. Real-time safe.
  InjectedWrench of(const CouplingInput& contact, const Vec3& law_force,
                    const Twist& velocity) const noexcept;

 private:
  static double parts_of(const CouplingSpec& spec) noexcept {
    return spec.damping_force_ratio > 0.0 ? 1.0 / spec.damping_force_ratio : 0.0;
  }

  Ramp linear_, angular_;
  Ramp parts_;  ///< one over the ratio; 0: without a bound
  Ramp free_;   ///< what may be added in addition [N]
};

}  // namespace voxtouch::coupling
