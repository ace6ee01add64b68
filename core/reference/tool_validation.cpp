#include "core/reference/tool_validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::reference {
namespace {

/// The virtual tool's meshes are simplified by up to 5e-6 m each (exact/limits.hpp). The rest is
/// the margin at which the tool rests, and rounding [m].
constexpr double kSameSurface = 1.2e-5;
constexpr double kSettled = 2e-5, kShortSpring = 5e-4;  ///< [m]
/// Facets turn a direction by up to half the angle between them: 4 degrees for a ball of 642
/// points, 2.8 for a cylinder of 64 sides, and 0.4 for each simplified mesh.
constexpr double kDirection = 8.0 * std::numbers::pi / 180.0;
constexpr double kAlongSpring = 1e-6;  ///< rad
constexpr double kSamePose = 1e-12;    ///< m, and of a unit quaternion

double in_degrees(double radians) { return radians * 180.0 / std::numbers::pi; }
double in_mm(double metres) { return 1e3 * metres; }

double rotation_between(const Pose& a, const Pose& b) {
  return a.orientation.angularDistance(b.orientation);
}

bool same_pose(const ReportedTool& r) {
  const Quat tool = r.tool.orientation.normalized(), hand = r.hand.orientation.normalized();
  return (r.tool.position - r.hand.position).norm() <= kSamePose &&
         (!r.returns_torque || 1.0 - std::abs(tool.dot(hand)) <= kSamePose);
}

std::string state_breach(const ReportedTool& r) {
  const bool force = !r.wrench.zero();
  if (force && r.not_initialised)
    return fmt::format("a force of {:.3g} N without an initialised virtual tool",
                       r.wrench.force.norm());
  if (force && !r.constrained)
    return fmt::format("a force of {:.3g} N, but the virtual tool is unconstrained",
                       r.wrench.force.norm());
  if (!r.not_initialised && !r.not_converged && !r.constrained && !same_pose(r))
    return fmt::format(
        "the virtual tool is unconstrained, but {:.3g} mm and {:.3g} deg away from the hand",
        in_mm((r.tool.position - r.hand.position).norm()),
        in_degrees(rotation_between(r.tool, r.hand)));
  if (!force || r.wrench.force.isZero(0.0))
    return "";
  const double off = angle_between(r.wrench.force, r.tool.position - r.hand.position);
  if (off > kAlongSpring && (r.tool.position - r.hand.position).norm() > kSamePose)
    return fmt::format("direction error to the spring {:.3g} deg", in_degrees(off));
  return "";
}

}  // namespace

std::string tool_breach(const ValidatorSettings& s, const ToolSettings& tool,
                        const GapResult& at_tool, const GapResult& at_hand, const ReportedTool& r,
                        Validation& out) {
  if (!r.tool.finite() || !r.hand.finite() || !r.wrench.finite() || !std::isfinite(r.residual_m))
    return "the contact has NaN or infinity";
  if (std::string found = state_breach(r); !found.empty())
    return found;
  if (r.not_initialised || r.not_converged)
    return "";
  const double near = kSameSurface + s.chord_error_m;
  const bool force = !r.wrench.zero(), settled = r.residual_m <= kSettled;
  if (!force) {
    const double gap = r.returns_torque ? at_hand.gap_m : at_tool.gap_m;
    if (-gap > near)
      return fmt::format("no force, but the hand's tool is {:.3g} mm inside", in_mm(-gap));
    return "";
  }
  const Vec3 shift = r.hand.position - r.tool.position;
  out.depth_error_m = -at_tool.gap_m;
  if (-at_tool.gap_m > near)
    return fmt::format("the virtual tool is {:.3g} mm inside, limit {:.3g} mm",
                       in_mm(-at_tool.gap_m), in_mm(near));
  const double off = near + r.residual_m;
  if (at_tool.gap_m > off)
    return fmt::format(
        "a force of {:.3g} N, but the virtual tool is {:.3g} mm off the surface, limit {:.3g} mm",
        r.wrench.force.norm(), in_mm(at_tool.gap_m), in_mm(off));
  const double displacement = shift.norm() + tool.reach_m * rotation_between(r.tool, r.hand);
  if (settled && at_hand.gap_m > displacement + near)
    return fmt::format(
        "a force of {:.3g} N, but nothing is between virtual tool and hand, which is {:.3g} mm off "
        "the surface",
        r.wrench.force.norm(), in_mm(at_hand.gap_m));
  if (!at_tool.unique_face || at_tool.direction.isZero() || tool.rubs || !settled ||
      shift.norm() < kShortSpring)
    return "";
  out.direction_error_rad = angle_between(r.wrench.force, at_tool.direction);
  if (out.direction_error_rad > kDirection)
    return fmt::format("direction error to the contact normal {:.3g} deg, limit {:.3g}",
                       in_degrees(out.direction_error_rad), in_degrees(kDirection));
  return "";
}

Validation ContactValidator::validate(const GapResult& at_tool, const GapResult& at_hand,
                                      const ToolSettings& tool, const ReportedTool& report) {
  Validation out;
  run_ = {};
  const bool known = at_tool.method != GapMethod::kNone && at_hand.method != GapMethod::kNone &&
                     std::isfinite(at_tool.gap_m) && std::isfinite(at_hand.gap_m);
  const bool checked = at_tool.self_check && at_hand.self_check;
  if (!known) {
    out.cause = Cause::kReference, out.explanation = "the reference has no gap for this pose";
  } else {
    out.explanation = tool_breach(settings_, tool, at_tool, at_hand, report, out);
    out.decided = checked;
    conclude(checked, out);
  }
  count(out);
  return out;
}

}  // namespace voxtouch::reference
