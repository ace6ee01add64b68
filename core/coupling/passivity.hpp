#pragma once
/// Passivity observer in the time domain (Hannaford and Ryu 2002), with accounts along the contact.
/// It acts on nothing.
///
/// Observer. A force that is held over a period does exactly force . way, so
///
///     E[n] = E[n-1] - f[n-1] . (x[n] - x[n-1])
///
/// is what the hand has put into the coupling, whatever it did in between; E < 0 says that the
/// coupling has given more than it took. f is all that was commanded. The device's own damping is
/// not known here and not counted, so the k T/2 of every sampled spring shows as a small debt.
///
/// Accounts. One for the force along the contact's push (normal), one for what is across it
/// (tangential), one for rotation; the first two add up to the whole. World axes would not do: a
/// tool that slides once round a frictionless cylinder of radius R under the force F puts F R/2
/// sin^2 into one axis and takes as much out of the other, 20 mJ for 2 N and 20 mm. Along the
/// contact nothing is exchanged there. One account for all would not do either: drag across the
/// contact would earn a credit that hides an oscillation along it.
///
/// When the contact has ended for kContactEndS its credit is forgotten, so that it cannot hide a
/// later instability; a debt stays for kDebtS, so that bounces that give more energy each time add
/// up.
///
/// What a debt says. W is the work of the largest force over the longest path of one period. A
/// sound contact that is pressed and let go owes a few W, for a force that lasts a period is late;
/// a contact of voxels gives and takes back up to F e within one of edge e, and sliding over them
/// gives at most s F L on a path L under the mean force F, s = kSlidingRatio e / R for a ball of
/// radius R under `original` and `adapted`, less under `field` (deploy/pictures/stability_map.png).
/// So a debt is a figure of the run; SwingWatch detects whether a loop swings.
///
/// An encoder hides part of a path: E is that of the encoder's motion, and the hand's differs by at
/// most q/2 times the sum of the force's changes.
#include "core/coupling/tool_motion.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// A contact has ended when it does not push and the command has been under kRestForceRatio of its
/// largest for this long [s].
inline constexpr double kContactEndS = 0.005, kRestForceRatio = 1e-3;
/// A debt is forgotten when the tool has been free for this long [s].
inline constexpr double kDebtS = 1.0;

/// Largest energy that sliding over voxels gives, over force and path, times the radius of the
/// contact in voxels.
inline constexpr double kSlidingRatio = 0.15;

/// How far below zero an account of a sound contact may come, by the bounds above: 5 W and, for
/// what a voxel of edge e gives and takes back, F e. `path_m`: the longest of one period [J].
constexpr double energy_bound_j(double force_n, double path_m, double voxel_m) noexcept {
  return 5.0 * force_n * path_m + force_n * voxel_m;
}
/// Likewise of the rotation's account, on whose points the same voxels push.
constexpr double energy_bound_rotation_j(double torque_nm, double turn_rad, double force_n,
                                         double voxel_m) noexcept {
  return 5.0 * torque_nm * turn_rad + force_n * voxel_m;
}

struct EnergyAccounts {
  double normal_j = 0.0, tangential_j = 0.0, rotation_j = 0.0;
  double translation_j() const noexcept { return normal_j + tangential_j; }
};

/// Real-time safe.
class Passivity {
 public:
  /// Books what the last command did over `step`, and closes the accounts of a contact that has
  /// ended. `supplied_j`: energy that something with a store of its own (a potential, a moving
  /// object) was free to give in that time, or took back; it goes to the account along the push.
  void observe(const ToolStep& step, bool in_contact, double dt_s,
               double supplied_j = 0.0) noexcept;
  /// The command of this sample, to be booked with the next step. `push`: the contact's force, for
  /// the normal; where it is zero the last normal stays.
  void command(const Wrench& applied, const Vec3& push = Vec3::Zero()) noexcept;
  /// All accounts begin at zero, and no command is waiting to be booked.
  void reset() noexcept;

  const EnergyAccounts& energy() const noexcept { return energy_; }
  const Wrench& applied() const noexcept { return applied_; }
  const Vec3& normal() const noexcept {
    return normal_;
  }  ///< of the last push; zero before the first

 private:
  bool rests(bool in_contact) noexcept;

  double rested_s_ = 0.0, most_force_n_ = 0.0, most_torque_nm_ = 0.0;
  Wrench applied_;
  Vec3 normal_ = Vec3::Zero();
  EnergyAccounts energy_;
};

}  // namespace voxtouch::coupling
