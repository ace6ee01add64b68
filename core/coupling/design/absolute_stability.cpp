#include "core/coupling/design/absolute_stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/types/enum_name.hpp"

namespace voxtouch::coupling::design {
namespace {

/// Tried ratios to the linear limit: the first gap to 1, then doubled repeatedly. No ratio is
/// closer to 1, because the floor of the proof would leave no multiplier.
constexpr double kLeastGap = 0.01;
/// Displayed stiffness to certify if no stiffness makes the loop unstable.
constexpr double kInsteadOfNoLimit = 100.0;

bool is_series(const CouplingSpec& spec) { return spec.kind == "spring_damper"; }

/// The largest displayed slope that the design allows the contact of one axis.
double displayed(const DisplayedStiffness& at) { return at.coupling * at.displayed; }

/// Slope of the contact ahead of a spring-damper; infinity if it is unbounded.
double before_series(const CouplingSpec& spec, const AxisProblem& axis,
                     const DisplayedStiffness& at) {
  const bool rotation = axis.axis == 1;
  const double cap = rotation ? spec.stiffness_cap_nm_per_rad : spec.stiffness_cap_n_per_m;
  return std::isfinite(cap) ? at.coupling * at.contact : kInfinity;
}

/// One axis of a design with the laws that run on it: on the velocity of the injected damping, and
/// on the slow velocity.
struct Axis {
  AxisProblem problem;
  DisplayedStiffness at;
  std::vector<LoopController> laws;
};

std::vector<Axis> axes_of(const DesignProblem& request, const CouplingSpec& spec) {
  const std::vector<AxisProblem> problems = axis_problems(request);
  const std::vector<DisplayedStiffness> displayed = displayed_stiffness(request, problems, spec);
  std::vector<Axis> axes;
  for (std::size_t a = 0; a < problems.size(); ++a) {
    Axis axis{problems[a], displayed[a], {controller_of(spec, problems[a], arm_squared(request))}};
    if (a == 0 && damps_on_slow_velocity(spec)) {
      axis.laws.push_back(axis.laws.front());
      axis.laws.back().use({spec.slow_velocity_hz, 0});
    }
    axes.push_back(std::move(axis));
  }
  return axes;
}

double linear_limit(const Axis& axis, const CouplingSpec& spec) {
  double least = kInfinity;
  for (const LoopController& law : axis.laws) {
    if (is_series(spec)) {
      const double contact = before_series(spec, axis.problem, axis.at);
      least =
          std::min(least, axis.at.displayed * critical_scale(axis.problem, law, contact).stiffness);
      continue;
    }
    for (const DesignCase& one : axis.problem.cases)
      least = std::min(least, critical_stiffness(one.plant, law).stiffness);
  }
  return least;
}

std::vector<ContactLoop> loops_of(const std::vector<Axis>& axes, const CouplingSpec& spec,
                                  std::span<const double> stiffness) {
  std::vector<ContactLoop> loops;
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (LoopController law : axes[a].laws) {
      double compliance = 1.0 / stiffness[a];
      double total = compliance;
      if (is_series(spec)) {
        const double scale = stiffness[a] / axes[a].at.displayed;
        law.stiffness *= scale;
        law.damping *= scale;
        compliance = 1.0 / (scale * before_series(spec, axes[a].problem, axes[a].at));
        total = compliance + 1.0 / law.stiffness;
      }
      for (const DesignCase& one : axes[a].problem.cases)
        loops.push_back({loop_over_arc(one.plant, law), compliance, kMultiplierFloor * total});
    }
  return loops;
}

/// `ratio` of each limit.
std::vector<double> scaled(const std::vector<Axis>& axes, const std::vector<double>& limits,
                           double ratio) {
  std::vector<double> stiffness;
  for (std::size_t a = 0; a < axes.size(); ++a)
    stiffness.push_back(ratio * std::min(limits[a], kInsteadOfNoLimit * displayed(axes[a].at)));
  return stiffness;
}

/// Finds the largest tried ratio to the linear limits that has a multiplier.
void find_largest(const std::vector<Axis>& axes, const CouplingSpec& spec,
                  ContactCertificate& out) {
  std::vector<double> limits;
  for (const Axis& axis : axes)
    limits.push_back(linear_limit(axis, spec));
  for (double gap = kLeastGap; gap < 1.0; gap *= 2.0) {
    const std::vector<double> stiffness = scaled(axes, limits, 1.0 - gap);
    const std::vector<ContactLoop> loops = loops_of(axes, spec, stiffness);
    out.loops = static_cast<int>(loops.size());
    const std::optional<Multiplier> found = find_multiplier(loops);
    if (!found)
      continue;
    out.multiplier = *found;
    out.ratio_of_linear = 1.0 - gap;
    for (std::size_t a = 0; a < axes.size(); ++a)
      out.axes[a].stiffness = stiffness[a];
    return;
  }
}

/// Sets the margins. Returns true if the certificate covers all contacts that the design allows.
bool is_enough(const std::vector<Axis>& axes, ContactCertificate& out) {
  bool enough = true;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const double load = displayed(axes[a].at);
    out.axes[a].margin = load > 0.0 ? out.axes[a].stiffness / load : kInfinity;
    enough = enough && out.axes[a].margin * kRounding >= 1.0;
  }
  return enough;
}

std::vector<CertificateGap> gaps_of(const DesignProblem& request, const CouplingSpec& spec,
                                    MonotoneProof proof) {
  using enum CertificateGap;
  const DeviceModel& device = request.device;
  const AxisModel& translation = device.translation;
  std::vector<CertificateGap> out;
  if (proof != MonotoneProof::kPassivity) {
    if (spec.injected_damping_ns_per_m > 0.0 || spec.injected_damping_nms_per_rad > 0.0)
      out.push_back(kDamperGate);
    if (spec.injected_damping_ns_per_m > 0.0 && spec.damping_force_ratio > 0.0)
      out.push_back(kDamperBound);
    if (damps_on_slow_velocity(spec))
      out.push_back(kVelocityBand);
    if (device.timing.jitter > 0.0 || device.timing.consecutive_losses > 0)
      out.push_back(kVaryingTiming);
    out.push_back(kBetweenCorners);
    if (request.hand.translation.may_release && translation.damping == 0.0)
      out.push_back(kReleasedFrictionless);
  }
  if (!device.gives_torque)
    out.push_back(kForceOnlyLever);
  out.push_back(kCurvedContact);
  out.push_back(kVoxelSteps);
  if (translation.resolution > 0.0)
    out.push_back(kEncoderSteps);
  if (std::isfinite(translation.max_effort))
    out.push_back(kForceLimit);
  return out;
}

}  // namespace

