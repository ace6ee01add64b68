#include "nodes/cli/identify/identify_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "nodes/cli/design/design_input.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::cli {
namespace {

namespace id = identification;
using id::Estimate;
using id::Outcome;

constexpr std::array<char, 3> kAxisNames{'x', 'y', 'z'};
constexpr double kLeastJitter = 0.05;  // of a file: a clock is never better known than that

/// What happened, the limit, what to do.
std::string sentence(const id::AxisFigures& f, double allowed_n) {
  switch (f.outcome) {
    case Outcome::kMeasured:
      return "measured";
    case Outcome::kFrictionTooHigh:
      return fmt::format(
          "Friction is at least {:.3g} N, limit 0.6 of the allowed {:.3g} N. Allow {:.3g} N: "
          "--force {:.3g}",
          f.break_away_n, allowed_n, f.break_away_n / 0.55, f.break_away_n / 0.55);
    case Outcome::kDoesNotMove:
      return fmt::format(
          "No motion at {:.3g} N. Check that the axis is unlocked, or allow more force with "
          "--force",
          allowed_n);
    case Outcome::kWrongDirection:
      return "The axis moved against both break-away forces. Check the signs of force and encoder";
    case Outcome::kLeftBounds:
      return "Position or speed exceeded its limit; force set to zero. Check the clear space and "
             "--box";
    case Outcome::kFollowingError:
      return "The position did not follow the reference; force set to zero. Release the tool and "
             "repeat";
    case Outcome::kEncoderStuck:
      return "The encoder shows no motion while the reference moves; force set to zero. Check the "
             "encoder";
    case Outcome::kInvalidSamples:
      return "Three samples were invalid or not newer; force set to zero. Check the connection";
    case Outcome::kNotIdentifiable:
      return "Too little motion without reversal for a fit. Allow more force with --force, or a "
             "larger --box";
  }
  return {};
}

std::string cell(const Estimate& e, double scale, int decimals) {
  return fmt::format("{:.{}f} +- {:.{}f}", scale * e.value, decimals, scale * e.half_width,
                     decimals);
}

/// The smallest low or largest high end over the measured axes.
template <class Member, class Pick>
double over_axes(const DeviceRunResult& r, const id::SessionOptions& s, Member member, Pick pick,
                 double start) {
  double out = start;
  for (std::size_t a = 0; a < 3; ++a)
    if (s.axes[a] && r.axes[a].outcome == Outcome::kMeasured)
      out = pick(out, r.axes[a].*member);
  return out;
}

std::string measured_comment(const DeviceRunResult& r, const id::SessionOptions& s,
                             Estimate id::AxisFigures::*member, double scale, int decimals,
                             std::string_view unit) {
  std::string out = "# measured (95 %):";
  for (std::size_t a = 0; a < 3; ++a)
    if (s.axes[a])
      out += fmt::format(" {} {}", kAxisNames[a], cell(r.axes[a].*member, scale, decimals));
  return out + fmt::format(" {}\n", unit);
}

/// As YAML reads it back, whatever it holds.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text)
    if (c == '"' || c == '\\')
      out += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(c));
    else
      out += c;
  return out + "\"";
}

double designed(const DeviceDescription& d, std::string& limit) {
  const auto problem = problem_for_device({}, coupling::design::model_of(d));
  const auto design = coupling::design::design_coupling(problem);
  if (design.status == coupling::design::DesignStatus::kInfeasible) {
    limit = "infeasible";
    return 0.0;
  }
  const auto& axis = design.translation;
  limit = axis.displayed_stiffness >= 0.999 * axis.requested_stiffness
              ? "device limit"
              : design_text::worst_case_of(design, 0);
  return axis.displayed_stiffness;
}

}  // namespace

bool all_measured(const DeviceRunResult& r, const id::SessionOptions& s) {
  if (!r.problem.empty() || r.outcome != Outcome::kMeasured)
    return false;
  for (std::size_t a = 0; a < 3; ++a)
    if (s.axes[a] && r.axes[a].outcome != Outcome::kMeasured)
      return false;
  return true;
}

