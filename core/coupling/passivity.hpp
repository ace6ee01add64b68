#pragma once
/// Passivity observer in the time domain (Hannaford and Ryu 2002), with separate accounts along the
/// contact. It observes only and changes no force.
///
/// A force held over a period does exactly the work force . displacement. The energy that the
/// operator has put into the coupling is
///
///     E[n] = E[n-1] - f[n-1] . (x[n] - x[n-1])
///
/// with f the commanded force. E < 0: the coupling has given more than it received. The device's
/// own damping is not counted, so the k T/2 of every sampled spring appears as a small debt.
///
/// Accounts: the force along the contact normal, the force across it (tangential), and rotation.
/// A slide around a frictionless cylinder would move energy between accounts along the axes of W.
/// In a single account, drag across the contact would earn a credit that hides an oscillation along
/// it.
///
/// Once a contact has ended for kContactEndS its credit is cleared, so that it cannot hide a later
/// instability. A debt is kept for kDebtS, so that bounces with growing energy add up.
///
/// Meaning of a debt. Let W be the work of the largest force over the longest displacement of one
/// period. A stable contact that is pressed and released owes a few W, because a held force is
/// late. A voxel of edge e gives and takes back up to F e. Sliding over voxels gives at most
///
///     s F L,   s = 0.15 e / R
///
/// on a path L under the mean force F, for a ball of radius R under `original` and `adapted`, and
/// less under `field` (deploy/pictures/stability_map.png). A debt is therefore only a figure of the
/// run; SwingWatch detects oscillations.
///
/// Quantisation hides part of a path. E refers to the encoder's motion; for the true motion it
/// differs by at most q/2 times the summed changes of the force.
#include "core/coupling/tool_motion.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// A contact has ended when it exerts no force and the command has been below kRestForceRatio of
/// its largest value for this long [s].
inline constexpr double kContactEndS = 0.005, kRestForceRatio = 1e-3;
/// A debt is cleared when the tool has been in free space for this long [s].
inline constexpr double kDebtS = 1.0;

/// Largest debt of a stable contact's account [J], by the bounds above: 5 W, plus F e for a voxel
/// of edge e. `path_m`: longest displacement of one period [m].
constexpr double energy_bound_j(double force_n, double path_m, double voxel_m) noexcept {
  return 5.0 * force_n * path_m + force_n * voxel_m;
}
/// The same for the rotation account.
constexpr double energy_bound_rotation_j(double torque_nm, double rotation_rad, double force_n,
                                         double voxel_m) noexcept {
  return 5.0 * torque_nm * rotation_rad + force_n * voxel_m;
}

/// Energy from the operator [J]: along the contact normal, across it, and by rotation.
struct EnergyAccounts {
  double normal_j = 0.0, tangential_j = 0.0, rotation_j = 0.0;
  double translation_j() const noexcept { return normal_j + tangential_j; }
};

/// Real-time safe.
class Passivity {
 public:
  /// Adds the work of the last command over `step`, and closes the accounts of a contact that has
  /// ended. `supplied_j`: energy that a source with storage (a potential, a moving object) may have
  /// given in that time, or taken back. It goes to the normal account.
  void observe(const ToolStep& step, bool in_contact, double dt_s,
               double supplied_j = 0.0) noexcept;
  /// Sets the command of this sample, for the work of the next step. `contact_force`: contact
  /// force, which defines the normal; zero keeps the last normal.
  void command(const Wrench& applied, const Vec3& contact_force = Vec3::Zero()) noexcept;
  /// Sets all accounts to zero and discards the last command.
  void reset() noexcept;

  const EnergyAccounts& energy() const noexcept { return energy_; }
  const Wrench& applied() const noexcept { return applied_; }
  /// Direction of the last contact force, unit vector in W; zero if there was none.
  const Vec3& normal() const noexcept { return normal_; }

 private:
  bool rests(bool in_contact) noexcept;

  double rested_s_ = 0.0, most_force_n_ = 0.0, most_torque_nm_ = 0.0;
  Wrench applied_;
  Vec3 normal_ = Vec3::Zero();
  EnergyAccounts energy_;
};

}  // namespace voxtouch::coupling
