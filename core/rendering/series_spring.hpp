#pragma once
/// The spring between hand and tool, in series with the contact: the tool rests where both balance.
#include <algorithm>
#include <limits>

#include "core/coupling/ramp.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::rendering {

/// What the spring gives way by [m/N, rad/Nm]. 0: it is rigid, and the tool is where the hand is.
struct Compliance {
  double translation = 0.0, rotation = 0.0;
  double effects = 0.0;  ///< of the spring between hand and forces of position [m/N]: SceneRenderer
  /// Infinite rotation: the device returns no torque, and latched_rotation.hpp has what its
  /// rotation does.
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

/// Of a spring that stands for the contact: no stiffer than `cap` where the contact itself is no
/// stiffer than `contact`. One that is no stiffer than the cap needs no spring: 0. Both in the same
/// unit; the inverse of that unit comes out.
///
///     1 / cap = c + 1 / contact
constexpr double compliance_for(double cap, double contact) noexcept {
  return cap > 0.0 && contact > cap ? 1.0 / cap - 1.0 / contact : 0.0;
}

/// The matrix of `stiffness` and the spring in a row, (K^-1 + C)^-1 = (1 + K C)^-1 K: at most C^-1
/// in the order of symmetric matrices, whatever K is. Symmetric positive semidefinite if K is.
/// Real-time safe.
Mat6 in_series(const Mat6& stiffness, const Compliance& spring) noexcept;

/// Quasi-static virtual coupling (Wan and McNeely 2003; Barbic and James 2008). The hand is at x_d,
/// the tool at x_t without mass: the spring's wrench w = C^-1 (x_t - x_d) is the contact's, W(x_t).
/// One Newton step a sample from the last tool pose:
///
///     (1 + K C) w = W(x_t) - K (x_d - x_t),    x_t' = x_d + C w.
///
/// The contact is then looked up at x_t'. Where it gives something else than w there, for the tool
/// has come into a contact, has left one, or the contact is not linear, another step goes on from
/// there, up to kMaxLookups. Where that does not settle it and two places are known on both sides
/// of the balance, the step is the secant's between them, in the samples that follow too: a wall
/// that softens is settled on, and so is a contact that steps at the border of a voxel, which holds
/// the tool at the step.
///
/// Where the contact's wrench is monotone in the pose the displayed wrench is the gradient of the
/// Moreau envelope of its potential (Moreau 1965): slopes from 0 to C^-1, no energy given over
/// closed paths. Nothing else is stored than the tool's pose and what the contact gave there, and
/// on the other side of the balance.
class SeriesSpring {
 public:
  /// Over this time the spring goes from one compliance to the next [s].
  static constexpr double kRampS = 0.2;
  static constexpr int kMaxLookups = 4;
  /// Part of the wrench by which the contact may differ from it, and what is no matter [N, Nm].
  static constexpr double kBalance = 0.01, kSettledN = 1e-4, kSettledNm = 1e-6;
  /// Displacements of the hand from one sample to the next that are no motion: the tool begins at
  /// the hand anew [m, rad].
  static constexpr double kJumpM = 0.02, kJumpRad = 0.5;

  /// The compliance from the next samples on; at once where there was no sample since `reset`.
  /// Real-time safe.
  void set_target(const Compliance& spring) noexcept;
  bool rigid() const noexcept { return now_.rigid() && goal_.rigid(); }
  /// Begins a sample of the hand at `hand`, `dt_s` after the last: where to look up the contact
  /// first. Real-time safe.
  const Pose& begin(const Pose& hand, double dt_s) noexcept;
  /// What the contact is at `tool()`. True: it is to be looked up once more, at `tool()`, which has
  /// moved. Real-time safe.
  bool settle(const ContactAt& contact) noexcept;
  /// There is nothing to go on from: the next sample begins at the hand. Real-time safe.
  void lose() noexcept { known_ = false; }
  void reset() noexcept;

  const Pose& tool() const noexcept { return tool_; }
  /// The spring's wrench on the hand; of a rigid axis the contact's.
  const Wrench& wrench() const noexcept { return wrench_; }
  const Compliance& compliance() const noexcept { return now_; }
  int lookups() const noexcept { return lookups_; }  ///< of this sample

 private:
  /// Where the contact was looked up, and what it gave.
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
  bool bracketed_ = false;  ///< the balance is between `last_` and `other_`
  Pose hand_, tool_;
  Place last_, other_;
  Wrench wrench_;
  int lookups_ = 0;
};

}  // namespace voxtouch::rendering
