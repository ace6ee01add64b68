#pragma once
/// Keeps the stiffness that the coupling is given below a cap, however many points push.
#include "core/coupling/coupling.hpp"
#include "core/coupling/ramp.hpp"
#include "core/coupling/tool_motion.hpp"

namespace voxtouch::coupling {

/// Largest eigenvalue of the symmetric part of a finite matrix; not below zero. The same matrix
/// gives the same bits: nothing is remembered from one to the next. Real-time safe.
double largest_eigenvalue(const Mat3& matrix) noexcept;
double largest_eigenvalue(const Mat6& matrix) noexcept;

/// The largest s <= 1 with s K <= diag(cap_t I, cap_r I) in the order of symmetric matrices:
///
///     s = min(1, 1 / lambda_max(N K N)),   N = diag(1/sqrt(cap_t) I, 1/sqrt(cap_r) I).
///
/// Caps come as their inverses, 0 for none. Where the matrix is zero but `bound` (spectral norm of
/// the translational part) is not, s = min(1, cap_t / bound). Finite inputs; always within [0, 1].
/// Real-time safe.
double cap_scale(const Mat6& stiffness, double bound, double per_cap_t, double per_cap_r) noexcept;

/// What the cap leaves of a contact.
struct CapShares {
  double wrench = 1.0;     ///< of force and torque alike, from `stiffness` to 1
  double stiffness = 1.0;  ///< of the stiffness matrix: s
  Wrench beside = {};      ///< given beside that share, along the push [N, Nm]: what a larger share
                           ///< would give, but would show across the push too
};

/// The cap in time. Real-time safe.
///
/// s falls at once, so that an impact never shows more than the cap. It rises to its value over
/// `ramp_behind_filter_s`: the displayed share of the stiffness, s over what the cap allows, grows
/// no faster than from 0 to 1 in that time.
///
/// What is capped is how the wrench grows, and not the wrench. With s W the hand would get the cap
/// times the points' mean depth, half of the cap's promise under a ball, since a point that comes
/// in with depth zero takes its share of what the others give. Lengths are taken in units of the
/// caps: w = |N W|, u = N W / w, A = N K N; s A <= 1. The share g / w is given, and g begins at
/// zero with the contact and goes on by s times what w has changed, or by s u'Au of what the depth
/// told has changed, as far as the tool's own way says so too, if that is more. So dg <= the cap
/// times the way, and g comes to the cap times the depth, but for what the contact itself lacks
/// until it is as stiff as the cap. Bounds of g:
///
///     s w <= g <= w                    never less than the wrench scaled by s, never more than the
///     wrench itself g <= s u'Au (depth told)         what that depth stands for; let go of over
///     kDefaultRampS where the depth told falls without the wrench
///
/// Across u the direction turns with the whole share, and that too must stay below the cap
/// (share_across). Where g asks for more, the share goes back to s, and g - s w is given beside it,
/// along a direction that does not turn with the contact: what is shown then is s A, along and
/// across. That direction follows the contact's as the hand slides, over kTurnWayM, in a hollow no
/// stiffer than kCapAcross leaves, and what is beside counts by the cosine between the two. It is
/// only what the hand has put in: with E = the work of the hand against g along it, g <= sqrt(2 E),
/// as of a spring as stiff as the cap, or what the share gives without it. Once g is below the
/// bound again the share takes it back over kDefaultRampS.
///
/// Where the model holds its depth (`depth_goes_on`) the wrench tells of the way in only by new
/// points. There g follows s u'A(way) of the tool, by s dw at least and dw at most; and where w
/// falls while the hand goes in, or rises while it goes out, g stays: what it has not fallen on the
/// way in it does not rise by on the way out. Of a way only what is steeper than kSlope against the
/// contact counts: sliding, along which the normals of such models lean to and fro, g goes by s dw.
/// No depth told: s W.
///
/// On the way out g falls as it rose, or by more where s lags: a cycle gives the hand no energy. A
/// jump, a gap or a start is no way: the contact met there has s W, and grows from that.
class StiffnessCap {
 public:
  /// The caps of `spec`, as `validate` accepts it; infinity: none.
  explicit StiffnessCap(const CouplingSpec& spec) noexcept;
  /// New caps. A contact that pushes meanwhile does not jump: from what it shows now the displayed
  /// stiffness goes to what the new caps let it show in a straight line, over kDefaultRampS or
  /// `ramp_behind_filter_s`, whichever is longer, also from or to no cap at all. Slower than the
  /// rise above, because there nothing has to be let go soon, and a stiffness that rises by dk
  /// faster than the tool follows gives the hand up to dk p^2 / 2.
  void redesign(const CouplingSpec& spec) noexcept;
  /// The shares for this sample; `input` as `usable` accepts it, `way` to its pose from the one
  /// before.
  CapShares step(const CouplingInput& input, const ToolStep& way, double dt_s) noexcept;
  /// Nothing pushes: the next contact is scaled at once as it comes.
  void reset() noexcept { scale_ = 1.0, over_ = Ramp(1.0), forget_contact(); }
  /// What was given before is not gone on from: the next contact has s of its wrench, whatever its
  /// depth.
  void forget_contact() noexcept { known_ = false, given_ = size_ = by_depth_ = stored_j_ = 0.0; }

  /// tan of the least angle between a way and the contact's plane that counts as going in or out
  /// where depth is held: 20 degrees.
  static constexpr double kSlope = 0.364;
  /// Ways across the push [m], and turns [rad], over which what is given beside the share follows
  /// the contact's direction.
  static constexpr double kTurnWayM = 0.001, kTurnRad = 0.1;

 private:
  struct Push;
  double step_scale(const CouplingInput& input, double dt_s) noexcept;
  void change_units(double w) noexcept;
  void follow(const Push& push, const ToolStep& way, bool went_on) noexcept;
  double growth(const Push& push, const CouplingInput& input, const ToolStep& way,
                double more) const noexcept;
  double split(const Push& push, double least, double most, const ToolStep& way,
               double dt_s) noexcept;

  double rise_s_, per_cap_t_, per_cap_r_, scale_ = 1.0;
  double allowed_ = 1.0;  ///< s without its rise
  bool redesigned_ = false, units_changed_ = false;
  bool known_ = false;  ///< the last sample is one to go on from
  Ramp over_{1.0};      ///< what is shown, in units of what the new caps allow, on its way to one
  double given_ = 0.0, size_ = 0.0;  ///< g and w of the last sample
  double by_depth_ = 0.0;            ///< the bound by depth, as it was then
  double depth_m_ = 0.0;             ///< as told then
  Vec6 along_ = Vec6::Zero();  ///< direction of what is given beside the share, of length one in
                               ///< units of the caps [1/sqrt(J)]
  double beside_ = 0.0;        ///< its size
  double turning_ =
      1.0;  ///< part of g - s w that is given with the wrench and turns with it; the rest beside
  double stored_j_ =
      0.0;  ///< what the hand has put in along it since the contact began, and not got back
};

/// The largest share of the wrench that may be given across `along`, the wrench's direction, where
/// s of `stiffness` (both in units of the caps; `along` of length one) is shown along it: of the
/// shown matrix s uu'A + share (I - uu')A the symmetric part stays below kCapAcross. From s to
/// infinity. Real-time safe.
double share_across(const Mat6& stiffness, const Vec6& along, double s) noexcept;
/// 2 % over the cap, of a margin of 2: at 1 nothing could be given beside a direction that has all
/// of the cap already.
inline constexpr double kCapAcross = 1.02;

}  // namespace voxtouch::coupling