std::string_view name_of(ContactClass contact) noexcept {
  static constexpr std::array<std::string_view, 3> kNames{"none", "linear", "monotone"};
  return name_in(kNames, contact);
}

std::string_view name_of(MonotoneProof proof) noexcept {
  static constexpr std::array<std::string_view, 3> kNames{"none", "multiplier", "passivity"};
  return name_in(kNames, proof);
}

std::string_view name_of(CertificateGap gap) noexcept {
  static constexpr std::array<std::string_view, 11> kNames{
      "damper_gate",     "damper_bound",          "velocity_band",    "varying_timing",
      "between_corners", "released_frictionless", "force_only_lever", "curved_contact",
      "voxel_steps",     "encoder_steps",         "force_limit"};
  return name_in(kNames, gap);
}

std::vector<double> linear_limits(const DesignProblem& request, const CouplingSpec& spec) {
  std::vector<double> limits;
  for (const Axis& axis : axes_of(request, spec))
    limits.push_back(linear_limit(axis, spec));
  return limits;
}

std::vector<ContactLoop> contact_loops(const DesignProblem& request, const CouplingSpec& spec,
                                       std::span<const double> stiffness) {
  return loops_of(axes_of(request, spec), spec, stiffness);
}

ContactCertificate certify_contacts(const DesignProblem& request, const Design& design) {
  ContactCertificate out;
  if (design.status == DesignStatus::kInfeasible)
    return out;
  out.contact = ContactClass::kLinear;
  const std::vector<Axis> axes = axes_of(request, design.spec);
  out.axes.resize(axes.size());
  // A list of hands, and so a list of loops, does not represent every passive hand.
  const bool any_passive =
      std::ranges::any_of(axes, [](const Axis& axis) { return axis.problem.hand.any_passive; });
  if (!any_passive) {
    find_largest(axes, design.spec, out);
    if (is_enough(axes, out))
      out.proof = MonotoneProof::kMultiplier;
  }
  if (out.proof == MonotoneProof::kNone) {
    ContactCertificate passive = out;
    for (std::size_t a = 0; a < axes.size(); ++a)
      passive.axes[a].stiffness = axis_of(design, a).passive_stiffness;
    const bool enough = is_enough(axes, passive);
    if (enough)
      passive.proof = MonotoneProof::kPassivity;
    if (enough || any_passive)
      out = passive;
  }
  if (out.proof != MonotoneProof::kNone)
    out.contact = ContactClass::kMonotone;
  out.gaps = gaps_of(request, design.spec, out.proof);
  return out;
}

}  // namespace voxtouch::coupling::design
