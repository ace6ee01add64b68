#pragma once
/// The virtual coupling that fits a device, a hand and a contact, with margins; or what it would
/// take.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/coupling/coupling_spec.hpp"
#include "core/coupling/design/loop_parts.hpp"
#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {

/// Ratios of the contact's force that injected damping may add, in the order in which they are
/// tried, each two to four times the one before: a larger one is a touch that begins harder. With
/// the last one a touch behind a filter still takes four milliseconds to be as hard as without a
/// bound.
inline constexpr std::array kDampingForceRatios{kDefaultDampingForceRatio, 0.7, 2.0, 6.0, 24.0};

/// What is requested; the designer gives up as little of it as it can.
///
/// `auto` takes the shaping filter if it meets the request, and else of all kinds that hold the one
/// that shows most; another than the filter, which smooths the steps of voxels that are crossed,
/// has to show a tenth more.
struct DesignGoals {
  std::string kind = "auto";  ///< auto | shaping_filter | spring_damper | direct
  double cutoff_hz = 5.0;     ///< w0 / (2 pi), the paper's
  double max_cutoff_hz = 200.0;
  double gain_margin = 2.0;                   ///< >= 1
  double useful_stiffness_n_per_m = 50.0;     ///< below it the result is called infeasible
  double useful_stiffness_nm_per_rad = 0.05;  ///< likewise for rotation
  double max_injected_damping_effort = 0.0;   ///< noise of the injected damping at the hand [N]; 0:
                                              ///< 0.05 N or 0.5 % of the device's force, the larger
  double force_layer_depth_m =
      0.0;  ///< depth over which the contact's force grows; for the approach speed. 0: not asked
  DampingFloors floors;  ///< of translation; they go before stiffness, down to the useful least
  DampingFloors rotation_floors{
      0.0, 0.0};  ///< standard: none, since the damping that they ask for is displayed as a torque
  bool allow_injected_damping = true;
  bool velocity_windows = true;  ///< injected damping may act on the velocity of a window too
  std::optional<double>
      damping_force_ratio;  ///< of the spec that is designed; >= 0. None: the first of
                            ///< kDampingForceRatios if it leaves two thirds of what is shown
                            ///< without a bound, else the least that leaves nine tenths, else 0
  bool free_cap =
      false;  ///< the designer may cap the contact's total stiffness instead of scaling all of it
};

struct DesignProblem {
  DeviceModel device;
  OperatorRange hand;
  ContactRange contact;  ///< translation, at the hand [N/m]
  ContactRange
      contact_rotation;  ///< about the tool's origin [Nm/rad]; used if the device gives torque
  DesignGoals goals;
};

enum class DesignStatus : std::uint8_t {
  kAsRequested,
  kBandwidthRaised,
  kDampingAdded,
  kStiffnessReduced,
  kInfeasible
};
/// "as_requested", "bandwidth_raised", "damping_added", "stiffness_reduced", "infeasible".
std::string_view name_of(DesignStatus status) noexcept;

/// One kind of motion, translation or rotation, of a finished design.
struct AxisDesign {
  double injected_damping = 0.0;      ///< while in contact
  VelocityEstimate velocity{0.0, 0};  ///< that it acts on; 0 Hz: none
  double requested_stiffness = 0.0;   ///< min(contact's total, the device's limit)
  double displayed_stiffness = 0.0;   ///< K k that is certified with the margin; <= requested
  double critical_stiffness = 0.0;    ///< K k at which the worst case becomes unstable
  double gain_margin = 0.0;           ///< critical / shown
  LoopPlant worst_case;               ///< where that is
  std::string worst_case_text;        ///< "released, 0.2 kg", for a person
  /// Rule P holds (spring-damper: the discrete Llewellyn condition): stable with any passive hand,
  /// not only with the range given.
  bool passive = false;
  double passive_stiffness = 0.0;  ///< K k that rule P would allow
  double spectral_radius = 0.0;    ///< at margin * shown, over all cases; < 1
  double limit_cycle_bound =
      0.0;  ///< peak to peak of what quantisation may leave [m] or [rad]; 0: friction removes it
  double damping_required =
      0.0;  ///< device damping with which the goal would be passive as it is, margin included
  double damping_required_any_cutoff = 0.0;  ///< the same with the highest cut-off that may be
};

/// The least damping ratio of the slowest swing (`slowest_damping_ratio`) over the cases of a
/// design, both kinds of motion and both timings.
struct DominantMode {
  double released = 1.0, held = 1.0;  ///< 1 where no case is of that kind
  std::string released_where,
      held_where;  ///< "Translation: held (0.2 kg, 0.5 Ns/m, 800 N/m), 0.08 kg", for a person
};

/// What came of the goals' floors.
struct FloorsKept {
  /// Of translation, as they are kept. 0: none was asked for, or what keeps them would show less
  /// than is useful; the design is as it would be without.
  double released = 0.0, held = 0.0;
  double cost_n_per_m = 0.0,
         cost_nm_per_rad =
             0.0;  ///< of what is shown without them; below 0 where it is more with them
  /// The worst case that swings with less in the softest useful contact, whatever is injected: no
  /// coupling of that kind reaches its floor, which was left out for all hands, or for all released
  /// devices. Empty: there is none.
  std::string out_of_reach;
};

/// A finished design.
///
/// The spec's caps are what the certificates rest on: with a device that gives force and torque
/// they keep the contact's stiffness, as a matrix, below both axes' certified values at once.
/// Without a free cap they stand at the contact's own totals, which they then leave as they are for
/// force alone.
struct Design {
  DesignStatus status = DesignStatus::kInfeasible;
  CouplingSpec spec;  ///< what to run: kind, cut-off, damping ratio, gain, cap, injected damping
  AxisDesign translation, rotation;  ///< rotation is all zero for a device without torque
  DominantMode swing;                ///< how it comes to rest
  FloorsKept floors;                 ///< nothing, where the parameters were given
  double lag_s = 0.0;                ///< 2 d / w0
  /// Fastest approach that stays within the force layer, stopped by one point alone; a hand that
  /// goes on pushing takes force / (K k) of the depth beforehand. 0: not asked.
  double max_approach_m_per_s = 0.0;
  std::vector<std::string> reasons;   ///< what limits, one sentence each
  std::vector<std::string> remedies;  ///< what it would take to have the goal as it is: damping,
                                      ///< delay, cap; empty if it is met
};

/// "a filter of 100 Hz", "a window of 12 samples", for a person.
std::string describe(const VelocityEstimate& velocity);
/// "adds at most 0.35 of what contact and effects give, and 0.05 N", of the injected damping of
/// `spec`, for a person. Empty where it is not bounded.
std::string describe_bound(const CouplingSpec& spec);
/// "acts on the velocity of a filter of 16 Hz within 5.4 mm/s, which may be the encoder's steps",
/// likewise. Empty where it acts on no slow velocity.
std::string describe_slow_velocity(const CouplingSpec& spec);

/// Pure arithmetic, 0.04 to 0.25 s of processor time for the devices here, up to half a second with
/// long delays; not for the loop. The same request gives bit-identical results. Throws
/// std::invalid_argument with the first sentence of `check` for numbers that cannot be designed
/// for.
Design design_coupling(const DesignProblem& request);

/// The design's judgement of parameters that were given: same certificates, nothing
/// changed. `status` is kAsRequested where they hold and kInfeasible where not; `reasons` says why.
Design judge_coupling(const DesignProblem& request, const CouplingSpec& spec);

}  // namespace voxtouch::coupling::design
