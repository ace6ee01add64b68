#pragma once
/// The dynamic object as a body: it has mass, falls, rests on contacts, and is connected to the
/// tool by a spring while gripped.
#include "core/coupling/ramp.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::effects {

/// Mass properties of the dynamic object for a mass of 1 kg.
struct BodyShape {
  Vec3 centre = Vec3::Zero();          ///< of mass, in T [m]
  Mat3 inertia_m2 = Mat3::Identity();  ///< about the centre of mass, T axes, over the mass [m^2];
                                       ///< positive definite
  double reach_m = 0.0;                ///< farthest point from the origin of T
};

struct BodyParameters {
  double mass_kg = 1.0;
  Vec3 gravity_m_per_s2 = Vec3::Zero();
  double grip_n_per_m = 0.0, grip_nm_per_rad = 0.0;  ///< of the spring between tool and body
  double grip_damping_ratio = 1.0;                   ///< of each mode of that spring with the body
  bool operator==(const BodyParameters&) const = default;
};

/// Damping matrix of a grip at T's origin, T axes [Ns/m, Ns, Nms/rad], with damping ratio z for
/// each mode of mass matrix M and stiffness K:
///
///     D = 2 z M^(1/2) (M^(-1/2) K M^(-1/2))^(1/2) M^(1/2)
///
/// K is that of the grip plus, about the origin, the stiffness of a hanging weight, so that a
/// pendulum motion is damped too. Symmetric positive semidefinite. Real-time safe; takes about ten
/// microseconds.
Mat6 grip_damping(const BodyShape& shape, const BodyParameters& parameters) noexcept;

/// Load on the body at its present pose. W axes, torque about the origin of T.
struct BodyLoad {
  Wrench wrench;
  Mat6 stiffness = Mat6::Zero();  ///< -d(wrench)/d(pose) of it
  /// Stiffness times the velocity of its source, for forces of moving objects: damping is relative
  /// to it.
  Vec6 stiffness_times_velocity = Vec6::Zero();
  double stiffness_bound_n_per_m = 0.0;
};

/// Wrench of the body on the tool. W axes, torque about the tool's origin.
struct BodyGrip {
  Wrench wrench;
  Mat6 stiffness = Mat6::Zero();
  double stiffness_bound_n_per_m = 0.0;
};

/// Motion of the body by semi-implicit Euler, linearly implicit in every spring and damper (Baraff
/// and Witkin 1998). Real-time safe.
///
/// With M the mass matrix at T's origin, K the sum of all stiffness matrices and D the damping,
///
///     (M + h D + h^2 K) v+ = M v + h (w + D v_of_contact),   x+ = x + h v+
///
/// K and D are symmetric and positive semidefinite, so a linear contact of any stiffness is stable
/// at any h. Contact damping is Rayleigh's: D = tau K with tau = 2 zeta sqrt(m / k), k the
/// stiffness bound of the contact. Gyroscopic torque is explicit; speeds are limited to kMaxSpeed
/// and kMaxSpin.
///
/// While gripped, spring and damper (`grip_damping`) pull the body to its grip position on the
/// tool. A new grip takes the body as it lies, without a jump. Its strength ramps over kGripRampS.
///
/// The energy is kinetic + m g h + that of the springs. Its decrease is the energy that the body
/// may give the tool.
class RigidBody {
 public:
  static constexpr double kGripRampS = 0.05, kMaxSpeed = 20.0, kMaxSpin = 200.0,
                          kContactDampingRatio = 0.5;

  /// The body has no pose; `place` must precede the first step.
  explicit RigidBody(const BodyShape& shape) noexcept : shape_(shape) {}

  /// Places the body at `pose`, gripped by a tool at the same pose if `held`.
  void place(const Pose& pose, bool held) noexcept;
  bool placed() const noexcept { return placed_; }
  /// T of the body in W, and the velocity of its origin.
  const Pose& pose() const noexcept { return pose_WB_; }
  const Twist& twist() const noexcept { return twist_; }
  bool held() const noexcept { return held_; }

  /// Makes one step of `dt_s` under `load`, connected to `pose_WT`. `hold`: the tool grips the
  /// body, if it is at most `grab_m` from its last grip position or the body's origin.
  BodyGrip step(const BodyLoad& load, const Pose& pose_WT, const Twist& tool_twist, bool hold,
                double grab_m, const BodyParameters& parameters, double dt_s) noexcept;

  /// Energy after the last step [J]; see above.
  double energy_j() const noexcept { return energy_j_; }
  const BodyShape& shape() const noexcept { return shape_; }

 private:
  void follow_hold(const Pose& pose_WT, bool hold, double grab_m, double dt_s) noexcept;
  void move(double dt_s) noexcept;
  Mat6 damping_W(const BodyParameters& parameters, const Mat3& rotation) noexcept;

  BodyShape shape_;
  BodyParameters damped_;        ///< parameters of `damping_`
  Mat6 damping_ = Mat6::Zero();  ///< of the grip, T axes
  bool damping_known_ = false;
  Pose pose_WB_, pose_TB_;  ///< B: the body; pose_TB_ while gripped
  Twist twist_;
  coupling::Ramp strength_;
  bool placed_ = false, held_ = false;
  double energy_j_ = 0.0;
};

}  // namespace voxtouch::effects
