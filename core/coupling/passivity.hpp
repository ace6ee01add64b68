#pragma once
/// Passivity observer and controller in the time domain (Hannaford and Ryu 2002), with accounts
/// along the contact.
///
/// Observer. A force that is held over a period does exactly force . way, so
///
///     E[n] = E[n-1] - f[n-1] . (x[n] - x[n-1])
///
/// is what the hand has put into the coupling, whatever it did in between; E < 0 says that the
/// coupling has given more than it took. f is all that was commanded, the damping of the controller
/// itself too. The device's own damping is not known here and not counted, so the k T/2 of every
/// sampled spring shows as a small debt.
///
/// Accounts. One for the force along the contact's push (normal), one for what is across it
/// (tangential), one for rotation; the first two add up to the whole. World axes would not do: a
/// tool that slides once round a frictionless cylinder of radius R under the force F puts F R/2
/// sin^2 into one axis and takes as much out of the other, 20 mJ for 2 N and 20 mm, and a
/// controller of single axes would brake a contact that loses and gains nothing. Along the contact
/// nothing is exchanged there. One account for all would not do either: drag across the contact
/// would earn a credit that hides an oscillation along it.
///
/// When the contact has ended for kContactEndS its credit is forgotten, so that it cannot hide a
/// later instability; a debt stays for kDebtS, so that a tool that bounces off, with more energy
/// each time, meets a controller that remembers.
///
/// Controller. Where an account is below zero, add -alpha v^, alpha = min(alpha_max, -E / (T
/// v^^2)): at the same velocity that pays the debt back in one period. Its force is never above
/// sqrt(alpha_max |E| / T). It acts along v^ only while the last way is not against it: a velocity
/// that turns late must not push.
///
/// Bound. Let W be the work of the largest force over the longest way of one period. No period
/// costs more than W, since the sum of forces never pulls and is limited. While the tool moves out,
/// v^ agrees and alpha_max does not cut in, a debt D leaves F = max(0, f - D/(T v^)) of the law's
/// force f, so E[n+1] = E[n] - F way >= min(E[n], -f max(T v^, way)) >= min(E[n], -W): the debt is
/// that of one period and does not grow. Each change from in to out adds the periods that v^ needs
/// to turn. For alpha_max from twice the law's negative damping (K k times the lag, for the filter)
/// up to where the device stands it as injected damping, E >= -5 W in all loops of the tests, with
/// an encoder too. Below, the controller only slows the debt down, by alpha_max v^2 each second of
/// (b - alpha_max) v^2: a cycle becomes smaller and stays, and E is as low as the cycle makes it.
/// Above, the controller itself chatters, at tens of W.
///
/// On the velocity of a window v^ may be up to kWindowGain times the largest quotient, and W in
/// this bound is as much larger; E >= -5 W with the W of before was seen to hold in the loops of
/// the tests.
///
/// Sliding. A contact made of voxels gives energy on closed ways of its own: measured over the
/// contact models, voxel sizes, depths and tilts (deploy/pictures/stability_map.png), at most s F L
/// on a way L under the mean force F, s = kSlidingShare e / R for a ball of radius R under
/// `original` and `adapted`, less under `field`. The steps are within W like any force, but they go
/// on as long as the tool slides, and within a voxel the contact gives and takes back up to F e:
/// only observed, E >= -5 W - F e - s F L; with the controller E >= -5 W - F e where alpha_max v >
/// s F, above the speed s F / alpha_max (3 mm/s at 1 N, 5 Ns/m and R = 10 e). Slower, the debt
/// grows with the way by what is left of s F, and goes when the contact ends.
///
/// An encoder step q makes the difference quotient 0 or q/T; v^ keeps a direction between the
/// steps, but of a tool that creeps it has decayed before the next one, so that up to f q a step
/// stays unpaid. The noise of one step is alpha_max (1 - a) q/T, a of v^. E is that of the
/// encoder's motion; the hand's differs by at most q/2 times the sum of the force's changes.
#include "core/coupling/tool_motion.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// A contact has ended when it does not push and the command has been under kRestShare of its
/// largest for this long [s].
inline constexpr double kContactEndS = 0.005, kRestShare = 1e-3;
/// A debt is forgotten when the tool has been free for this long [s].
inline constexpr double kDebtS = 1.0;

/// Largest energy that sliding over voxels gives, over force and way, times the radius of the
/// contact in voxels.
inline constexpr double kSlidingShare = 0.15;

/// How far below zero an account of a sound contact may come, by the bounds above: 5 W and, for
/// what a voxel of edge e gives and takes back, F e. `way_m`: the longest of one period [J].
constexpr double energy_bound_j(double force_n, double way_m, double voxel_m) noexcept {
  return 5.0 * force_n * way_m + force_n * voxel_m;
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

/// Most damping that the controller may add; 0: it only observes.
struct PassivityLimits {
  double linear_ns_per_m = 0.0, angular_nms_per_rad = 0.0;
};

/// What the controller adds now.
struct PassivityDamping {
  Vec3 normal = Vec3::Zero(), tangential = Vec3::Zero();  ///< forces [N], W axes
  Vec3 torque = Vec3::Zero();                             ///< [Nm]
  double linear_ns_per_m = 0.0,
         angular_nms_per_rad = 0.0;  ///< largest alpha of each kind; 0: it rests
};

/// Real-time safe.
class Passivity {
 public:
  /// `nominal_s`: the sample time [s].
  explicit Passivity(double nominal_s) noexcept : nominal_s_(nominal_s) {}

  /// Books what the last command did over `way`, and closes the accounts of a contact that has
  /// ended. `supplied_j`: energy that something with a store of its own (a potential, a moving
  /// object) was free to give in that time, or took back; it goes to the account along the push.
  void observe(const ToolStep& way, bool in_contact, double dt_s, double supplied_j = 0.0) noexcept;
  /// `push`: the contact's force of this sample, for the normal; where it is zero the last normal
  /// stays.
  PassivityDamping control(const Vec3& push, const ToolStep& way, const Twist& velocity,
                           const PassivityLimits& limits) noexcept;
  /// The command of this sample, to be booked with the next way.
  void command(const Wrench& applied) noexcept { applied_ = applied; }
  /// All accounts begin at zero, and no command is waiting to be booked.
  void reset() noexcept;

  const EnergyAccounts& energy() const noexcept { return energy_; }
  const Wrench& applied() const noexcept { return applied_; }

 private:
  bool rests(bool in_contact) noexcept;

  double nominal_s_, rested_s_ = 0.0, most_force_n_ = 0.0, most_torque_nm_ = 0.0;
  Wrench applied_;
  Vec3 normal_ = Vec3::Zero();
  EnergyAccounts energy_;
};

}  // namespace voxtouch::coupling
