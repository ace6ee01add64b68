#include "core/coupling/running_coupling.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/types/clamp.hpp"

namespace voxtouch {
namespace {

CouplingKind kind_of(const CouplingSpec& spec) noexcept {
  CouplingKind kind = CouplingKind::kDirect;
  parse_coupling(spec.kind, kind);
  return kind;
}

PassivityLimits limits_of(const CouplingSpec& spec) noexcept {
  return {spec.passivity_damping_limit_ns_per_m, spec.passivity_damping_limit_nms_per_rad};
}

const CouplingSpec& checked(const CouplingSpec& spec, const CouplingLimits& limits, double sample_time_s, double ramp_s,
                            const ToolSpeedLimits& speeds) {
  make_coupling(spec, limits, sample_time_s, ramp_s);  // refuses with a sentence
  if (!(speeds.linear_m_per_s > 0.0 && speeds.angular_rad_per_s > 0.0))
    throw std::invalid_argument(
        fmt::format("Coupling: the tool's largest speeds are {} m/s and {} rad/s; both must be above 0.",
                    speeds.linear_m_per_s, speeds.angular_rad_per_s));
  return spec;
}

constexpr double kMostSuppliedN = 100.0, kMostSuppliedMPerS = 2.0;

bool pushes(const CouplingInput& in) noexcept {
  return !in.contact.zero() || in.contact_stiffness_n_per_m > 0.0 || !in.contact_stiffness.isZero(0.0);
}

}  // namespace

RunningCoupling::RunningCoupling(const CouplingSpec& spec, const CouplingLimits& limits, double sample_time_s,
                                 double ramp_s, const ToolSpeedLimits& speeds)
    : limits_(limits), nominal_s_(sample_time_s), ramp_s_(ramp_s),
      filter_(checked(spec, limits, sample_time_s, ramp_s, speeds), limits, sample_time_s, ramp_s),
      spring_(spec, limits, sample_time_s, ramp_s), direct_(limits, sample_time_s, ramp_s), law_(start_law(spec)),
      cap_(spec), motion_(sample_time_s, spec.velocity_filter_hz, speeds), injected_(spec), passivity_(sample_time_s),
      passivity_limits_(limits_of(spec)) {}

Coupling* RunningCoupling::start_law(const CouplingSpec& spec) noexcept {
  switch (kind_of(spec)) {
    case CouplingKind::kShapingFilter: return filter_ = ShapingFilter(spec, limits_, nominal_s_, ramp_s_), &filter_;
    case CouplingKind::kSpringDamper: return spring_ = SpringDamper(spec, limits_, nominal_s_, ramp_s_), &spring_;
    case CouplingKind::kDirect: break;
  }
  return direct_ = DirectCoupling(limits_, nominal_s_, ramp_s_), &direct_;
}

bool RunningCoupling::redesign(const CouplingSpec& spec) {
  for (const CouplingIssue& issue : validate(spec, limits_, nominal_s_))
    if (issue.refuse) return false;
  if (kind_of(spec) != kind()) {
    faults_before_ += law_->faults();
    law_ = start_law(spec);
    law_->reset(given_);
  } else if (law_ == &filter_) {
    filter_.set(spec.cutoff_hz, spec.damping_ratio, spec.gain);
  } else if (law_ == &spring_) {
    spring_.set(spec.stiffness_n_per_m, spec.damping_ns_per_m);
  }
  cap_.redesign(spec);
  injected_.redesign(spec, ramp_behind_filter_s(law_ == &filter_ ? cutoff_rad_per_s(spec) : 0.0));
  motion_.set_filter(spec.velocity_filter_hz);
  passivity_limits_ = limits_of(spec);
  return true;
}

void RunningCoupling::reset(const Wrench& held) noexcept {
  law_->reset(held);
  cap_.reset();
  motion_.forget();
  passivity_.reset();
  contact_ = {};
  given_ = held.finite() ? held : Wrench{};
  clamp_wrench(given_, limits_.max_force_n, limits_.max_torque_nm);
  in_contact_ = false;
  held_s_ = 0.0;
  supplied_j_.reset();
}

CouplingOutput RunningCoupling::step(const CouplingInput& input, double dt_s) noexcept {
  const bool in_band = dt_s >= nominal_s_ / kPeriodBand && dt_s <= nominal_s_ * kPeriodBand;
  const double used_dt_s = in_band ? dt_s : nominal_s_;
  if (dt_s > kGapPeriods * nominal_s_) passivity_.reset();
  way_ = motion_.step(input.tool, dt_s);
  count_way();
  passivity_.observe(way_, in_contact_, used_dt_s, newly_supplied(input, used_dt_s));

  CouplingOutput out;
  const Wrench law = run_law(input, dt_s, used_dt_s, out);
  Wrench sum = law;
  injected_.advance(used_dt_s);
  add_damping(sum, law, out);
  finish(sum, law, out);
  passivity_.command(sum);
  out.wrench = sum;
  out.energy_j = passivity_.energy().translation_j();
  out.energy_rotation_j = passivity_.energy().rotation_j;
  count(out);
  return out;
}

/// Of what was supplied in W the hand gets as much as the law shows of a force. Never more than the largest force can do.
double RunningCoupling::newly_supplied(const CouplingInput& input, double dt_s) noexcept {
  if (!std::isfinite(input.supplied_energy_j)) return 0.0;
  const double before = supplied_j_.value_or(input.supplied_energy_j), more = input.supplied_energy_j - before;
  supplied_j_ = input.supplied_energy_j;
  const double most = std::min(limits_.max_force_n, kMostSuppliedN) * kMostSuppliedMPerS * dt_s;
  return std::clamp(shown_ * more, -most, most);
}

/// The contact, capped, through the law.
Wrench RunningCoupling::run_law(const CouplingInput& input, double dt_s, double used_dt_s,
                                CouplingOutput& out) noexcept {
  if (usable(input)) {
    out.scale = cap_.step(input, used_dt_s);
    contact_ = input;
    contact_.contact.force *= out.scale, contact_.contact.torque *= out.scale;
    contact_.contact_stiffness_n_per_m *= out.scale;
    contact_.contact_stiffness *= out.scale;
    out.capped = out.scale < 1.0 && pushes(input);
    shown_ = out.scale * (law_ == &filter_ ? filter_.gain() : 1.0);
    held_s_ = 0.0;
    given_ = law_->step(contact_, dt_s);
  } else {
    held_s_ += used_dt_s;
    if (held_s_ > kGapPeriods * nominal_s_) contact_ = {};  // as the law's policy does
    given_ = law_->step(input, dt_s);
  }
  in_contact_ = pushes(contact_);
  const CouplingStatus status = law_->status();
  out.ramping = status.ramping, out.held_input = status.held_input, out.clamped = status.clamped;
  if (!given_.finite()) {
    ++counters_.not_finite;
    law_->reset({});
    given_ = {};
  }
  return given_;
}

void RunningCoupling::add_damping(Wrench& sum, const Wrench& law, CouplingOutput& out) noexcept {
  const Twist& velocity = motion_.velocity();
  const Wrench damping = injected_.of(contact_, velocity);  // none where the contact does not push
  sum.force += damping.force, sum.torque += damping.torque;
  PassivityDamping more = passivity_.control(contact_.contact.force, way_, velocity, passivity_limits_);
  // Across the contact it works as friction does: no more than the push, so that it comes and goes with it.
  clamp_length(more.tangential, law.force.stableNorm());
  sum.force += more.normal + more.tangential, sum.torque += more.torque;
  if (law.zero() && !in_contact_) return;  // in free space `finish` takes it all away
  out.damping_ns_per_m = more.linear_ns_per_m, out.damping_nms_per_rad = more.angular_nms_per_rad;
  out.passivity = more.linear_ns_per_m > 0.0 || more.angular_nms_per_rad > 0.0;
}

/// Never pulling, nothing in free space, within the limits, finite.
void RunningCoupling::finish(Wrench& sum, const Wrench& law, CouplingOutput& out) noexcept {
  never_pull(sum.force, law.force.isZero(0.0) ? contact_.contact.force : law.force);
  never_pull(sum.torque, law.torque.isZero(0.0) ? contact_.contact.torque : law.torque);
  if (!sum.finite()) {
    ++counters_.not_finite;
    sum = law;
  }
  // The filter's tail: damping may take from it, not add to it.
  if (!in_contact_) clamp_wrench(sum, law.force.stableNorm(), law.torque.stableNorm());
  out.clamped |= clamp_wrench(sum, limits_.max_force_n, limits_.max_torque_nm).any();
}

/// The way that the last command has worked on.
void RunningCoupling::count_way() noexcept {
  const Wrench& applied = passivity_.applied();
  if (applied.zero()) return;
  counters_.longest_way_m = std::max(counters_.longest_way_m, way_.shift.norm());
  counters_.longest_turn_rad = std::max(counters_.longest_turn_rad, way_.turn.norm());
}

void RunningCoupling::count(const CouplingOutput& out) noexcept {
  counters_.most_force_n = std::max(counters_.most_force_n, out.wrench.force.norm());
  counters_.most_torque_nm = std::max(counters_.most_torque_nm, out.wrench.torque.norm());
  const EnergyAccounts& energy = passivity_.energy();
  ++counters_.samples;
  counters_.faults = faults_before_ + law_->faults();
  counters_.held += out.held_input, counters_.clamped += out.clamped, counters_.capped += out.capped;
  counters_.controlled += out.passivity;
  counters_.pose_jumps = motion_.jumps();
  counters_.lowest_energy_j = std::min({counters_.lowest_energy_j, energy.normal_j, energy.tangential_j});
  counters_.lowest_energy_rotation_j = std::min(counters_.lowest_energy_rotation_j, energy.rotation_j);
  counters_.most_damping_ns_per_m = std::max(counters_.most_damping_ns_per_m, out.damping_ns_per_m);
}

}  // namespace voxtouch