std::string figures_text(const DeviceRunResult& r, const id::SessionOptions& s,
                         const IdentifyContext& c) {
  const bool passed = all_measured(r, s);
  std::string out = passed ? "PASSED\n" : "FAILED\n";
  if (!r.problem.empty())
    out += r.problem + "\n";
  const bool all_axes_ran = r.problem.empty() && r.outcome == Outcome::kMeasured;
  for (std::size_t a = 0; a < 3; ++a) {
    const Outcome outcome = r.axes[a].outcome;
    if (!s.axes[a] || outcome == Outcome::kMeasured ||
        (outcome == Outcome::kNotIdentifiable && !all_axes_ran))
      continue;
    out += fmt::format("axis {}: {}\n", kAxisNames[a], sentence(r.axes[a], c.allowed_force_n));
  }
  bool any = false;
  for (std::size_t a = 0; a < 3; ++a)
    any = any || (s.axes[a] && r.axes[a].outcome == Outcome::kMeasured);
  if (!any)
    return out;
  out += fmt::format("{:<22}", "figure (95 %)");
  for (const char name : kAxisNames)
    out += fmt::format("{:>22}", name);
  const auto row = [&](std::string_view name, auto text) {
    out += fmt::format("\n{:<22}", name);
    for (std::size_t a = 0; a < 3; ++a)
      out += fmt::format("{:>22}", s.axes[a] && r.axes[a].outcome == Outcome::kMeasured
                                       ? text(a)
                                       : std::string("-"));
  };
  row("mass [g]", [&](std::size_t a) { return cell(r.axes[a].mass_kg, 1e3, 2); });
  row("viscous [Ns/m]", [&](std::size_t a) { return cell(r.axes[a].viscous_ns_per_m, 1.0, 3); });
  row("Coulomb [mN]", [&](std::size_t a) { return cell(r.axes[a].coulomb_n, 1e3, 1); });
  row("bias [mN]", [&](std::size_t a) { return cell(r.axes[a].bias_n, 1e3, 1); });
  row("delay [ms]", [&](std::size_t a) { return cell(r.axes[a].delay_s, 1e3, 3); });
  row("  force lag in it [ms]",
      [&](std::size_t a) { return fmt::format("about {:.1f}", 1e3 * r.axes[a].lag_s); });
  row("encoder step [um]", [&](std::size_t a) {
    return r.encoder_step_m[a] > 0.0 ? fmt::format("{:.3f}", 1e6 * r.encoder_step_m[a])
                                     : std::string("not found");
  });
  row("mode [Hz]", [&](std::size_t a) {
    return r.axes[a].mode.found ? cell(r.axes[a].mode.frequency_hz, 1.0, 1)
                                : std::string("none below 90 Hz");
  });
  out += fmt::format("\nclock: period {:.4f} ms, jitter {:.1f} %, samples lost {:.2f} %\n",
                     1e3 * r.clock.period_s, 1e2 * r.clock.jitter, 1e2 * r.clock.loss);
  return out;
}

DeviceDescription measured_description(const DeviceRunResult& r, const id::SessionOptions& s,
                                       const IdentifyContext& c, bool ends) {
  DeviceDescription d = c.assumed;
  const auto low = [&](const Estimate& e) { return ends ? e.low() : e.value; };
  const auto high = [&](const Estimate& e) { return ends ? e.high() : e.value; };
  const auto least = [&](double out, const Estimate& e) { return std::min(out, low(e)); };
  const auto most = [&](double out, const Estimate& e) { return std::max(out, high(e)); };
  using F = id::AxisFigures;
  d.mass_min_kg = over_axes(r, s, &F::mass_kg, least, 1e9);
  d.mass_max_kg = over_axes(r, s, &F::mass_kg, most, 0.0);
  d.damping_ns_per_m = std::max(0.0, over_axes(r, s, &F::viscous_ns_per_m, least, 1e9));
  d.coulomb_friction_n = std::max(0.0, over_axes(r, s, &F::coulomb_n, least, 1e9));
  d.delay_s =
      over_axes(r, s, &F::delay_s, most, 0.0) + (c.answers_at_once ? 0.0 : r.clock.period_s);
  d.force_bandwidth_hz = std::numeric_limits<double>::infinity();  // the lag is a part of the delay
  const double step = std::ranges::max(r.encoder_step_m);
  if (step > 0.0)
    d.position_resolution_m = step;
  d.rate_hz =
      std::abs(r.clock.period_s * d.rate_hz - 1.0) < 0.01 ? d.rate_hz : 1.0 / r.clock.period_s;
  d.jitter = std::max(kLeastJitter, r.clock.jitter);
  d.consecutive_losses = std::max(1U, static_cast<std::uint32_t>(r.clock.consecutive_losses));
  d.simulated = true;
  derive_slew_limits(d);
  return d;
}

