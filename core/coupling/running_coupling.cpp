#include "core/coupling/running_coupling.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/types/clamp.hpp"

namespace voxtouch::coupling {
namespace {

CouplingKind kind_of(const CouplingSpec& spec) noexcept {
  CouplingKind kind = CouplingKind::kDirect;
  parse_coupling(spec.kind, kind);
  return kind;
}

const CouplingSpec& checked(const CouplingSpec& spec, const CouplingLimits& limits,
                            double sample_time_s, double ramp_s, const ToolSpeedLimits& speeds) {
  for (const CouplingIssue& issue : validate(spec, limits, sample_time_s))
    if (issue.refuse)
      throw std::invalid_argument("Coupling: " + issue.sentence);
  if (!(ramp_s >= 0.0 && std::isfinite(ramp_s)))
    throw std::invalid_argument(
        fmt::format("Coupling: ramp_s is {}; it must be 0 or above.", ramp_s));
  if (!(speeds.linear_m_per_s > 0.0 && speeds.angular_rad_per_s > 0.0))
    throw std::invalid_argument(fmt::format(
        "Coupling: the tool's largest speeds are {} m/s and {} rad/s; both must be above 0.",
        speeds.linear_m_per_s, speeds.angular_rad_per_s));
  return spec;
}

/// Tolerance by which a contact exactly at the caps may appear to exceed them.
constexpr double kScaleRounding = 1e-6;

/// Bound of the power of effects and moving objects [W]: min(max_force_n, kMaxSuppliedN) times
/// kMaxSuppliedMPerS.
constexpr double kMaxSuppliedN = 100.0, kMaxSuppliedMPerS = 2.0;

/// Whether the static scene or an effect exerts a force, or would after a small displacement.
bool has_contact(const CouplingInput& in) noexcept {
  return !in.contact.zero() || in.contact_stiffness_n_per_m > 0.0 ||
         !in.contact_stiffness.isZero(0.0);
}

}  // namespace

RunningCoupling::RunningCoupling(const CouplingSpec& spec, const CouplingLimits& limits,
                                 double sample_time_s, double ramp_s, const ToolSpeedLimits& speeds)
    : limits_(limits),
      nominal_s_(sample_time_s),
      policy_(sample_time_s, ramp_s),
      law_(law_of(checked(spec, limits, sample_time_s, ramp_s, speeds), sample_time_s)),
      scale_(spec),
      motion_(sample_time_s, spec.velocity_filter_hz, speeds,
              static_cast<int>(spec.velocity_window)),
      injected_(spec),
      swing_({limits.resolution_m, limits.max_force_n, limits.damping_ns_per_m,
              limits.coulomb_friction_n, limits.delay_s, limits.force_lag_s}) {
  motion_.set_slow(spec.slow_velocity_hz, spec.velocity_band_m_per_s);
}

RunningCoupling::Law RunningCoupling::law_of(const CouplingSpec& spec,
                                             double sample_time_s) noexcept {
  switch (kind_of(spec)) {
    case CouplingKind::kShapingFilter:
      return ShapingFilter(spec, sample_time_s);
    case CouplingKind::kSpringDamper:
      return SpringDamper(spec);
    case CouplingKind::kDirect:
      break;
  }
  return DirectCoupling();
}

CouplingKind RunningCoupling::kind() const noexcept {
  return static_cast<CouplingKind>(law_.index());
}

double RunningCoupling::gain() const noexcept {
  const ShapingFilter* filter = std::get_if<ShapingFilter>(&law_);
  return filter ? filter->gain() : 1.0;
}

/// The next samples fade from `start` to their own force. A non-finite start becomes zero; one over
/// the limits is clamped.
void RunningCoupling::start_law_at(const Wrench& start) noexcept {
  law_output_ = start.finite() ? start : Wrench{};
  clamp_wrench(law_output_, limits_.max_force_n, limits_.max_torque_nm);
  policy_.restart(!law_output_.zero());
  contact_ = {};
  std::visit([this](auto& law) { law.start_at(law_output_); }, law_);
}

bool RunningCoupling::redesign(const CouplingSpec& spec) {
  for (const CouplingIssue& issue : validate(spec, limits_, nominal_s_))
    if (issue.refuse)
      return false;
  if (kind_of(spec) != kind()) {
    law_ = law_of(spec, nominal_s_);
    start_law_at(law_output_);
  } else if (ShapingFilter* filter = std::get_if<ShapingFilter>(&law_)) {
    filter->redesign(spec);
  } else if (SpringDamper* spring = std::get_if<SpringDamper>(&law_)) {
    spring->redesign(spec);
  }
  scale_.redesign(spec);
  injected_.redesign(
      spec,
      ramp_behind_filter_s(kind() == CouplingKind::kShapingFilter ? cutoff_rad_per_s(spec) : 0.0));
  motion_.set_filter(spec.velocity_filter_hz, static_cast<int>(spec.velocity_window));
  motion_.set_slow(spec.slow_velocity_hz, spec.velocity_band_m_per_s);
  return true;
}

void RunningCoupling::reset(const Wrench& start) noexcept {
  start_law_at(start);
  motion_.clear();
  passivity_.reset();
  swing_.restart();
  fade_factor_ = 1.0;
  in_contact_ = false;
  supplied_j_.reset();
}

CouplingOutput RunningCoupling::step(const CouplingInput& input, double dt_s) noexcept {
  const PolicedSample sample = policy_.apply(input, dt_s);
  if (dt_s > kGapPeriods * nominal_s_)
    passivity_.reset();
  step_ = motion_.step(input.tool, dt_s);
  count_path();
  const double supplied_j = newly_supplied(input, sample.dt_s);
  passivity_.observe(step_, in_contact_, sample.dt_s, supplied_j);
  swing_.observe(step_, passivity_.applied().force, passivity_.normal(), sample.dt_s, supplied_j);

  CouplingOutput out;
  const Wrench law = run_law(input, sample, out);
  Wrench sum = law;
  injected_.advance(sample.dt_s);
  add_damping(sum, law, out);
  limit_command(sum, law, out);
  fade_out(sample.dt_s, sum, out);
  passivity_.command(sum, contact_.contact.force);
  out.wrench = sum;
  out.energy_j = passivity_.energy().translation_j();
  out.energy_rotation_j = passivity_.energy().rotation_j;
  count(out);
  return out;
}

/// Energy that effects and moving objects have supplied since the last sample, as displayed [J]:
/// scaled like the law's force, and bounded by the largest force at the largest speed.
double RunningCoupling::newly_supplied(const CouplingInput& input, double dt_s) noexcept {
  if (!std::isfinite(input.supplied_energy_j))
    return 0.0;
  const double before = supplied_j_.value_or(input.supplied_energy_j),
               more = input.supplied_energy_j - before;
  supplied_j_ = input.supplied_energy_j;
  const double most = std::min(limits_.max_force_n, kMaxSuppliedN) * kMaxSuppliedMPerS * dt_s;
  return std::clamp(displayed_ratio_ * more, -most, most);
}

/// Applies the law to the scaled and clamped contact.
Wrench RunningCoupling::run_law(const CouplingInput& input, const PolicedSample& sample,
                                CouplingOutput& out) noexcept {
  if (sample.valid) {
    out.scale = scale_.step(input, sample.dt_s);
    contact_ = input;
    contact_.contact.force *= out.scale, contact_.contact.torque *= out.scale;
    contact_.contact_stiffness_n_per_m *= out.scale;
    contact_.contact_stiffness *= out.scale;
    out.capped = out.scale < 1.0 - kScaleRounding && has_contact(input);
    displayed_ratio_ = out.scale * gain();
  } else if (sample.lost) {
    contact_ = {};
  }
  in_contact_ = has_contact(contact_);
  out.ramping = sample.weight < 1.0, out.repeated_input = !sample.valid;
  LawInput in{contact_.contact, contact_.contact_stiffness_n_per_m, sample.dt_s, sample.weight};
  ShapingFilter* filter = std::get_if<ShapingFilter>(&law_);
  if (const double gain = filter ? filter->advance_gain() : 1.0; gain > 0.0) {
    out.clamped =
        clamp_wrench(in.contact, limits_.max_force_n / gain, limits_.max_torque_nm / gain).any();
  } else {
    in.contact = {};  // not clamped without gain, so the law's state would keep it
  }
  law_output_ = std::visit(
      [&](auto& law) {
        if (sample.gap)
          law.start_at(law_output_);
        return law.step(in);
      },
      law_);
  if (!law_output_.finite()) {
    ++counters_.not_finite;
    start_law_at({});
  }
  return law_output_;
}

void RunningCoupling::add_damping(Wrench& sum, const Wrench& law, CouplingOutput& out) noexcept {
  const Twist& velocity = motion_.velocity();
  // Zero without contact force.
  const InjectedWrench injected = injected_.of(contact_, law.force, velocity);
  sum.force += injected.wrench.force, sum.torque += injected.wrench.torque;
  out.bounded = injected.bounded, out.injected_n = injected.wrench.force.stableNorm();
}

/// Applies the rules for a command: it never pulls against the contact, is finite, never exceeds
/// the law's force in free space, and stays within the device's limits.
void RunningCoupling::limit_command(Wrench& sum, const Wrench& law, CouplingOutput& out) noexcept {
  const double part = one_sided(contact_.coherence);
  never_pull(sum.force, law.force.isZero(0.0) ? contact_.contact.force : law.force, part);
  never_pull(sum.torque, law.torque.isZero(0.0) ? contact_.contact.torque : law.torque, part);
  if (!sum.finite()) {
    ++counters_.not_finite;
    sum = law;
  }
  // After a contact the law's output decays. Damping may reduce it, not add to it.
  if (!in_contact_)
    clamp_wrench(sum, law.force.stableNorm(), law.torque.stableNorm());
  out.clamped |= clamp_wrench(sum, limits_.max_force_n, limits_.max_torque_nm).any();
}

/// Fades the command to zero after self-excited growth of the force, until `reset`.
void RunningCoupling::fade_out(double dt_s, Wrench& sum, CouplingOutput& out) noexcept {
  if (!swing_.growing())
    return;
  out.growing = true;
  fade_factor_ = std::max(0.0, fade_factor_ - dt_s / kFadeOutS);
  sum.force *= fade_factor_, sum.torque *= fade_factor_;
}

/// Records the longest displacement in one period under force, for energy_bound_j.
void RunningCoupling::count_path() noexcept {
  const Wrench& applied = passivity_.applied();
  if (applied.zero())
    return;
  counters_.longest_path_m = std::max(counters_.longest_path_m, step_.translation.norm());
  counters_.longest_rotation_rad = std::max(counters_.longest_rotation_rad, step_.rotation.norm());
}

void RunningCoupling::count(const CouplingOutput& out) noexcept {
  counters_.most_force_n = std::max(counters_.most_force_n, out.wrench.force.norm());
  counters_.most_torque_nm = std::max(counters_.most_torque_nm, out.wrench.torque.norm());
  const EnergyAccounts& energy = passivity_.energy();
  ++counters_.samples;
  counters_.faults = policy_.faults();
  counters_.repeated += out.repeated_input, counters_.clamped += out.clamped,
      counters_.capped += out.capped;
  counters_.bounded += out.bounded;
  counters_.pose_jumps = motion_.jumps();
  counters_.swing = swing_.largest();
  counters_.growing = out.growing && fade_factor_ == 0.0;
  counters_.lowest_energy_j =
      std::min({counters_.lowest_energy_j, energy.normal_j, energy.tangential_j});
  counters_.lowest_energy_rotation_j =
      std::min(counters_.lowest_energy_rotation_j, energy.rotation_j);
}

}  // namespace voxtouch::coupling
