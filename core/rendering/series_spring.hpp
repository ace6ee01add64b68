#pragma once
/// The spring between hand and tool, in series with the contact: the tool rests at their
/// equilibrium.
#include <algorithm>
#include <limits>

#include "core/coupling/ramp.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::rendering {

/// Compliance of the spring [m/N, rad/Nm]. 0: rigid, with the tool at the hand.
struct Compliance {
  double translation = 0.0, rotation = 0.0;
  /// Of the spring between hand and position-dependent forces [m/N]: SceneRenderer.
  double effects = 0.0;
  /// Infinite rotation: the device returns no torque, and latched_rotation.hpp limits its rotation.
  bool returns_torque() const noexcept {
    return rotation < std::numeric_limits<double>::infinity();
  }
  bool rigid() const noexcept { return !(translation > 0.0) && !(rotation > 0.0); }
  bool operator==(const Compliance&) const = default;
};

/// A contact at a pose of the tool: wrench on the tool [N, Nm] and -d(wrench)/d(pose), W axes,
/// about the tool's origin.
struct ContactAt {
  Wrench wrench;
  Mat6 stiffness = Mat6::Zero();
};

/// Compliance c of the spring that limits a contact of stiffness `contact` to `cap`. A contact that
/// does not exceed the cap needs no spring: 0. Both in the same unit; the result has the inverse
/// unit.
///     1 / cap = c + 1 / contact
constexpr double compliance_for(double cap, double contact) noexcept {
  return cap > 0.0 && contact > cap ? 1.0 / cap - 1.0 / contact : 0.0;
}

/// Stiffness matrix of `stiffness` in series with the spring, symmetric positive semidefinite if K
/// is. It is at most C^-1 in the order of symmetric matrices, for any K. Real-time safe.
///     (K^-1 + C)^-1 = (1 + K C)^-1 K
Mat6 in_series(const Mat6& stiffness, const Compliance& spring) noexcept;

/// Quasi-static virtual coupling (Wan and McNeely 2003; Barbic and James 2008).
///
/// The hand is at x_d, the massless tool at x_t. The wrench of the spring, w = C^-1 (x_t - x_d),
/// equals that of the contact, W(x_t). Each sample makes one Newton step from the last pose of the
/// tool:
///
///     (1 + K C) w = W(x_t) - K (x_d - x_t),   x_t' = x_d + C w
///
/// The contact is then queried at x_t'. If its wrench differs from w, because the tool has entered
/// or left a contact or the contact is nonlinear, further steps follow, up to kMaxLookups. If that
/// does not converge and two places on both sides of the equilibrium are known, a secant step
/// between them is made, also in the following samples. This converges for a wall that softens and
/// for a contact that steps at the border of a voxel, where the tool stays at the step.
///
/// If the contact's wrench is monotone in the pose, the displayed wrench is the gradient of the
/// Moreau envelope of its potential (Moreau 1965). Its slopes are between 0 and C^-1, and no energy
/// is generated over closed paths. The only state is the tool's pose and the contact there and on
/// the other side of the equilibrium.
class SeriesSpring {
 public:
  /// Duration of a change of the compliance [s].
  static constexpr double kRampS = 0.2;
  static constexpr int kMaxLookups = 4;
  /// Tolerance between contact and spring as a fraction of the wrench, and negligible amounts [N,
  /// Nm].
  static constexpr double kBalance = 0.01, kSettledN = 1e-4, kSettledNm = 1e-6;
  /// Larger displacements of the hand between two samples are jumps: the tool restarts at the hand
  /// [m, rad].
  static constexpr double kJumpM = 0.02, kJumpRad = 0.5;

  /// Sets the compliance for the next samples; at once if there was no sample since `reset`.
  /// Real-time safe.
  void set_target(const Compliance& spring) noexcept;
  bool rigid() const noexcept { return now_.rigid() && goal_.rigid(); }
  /// Begins a sample with the hand at `hand`, `dt_s` [s] after the last. Returns the pose for the
  /// first query of the contact. Real-time safe.
  const Pose& begin(const Pose& hand, double dt_s) noexcept;
  /// Processes the contact at `tool()`. Returns true if it must be queried again at `tool()`, which
  /// has moved. Real-time safe.
  bool settle(const ContactAt& contact) noexcept;
  /// Discards the previous pose: the next sample starts at the hand. Real-time safe.
  void lose() noexcept { known_ = false; }
  void reset() noexcept;

  const Pose& tool() const noexcept { return tool_; }
  /// Wrench of the spring on the hand; for a rigid axis that of the contact.
  const Wrench& wrench() const noexcept { return wrench_; }
  const Compliance& compliance() const noexcept { return now_; }
  int lookups() const noexcept { return lookups_; }  ///< in this sample

 private:
  /// A query pose and the contact there.
  struct Place {
    Pose tool;
    ContactAt contact;
  };
  void predict() noexcept;
  bool between() noexcept;
  Vec3 residual(const Place& place) const noexcept;

  Compliance goal_, now_;
  coupling::Ramp translation_, rotation_;
  bool fresh_ = true, known_ = false;
  bool bracketed_ = false;  ///< the equilibrium is between `last_` and `other_`
  Pose hand_, tool_;
  Place last_, other_;
  Wrench wrench_;
  int lookups_ = 0;
};

}  // namespace voxtouch::rendering