std::string device_file_text(const DeviceRunResult& r, const id::SessionOptions& s,
                             const IdentifyContext& c) {
  const DeviceDescription d = measured_description(r, s, c, true);
  using F = id::AxisFigures;
  std::string out = "# Each measured value is the conservative end of its 95 % interval.\n";
  out += fmt::format("device: {}\n", quoted(d.model));
  out += fmt::format("rate_hz: {:.6g}  # measured\n", d.rate_hz);
  out += fmt::format("max_force_n: {:.6g}  # assumed: from the driver\n", d.max_force_n);
  out += fmt::format("max_torque_nm: {:.6g}  # assumed: from the driver\n", d.max_torque_nm);
  out += fmt::format("max_stiffness_n_per_m: {:.6g}  # assumed: from the driver\n",
                     d.max_stiffness_n_per_m);
  out += measured_comment(r, s, &F::mass_kg, 1e3, 2, "g, at the start pose");
  out += fmt::format("mass_kg: [{:.6g}, {:.6g}]\n", d.mass_min_kg, d.mass_max_kg);
  out += measured_comment(r, s, &F::viscous_ns_per_m, 1.0, 3, "Ns/m");
  out += fmt::format("damping_ns_per_m: {:.6g}\n", d.damping_ns_per_m);
  out += measured_comment(r, s, &F::coulomb_n, 1e3, 1, "mN");
  out += fmt::format("coulomb_friction_n: {:.6g}\n", d.coulomb_friction_n);
  out += measured_comment(r, s, &F::delay_s, 1e3, 3, "ms, transport and force lag");
  if (!c.answers_at_once)
    out += "# plus one period of waiting in the ring\n";
  out += fmt::format("delay_s: {:.6g}\n", d.delay_s);
  out += fmt::format(
      "position_resolution_m: {:.6g}  # {}\n", d.position_resolution_m,
      std::ranges::max(r.encoder_step_m) > 0.0 ? "measured" : "assumed: no common step was found");
  out += fmt::format("jitter: {:.3g}  # measured {:.3g}, at least {}\n", d.jitter, r.clock.jitter,
                     kLeastJitter);
  out += fmt::format("consecutive_losses: {}  # measured {}, at least 1\n", d.consecutive_losses,
                     r.clock.consecutive_losses);
  out += fmt::format("grip: {}\n", d.grip);
  out += fmt::format("measured:\n  date: {}\n  command: {}\n", quoted(c.date), quoted(c.command));
  if (!c.serial.empty())
    out += fmt::format("  serial: {}\n", quoted(c.serial));
  if (d.max_torque_nm > 0.0)
    out += fmt::format(
        "# assumed: from the driver, rotation is not measured\nrotation:\n"
        "  inertia_kg_m2: [{:.6g}, {:.6g}]\n  damping_nms_per_rad: {:.6g}\n  coulomb_friction_nm: "
        "{:.6g}\n"
        "  orientation_resolution_rad: {:.6g}\n  max_stiffness_nm_per_rad: {:.6g}\n",
        d.inertia_min_kg_m2, d.inertia_max_kg_m2, d.damping_nms_per_rad, d.coulomb_friction_nm,
        d.orientation_resolution_rad, d.max_stiffness_nm_per_rad);
  return out;
}

std::string design_table(const DeviceDescription& before, const DeviceDescription& values,
                         const DeviceDescription& ends) {
  std::string limit_before, limit_values, limit_ends;
  const double k_before = designed(before, limit_before), k_values = designed(values, limit_values);
  const double k_ends = designed(ends, limit_ends);
  std::string out = fmt::format("{:<34}{:>12}  {}\n", "design", "stiffness", "limited by");
  out +=
      fmt::format("{:<34}{:>8.0f} N/m  {}\n", "with the driver's values", k_before, limit_before);
  out += fmt::format("{:<34}{:>8.0f} N/m  {}\n", "measured values", k_values, limit_values);
  out += fmt::format("{:<34}{:>8.0f} N/m  {}\n", "conservative ends of the intervals", k_ends,
                     limit_ends);
  if (k_values > 0.0)
    out += fmt::format("cost of the intervals: {:.1f} %\n", 1e2 * (1.0 - k_ends / k_values));
  return out;
}

}  // namespace voxtouch::cli
