#include "core/reference/contact_validator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <stdexcept>
#include <string_view>

namespace voxtouch::reference {
namespace {

constexpr double kDiagonal = std::numbers::sqrt3;             ///< of a voxel, in edges
constexpr double kDepthTolerance = 1.0;                       ///< in edges
constexpr double kDirectionTolerance = std::numbers::pi / 9;  ///< 20 degrees
constexpr double kWrongSide = std::numbers::pi / 2;
constexpr double kDirectionFromDepth = 0.25;  ///< in edges
constexpr double kSignFromGap = 0.5;          ///< in edges
constexpr std::uint32_t kDirectionFromHits = 4;
constexpr double kDirectionFromCoherence = 0.5;
constexpr double kCapSlack = 0.25;    ///< in edges
constexpr double kLeverSlack = 1e-3;  ///< in edges, for rounding
constexpr int kFrozenSamples = 3;
constexpr double kFrozenGap = 0.25;  ///< in edges

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

void require(bool ok, std::string_view field, double value, std::string_view rule) {
  if (!ok)
    throw std::invalid_argument(fmt::format("{} = {:g} must be {}", field, value, rule));
}

/// Messages give lengths in millimetres.
double mm(double metres) { return 1e3 * metres; }

}  // namespace

void ValidatorSettings::validate() const {
  require(std::isfinite(edge_m) && edge_m > 0, "edge_m", edge_m, "finite and above 0");
  require(std::isfinite(chord_error_m) && chord_error_m >= 0, "chord_error_m", chord_error_m,
          "finite and 0 or more");
  require(std::isfinite(shell_gap_m) && shell_gap_m >= 0, "shell_gap_m", shell_gap_m,
          "finite and 0 or more");
  require(std::isfinite(shell_offset_m) && shell_offset_m >= 0, "shell_offset_m", shell_offset_m,
          "finite and 0 or more");
}

ContactValidator::ContactValidator(const ValidatorSettings& settings) : settings_(settings) {
  settings_.validate();
}

void ContactValidator::change(const ValidatorSettings& settings) {
  settings.validate();
  settings_ = settings;
  run_ = {};
}

double ContactValidator::free_limit_m() const noexcept {
  return kDiagonal * settings_.edge_m + settings_.chord_error_m + settings_.shell_offset_m;
}

double ContactValidator::inside_depth_limit_m() const noexcept {
  return 0.5 * kDiagonal * settings_.edge_m + settings_.shell_gap_m + settings_.chord_error_m +
         settings_.shell_offset_m;
}

Validation ContactValidator::validate(const GapResult& gap, const ReportedContact& report) {
  Validation out;
  out.explanation = not_usable(report);
  if (!out.explanation.empty()) {
    out.verdict = Verdict::kDisagree, out.cause = Cause::kRendering;
  } else if (gap.method == GapMethod::kNone || !std::isfinite(gap.gap_m)) {
    out.cause = Cause::kReference, out.explanation = "the reference has no gap for this pose";
  } else {
    follow(gap, report);
    out.explanation = breach(gap, report, out);
    conclude(gap.self_check, out);
    if (!gap.self_check) {
      out.decided = false;
      out.explanation += fmt::format(" (two computations of the distance differ by {:.3g} mm)",
                                     mm(gap.self_error_m));
    }
  }
  count(out);
  return out;
}

void ContactValidator::conclude(bool checked, Validation& out) {
  if (!out.explanation.empty()) {
    out.verdict = Verdict::kDisagree, out.cause = checked ? Cause::kRendering : Cause::kReference;
  } else if (!checked) {
    out.cause = Cause::kReference;
    out.explanation = "the contact is correct, but the reference's cross-check fails";
  } else if (out.decided) {
    out.verdict = Verdict::kAgree;
  }
}

void ContactValidator::count(const Validation& validation) noexcept {
  ++counts_.checked;
  if (validation.decided)
    ++counts_.decided;
  if (validation.decided || !std::isnan(validation.depth_error_m) ||
      !std::isnan(validation.direction_error_rad))
    ++counts_.compared;
  if (validation.verdict == Verdict::kAgree)
    ++counts_.agree;
  if (validation.verdict == Verdict::kInBand)
    ++counts_.in_band;
  if (validation.verdict != Verdict::kDisagree)
    return;
  ++counts_.disagree;
  ++(validation.cause == Cause::kReference ? counts_.reference : counts_.rendering);
}

void ContactValidator::follow(const GapResult& gap, const ReportedContact& report) {
  const bool same = run_.samples > 0 && report.wrench.force == run_.wrench.force &&
                    report.wrench.torque == run_.wrench.torque;
  if (report.wrench.zero() || report.latched) {
    run_ = {};
  } else if (same) {
    ++run_.samples;
    run_.least_gap_m = std::min(run_.least_gap_m, gap.gap_m);
    run_.largest_gap_m = std::max(run_.largest_gap_m, gap.gap_m);
  } else {
    run_ = {report.wrench, 1, gap.gap_m, gap.gap_m};
  }
}

std::string ContactValidator::not_usable(const ReportedContact& report) const {
  const bool finite = report.pose_WT.finite() && report.wrench.finite() &&
                      report.mean_normal.allFinite() && std::isfinite(report.deepest_depth_m) &&
                      std::isfinite(report.coherence);
  return finite ? "" : "the contact has NaN or infinity";
}

std::string ContactValidator::breach(const GapResult& gap, const ReportedContact& report,
                                     Validation& out) const {
  std::string found = hits_breach(gap, report, out);
  if (found.empty())
    found = force_breach(report);
  if (std::string other = depth_breach(gap, report, out); found.empty())
    found = std::move(other);
  if (std::string other = direction_breach(gap, report, out); found.empty())
    found = std::move(other);
  if (found.empty())
    found = torque_breach(gap, report);
  return found;
}

std::string ContactValidator::hits_breach(const GapResult& gap, const ReportedContact& report,
                                          Validation& out) const {
  const std::uint32_t interior = gap.inside_known ? report.interior_hits : 0;
  if (gap.gap_m > free_limit_m()) {
    // Without a defined interior, a tool completely inside counts as free for the reference: no
    // verdict.
    if (!gap.inside_known && report.interior_hits > 0 && report.surface_hits == 0)
      return "";
    out.decided = true;
    if (report.surface_hits > 0 || interior > 0 || !report.wrench.zero())
      return fmt::format(
          "in free space, {:.3g} mm from the surface (free from {:.3g} mm): {} surface and {} "
          "interior hits and "
          "a force of {:.3g} N",
          mm(gap.gap_m), mm(free_limit_m()), report.surface_hits, interior,
          report.wrench.force.norm());
    return "";
  }
  if (gap.inside_depth_m > inside_depth_limit_m()) {
    out.decided = true;
    if (report.surface_hits == 0 && report.interior_hits == 0)
      return fmt::format("no hit at a reference depth of {:.3g} mm (must collide from {:.3g} mm)",
                         mm(gap.inside_depth_m), mm(inside_depth_limit_m()));
  }
  const double cap_limit =
      kCapSlack * settings_.edge_m + settings_.chord_error_m + settings_.shell_offset_m;
  const bool cap_contains_a_point =
      settings_.shell_gap_m <= kDiagonal * settings_.edge_m * (1 + 1e-9);
  if (report.surface_hits == 0 && report.interior_hits == 0 && cap_contains_a_point &&
      gap.cap_inside_depth_m > cap_limit)
    return fmt::format("no hit, but the tool around its deepest point is at least {:.3g} mm inside",
                       mm(gap.cap_inside_depth_m));
  if (interior > 0 && gap.gap_m > settings_.chord_error_m + settings_.shell_offset_m)
    return fmt::format("{} interior hits, but the tool is {:.3g} mm outside the surface", interior,
                       mm(gap.gap_m));
  return "";
}

std::string ContactValidator::force_breach(const ReportedContact& report) const {
  const bool force = !report.wrench.zero();
  if (force && report.surface_hits == 0 && report.interior_hits == 0)
    return fmt::format("a force of {:.3g} N without a hit", report.wrench.force.norm());
  const bool deep = report.deepest_depth_m > kDirectionFromDepth * settings_.edge_m;
  if (!force && deep && !report.fallback && report.coherence >= kDirectionFromCoherence)
    return fmt::format("no force at a reported depth of {:.3g} mm", mm(report.deepest_depth_m));
  if (run_.samples >= kFrozenSamples &&
      run_.largest_gap_m - run_.least_gap_m > kFrozenGap * settings_.edge_m)
    return fmt::format(
        "frozen force: bit-identical in {} checked samples while the gap changed by {:.3g} mm",
        run_.samples, mm(run_.largest_gap_m - run_.least_gap_m));
  return "";
}

std::string ContactValidator::depth_breach(const GapResult& gap, const ReportedContact& report,
                                           Validation& out) const {
  const bool at_least =
      gap.method == GapMethod::kVertexDepth;  // a mesh is at least as deep as its vertices
  if (!(gap.depth_exact || at_least) || report.latched || gap.gap_m > free_limit_m())
    return "";
  const double e = settings_.edge_m, g = settings_.shell_gap_m, radius = gap.sphere_radius_m;
  const double sag = radius > 0 ? std::min(g, g * g / (2.0 * radius)) : g;
  const double layer = 0.5 * e * (gap.direction.isZero() ? kDiagonal : gap.direction.lpNorm<1>());
  const double tolerance = std::max(kDepthTolerance * e, layer + sag) + settings_.chord_error_m +
                           settings_.shell_offset_m;
  const double depth = at_least ? gap.inside_depth_m : std::max(0.0, -gap.gap_m),
               error = report.deepest_depth_m - depth;
  const bool saturated = report.interior_hits > 0;
  if (!saturated || error > 0)
    out.depth_error_m = error;
  if ((error > tolerance && !at_least) || (error < -tolerance && !saturated))
    return fmt::format(
        "reported depth {:.3g} mm, reference {:.3g} mm: difference {:.3g} mm, limit {:.3g} mm",
        mm(report.deepest_depth_m), mm(depth), mm(std::abs(error)), mm(tolerance));
  return "";
}

std::string ContactValidator::direction_breach(const GapResult& gap, const ReportedContact& report,
                                               Validation& out) const {
  const double e = settings_.edge_m;
  const bool coherent = report.coherence >= kDirectionFromCoherence;
  if (!gap.unique_face || gap.direction.isZero() || report.fallback ||
      !(coherent || report.latched))
    return "";
  if (gap.gap_m >= kSignFromGap * e || report.surface_hits + report.interior_hits == 0)
    return "";
  for (const Vec3& reported : {report.wrench.force, report.mean_normal})
    if (!reported.isZero(0.0))
      out.direction_error_rad =
          std::fmax(out.direction_error_rad, angle_between(reported, gap.direction));
  const double from_depth = kDirectionFromDepth * e + settings_.shell_offset_m;
  const bool to_angle = -gap.gap_m >= from_depth && report.surface_hits >= kDirectionFromHits &&
                        report.interior_hits == 0 && !report.latched;
  const double limit = to_angle ? kDirectionTolerance : kWrongSide;
  if (!(out.direction_error_rad > limit))
    return "";
  return fmt::format("direction error {:.3g} deg, limit {:.3g}", degrees(out.direction_error_rad),
                     degrees(limit));
}

std::string ContactValidator::torque_breach(const GapResult& gap,
                                            const ReportedContact& report) const {
  if (!(gap.sphere_radius_m > 0) || gap.direction.isZero())
    return "";
  if (report.latched || report.fallback || report.interior_hits > 0)
    return "";
  if (report.coherence < kDirectionFromCoherence)
    return "";
  const Vec3 centre = gap.nearest_dynamic + gap.sphere_radius_m * gap.direction;
  const Vec3 lever = centre - report.pose_WT.position;
  const double off_sphere =
      settings_.shell_offset_m + settings_.chord_error_m + kLeverSlack * settings_.edge_m;
  const double limit = gap.sphere_radius_m + off_sphere;
  const double off = (report.wrench.torque - lever.cross(report.wrench.force)).norm();
  if (off <= limit * report.wrench.force.norm())
    return "";
  return fmt::format(
      "the line of force is {:.3g} mm from the centre of the tool's sphere, limit {:.3g} mm",
      mm(off / report.wrench.force.norm()), mm(limit));
}

}  // namespace voxtouch::reference
