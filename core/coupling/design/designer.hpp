#pragma once
/// Designs the virtual coupling for a device, a hand and a contact, with margins.
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

/// Ratios of the contact force that injected damping may add, in the order of trial. A larger ratio
/// makes a touch begin harder.
inline constexpr std::array kDampingForceRatios{kDefaultDampingForceRatio, 0.7, 2.0, 6.0, 24.0};

/// The requested properties of a design. The designer reduces them as little as possible.
///
/// `auto` selects the shaping filter if it meets the request, otherwise the kind with the largest
/// displayed stiffness. A kind other than the filter must display a tenth more, because only the
/// filter smooths the steps between voxels.
struct DesignGoals {
  std::string kind = "auto";  ///< auto | shaping_filter | spring_damper | direct
  double cutoff_hz = 5.0;     ///< w0 / (2 pi), as in the paper
  double max_cutoff_hz = 200.0;
  double gain_margin = 2.0;  ///< >= 1
  /// Depth over which the contact force rises, for the approach speed; 0: not computed.
  double force_layer_depth_m = 0.0;
  /// Of translation; stiffness is reduced for them, down to the useful minimum.
  MinDampingRatios min_damping;
  MinDampingRatios rotation_min_damping{0.0, 0.0};  ///< its damping is displayed as a torque
  bool allow_injected_damping = true;
  bool velocity_windows = true;  ///< injected damping may also act on the velocity of a window
  std::optional<double>
      damping_force_ratio;  ///< Of the designed specification, >= 0. Unset: the smallest candidate
                            ///< of kDampingForceRatios that keeps at least 2/3 (first) or 9/10
                            ///< (others) of the unbounded stiffness; 0 if none does.
  /// The designer may cap the total contact stiffness instead of scaling all of it.
  bool free_cap = false;
};

struct DesignProblem {
  DeviceModel device;
  OperatorRange hand;
  ContactRange contact;  ///< translation, at the hand [N/m]
  /// About the tool's origin [Nm/rad]; used if the device gives torque.
  ContactRange contact_rotation;
  DesignGoals goals;
};

enum class DesignStatus : std::uint8_t {
  kAsRequested,
  kBandwidthRaised,
  kDampingAdded,
  kStiffnessReduced,
  kInfeasible
};
/// For example "as_requested".
std::string_view name_of(DesignStatus status) noexcept;

/// Design of one kind of motion, translation or rotation.
struct AxisDesign {
  double injected_damping = 0.0;      ///< during contact
  VelocityEstimate velocity{0.0, 0};  ///< estimate that it acts on; 0 Hz: none
  double requested_stiffness = 0.0;   ///< min(contact's total, the device's limit)
  double displayed_stiffness = 0.0;   ///< K k certified with the margin; <= requested
  double critical_stiffness = 0.0;    ///< K k at which the worst case becomes unstable
  double gain_margin = 0.0;           ///< critical / displayed
  LoopCase worst_case;                ///< case of the critical stiffness
  bool any_passive_hand = false;      ///< certified for any passive hand instead of a list of cases
  /// Rule P holds (spring-damper: the discrete Llewellyn condition): stable with any passive hand,
  /// not only with the given range.
  bool passive = false;
  double passive_stiffness = 0.0;  ///< K k allowed by rule P
  double spectral_radius = 0.0;    ///< at margin * displayed, over all cases; < 1
  /// Peak-to-peak limit cycle from quantisation [m] or [rad]; 0: friction removes it.
  double limit_cycle_bound = 0.0;
  /// Device damping with which the goal would be passive, margin included.
  double damping_required = 0.0;
};

/// A damping ratio of the dominant mode (`slowest_damping_ratio`) and its case.
struct LeastDamping {
  double ratio = 1.0;    ///< 1: no case
  std::size_t axis = 0;  ///< 0: translation, 1: rotation
  LoopCase where;
};
/// The smallest over the cases of a design, both kinds of motion and both timings.
struct DominantMode {
  LeastDamping released, gripped;
};

/// Result for the minimum damping ratios of the goals.
struct MinDampingResult {
  /// Minimum of translation that the design meets. 0: none was requested, or meeting it would leave
  /// less than the useful stiffness; the design then ignores it.
  double released = 0.0, gripped = 0.0;
  double cost_n_per_m = 0.0,
         cost_nm_per_rad =
             0.0;  ///< loss of displayed stiffness; negative if it is larger with the minimum
  /// The worst case that no injected damping brings to its minimum in the softest useful contact;
  /// see `set_min_damping`.
  LeastDamping out_of_reach;
};

/// What limits a design, or why given parameters are not certified. The comments name `values` of
/// DesignReason; the Design has the others.
enum class DesignLimit : std::uint8_t {
  kNoStableStiffness,
  kEncoderStep,  ///< step, limit of its effort, dry friction
  kPassiveHand,
  kMinDampingRatio,
  kStability,
  kDeviceStiffness,    ///< of the device, of all contact points
  kInjectedDamping,    ///< stable stiffness without and with its bound; 0: the bound costs nothing
  kFilterLag,          ///< requested cut-off [Hz], stiffness that it allows on each axis
  kMinDampingCost,     ///< stiffness that the minimum damping ratios cost on each axis; 0: none
  kMinDampingDropped,  ///< requested minimum, released and gripped
  kWithoutFilter,      ///< displayed over requested stiffness without and with filter
  kDampingForceRatio,  ///< ratio, default; displayed over requested: default, ratio, no bound
  kNoDampingForceRatio,  ///< ratio, displayed over requested with it and without bound; largest
                         ///< ratio and the same with it, 0: one ratio only
  kGainMargin,           ///< required margin
  kSlowestMode,          ///< spectral radius
  kDisplayedStiffness,   ///< limit of the device
  kDampingPassiveHand,
  kDampingLimit,  ///< largest injected damping
  kSlowVelocity,  ///< ratio of the margin to keep
};
struct DesignReason {
  DesignLimit what{};
  std::size_t axis = 0;  ///< 0: translation, 1: rotation
  std::array<double, 5> values{};
  bool operator==(const DesignReason&) const = default;
};

/// A finished design.
///
/// The certificates depend on the caps of the specification. For a device with force and torque,
/// they keep the contact stiffness, as a matrix, below the certified values of both axes at once.
/// Without a free cap they equal the contact's own totals, which leaves force alone unchanged.
struct Design {
  DesignStatus status = DesignStatus::kInfeasible;
  /// Coupling to run: kind, cut-off, damping ratio, gain, cap, injected damping.
  CouplingSpec spec;
  AxisDesign translation, rotation;  ///< rotation is all zero for a device without torque
  DominantMode swing;                ///< damping ratios of the dominant mode
  MinDampingResult min_damping;      ///< empty for given parameters
  double lag_s = 0.0;                ///< 2 d / w0
  /// Fastest approach that stays within the force layer, stopped by a single point. A hand that
  /// keeps pushing uses force / (K k) of the depth in addition. 0: not computed.
  double max_approach_m_per_s = 0.0;
  std::vector<DesignReason> reasons;  ///< limiting factors
};

/// Designs a coupling. Takes 0.04 to 0.25 s of processor time for the shipped devices and up to
/// half a second with long delays; not for the loop. Equal requests give bit-identical results.
/// Throws std::invalid_argument with the first sentence of `check` for invalid numbers.
Design design_coupling(const DesignProblem& request);

/// Evaluates given parameters with the same certificates, without changing them. `status` is
/// kAsRequested if they hold and kInfeasible otherwise; `reasons` explains it.
Design judge_coupling(const DesignProblem& request, const CouplingSpec& spec);

}  // namespace voxtouch::coupling::design
