#include "core/contact/virtual_tool.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/contact/limits.hpp"
#include "core/contact/tool_friction.hpp"
#include "core/contact/wall_inside.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::contact {
namespace {

/// `turn` or the equivalent rotation in the other sense: near half a turn, the one nearer to the
/// last.
Vec3 keep_axis(const Vec3& turn, const Vec3& last) noexcept {
  const double angle = turn.norm();
  constexpr double kNearHalfATurn = 3.0;
  if (angle < kNearHalfATurn)
    return turn;
  const Vec3 other = (1.0 - 2.0 * std::numbers::pi / angle) * turn;
  return other.dot(last) > turn.dot(last) ? other : turn;
}

Quat turned(const Quat& by_last, const Vec3& turn) noexcept {
  const double angle = turn.norm();
  if (!(angle > 0.0))
    return by_last;
  const Quat by(Eigen::AngleAxisd(angle, turn / angle));
  return (by * by_last).normalized();
}

bool same(const Pose& a, const Pose& b) noexcept {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

Pose less(const Pose& pose, const Vec3& displacement) noexcept {
  return {pose.position - displacement, pose.orientation};
}

/// Multiples of a power of two, about 2^-26 e: a scene moved by multiples of e gives bit-identical
/// results.
Vec3 quantize(const Vec3& position, double edge) noexcept {
  const double step = std::ldexp(1.0, std::ilogb(edge) - 26);
  return {std::round(position.x() / step) * step, std::round(position.y() / step) * step,
          std::round(position.z() / step) * step};
}

/// length^2 / 2, continued linearly beyond the limit of the spring force.
double spring_energy(double length, double most) noexcept {
  return length <= most ? 0.5 * length * length : most * (length - 0.5 * most);
}

}  // namespace

Mat6 VirtualToolFrame::stiffness(double k) const noexcept {
  Vec6 scale;
  scale << Vec3::Ones(), Vec3::Constant(lever_m);
  return (fraction * k) * (scale.asDiagonal() * displayed * scale.asDiagonal());
}

VirtualTool::VirtualTool(const VirtualToolOptions& options) : options_(options) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  if (options_.lever_m == 0.0)
    options_.lever_m = options_.reach_m;
  if (!positive(options_.reach_m) || !positive(options_.edge_m) || !positive(options_.lever_m) ||
      options_.points == 0 || options_.objects == 0 || !(options_.fade_s >= 0.0) ||
      !std::isfinite(options_.fade_s))
    throw std::invalid_argument(
        "virtual tool: points, objects, reach, voxel edge and lever must be finite and above 0");
  hits_.reserve(std::max(options_.points, options_.edge_points));
  rows_.reserve(options_.points * options_.objects + options_.edge_points);
  others_.reserve(rows_.capacity());
  pushes_.resize(options_.objects);
  displacements_.resize(options_.objects, Vec3::Zero());
}

void VirtualTool::reset() noexcept {
  placed_ = rows_known_ = pressed_ = false;
  turn_ = Vec3::Zero();
}

/// Checks the pose like ContactQuery::find, and returns its normalised form bit-identically.
PoseStatus VirtualTool::status_of(Pose& hand, std::span<const ToolGround> grounds) const noexcept {
  Quat unit = hand.orientation;
  if (grounds.size() > options_.objects || !hand.position.allFinite() ||
      !normalise_within(unit, limits::kMinQuaternionNorm, limits::kMaxQuaternionNorm))
    return PoseStatus::kNotAPose;
  if (std::abs(hand.orientation.squaredNorm() - 1.0) > 1e-15)
    hand.orientation = unit;
  for (const ToolGround& ground : grounds) {
    const voxmap::Grid& grid = ground.query->voxmap().grid();
    const double farthest =
        (hand.position - ground.displacement - grid.origin).cwiseAbs().maxCoeff() +
        options_.reach_m;
    if (!(farthest / grid.edge < limits::kMaxGridCoordinate))
      return PoseStatus::kOutOfRange;
  }
  return PoseStatus::kUsable;
}

/// `position`: the tool's position minus the displacement of the object.
RowFrame VirtualTool::row_frame(const Vec3& position, std::span<const ToolGround> grounds,
                                std::size_t n) const noexcept {
  return {position - grounds[n].field->grid().origin, options_.lever_m,
          static_cast<std::uint32_t>(n)};
}

/// Computes all rows at `tool`, their energy and the values that the frame reports. `smooth`: the
/// tool may come to rest here.
void VirtualTool::look_up(const Pose& tool, std::span<const ToolGround> grounds, bool smooth,
                          VirtualToolFrame& out) noexcept {
  rows_.clear();
  ++out.queries;
  out.surface_hits = out.interior_hits = out.points_tested = 0;
  for (std::size_t n = 0; n < grounds.size(); ++n) {
    const ToolGround& ground = grounds[n];
    ground.query->find(less(tool, ground.displacement), hits_);
    if (hits_.pose_status != PoseStatus::kUsable)
      out.pose_status = hits_.pose_status;
    const RowFrame frame = row_frame(hits_.pose_WT.position, grounds, n);
    add_rows(hits_.surface, true, *ground.field, frame, rows_);
    add_rows(hits_.interior, false, *ground.field, frame, rows_);
    out.surface_hits += static_cast<std::uint32_t>(hits_.surface.size());
    out.interior_hits += static_cast<std::uint32_t>(hits_.interior.size());
    out.points_tested += hits_.tested;
    if (ground.edges == nullptr)
      continue;
    const Quat orientation = hits_.pose_WT.orientation, back = orientation.conjugate();
    ground.edges->find({back * -frame.local, back}, hits_);
    add_edge_rows(hits_, *ground.edges, *ground.tool_field, smooth, frame, orientation, rows_);
    out.points_tested += hits_.tested;
  }
  rows_energy_ = worst_depth_m_ = 0.0;
  for (const ConstraintRow& row : rows_) {
    const double depth = std::max(0.0, -row.gap_m);
    rows_energy_ += 0.5 * limits::kRowStiffness * depth * depth;
    worst_depth_m_ = std::max(worst_depth_m_, depth);
  }
  keep_nearest(rows_, limits::kToolStepEdges * options_.edge_m / options_.reach_m);
  for (std::size_t n = 0; smooth && n < grounds.size(); ++n)
    smooth_normals(*grounds[n].field,
                   row_frame(tool.position - grounds[n].displacement, grounds, n), rows_);
  rows_known_ = true;
}

/// Whether a wall of any object lies inside the tool.
bool VirtualTool::wall_inside(const Pose& tool, std::span<const ToolGround> grounds) noexcept {
  for (std::size_t n = 0; n < grounds.size(); ++n) {
    grounds[n].query->find(less(tool, grounds[n].displacement), hits_);
    if (wall_inside_tool(hits_.surface, *grounds[n].field,
                         row_frame(hits_.pose_WT.position, grounds, n).local))
      return true;
  }
  return false;
}

/// Starts the virtual tool at `tool` if that pose is outside all objects.
bool VirtualTool::start(const Pose& tool, std::span<const ToolGround> grounds,
                        VirtualToolFrame& out) noexcept {
  look_up(tool, grounds, true, out);
  placed_ = out.pose_status == PoseStatus::kUsable && out.interior_hits == 0 &&
            worst_depth_m_ <= limits::kPlacedDepthEdges * options_.edge_m &&
            !wall_inside(tool, grounds);
  if (!placed_)
    return rows_known_ = false;
  tool_ = tool;
  turn_ = Vec3::Zero();
  pressed_ = false;
  for (std::size_t n = 0; n < grounds.size(); ++n)
    displacements_[n] = grounds[n].displacement;
  return true;
}

bool VirtualTool::place(const Pose& tool, std::span<const ToolGround> grounds) noexcept {
  VirtualToolFrame out;
  reset();
  if (grounds.size() > options_.objects || !start(tool, grounds, out))
    return false;
  hand_ = tool;
  placed_s_ = options_.fade_s;
  return true;
}

/// Largest displacement of an object since the last frame [m]. The rows are invalid if any object
/// has moved.
double VirtualTool::objects_moved(std::span<const ToolGround> grounds) noexcept {
  double most = 0.0;
  for (std::size_t n = 0; n < grounds.size(); ++n) {
    most = std::max(most, (grounds[n].displacement - displacements_[n]).norm());
    displacements_[n] = grounds[n].displacement;
  }
  if (most > 0.0)
    rows_known_ = false;
  return most;
}

/// From the virtual tool to `hand`.
Vec6 VirtualTool::spring_to(const Pose& hand) noexcept {
  Vec6 spring;
  spring << hand.position - tool_.position,
      options_.lever_m * keep_axis(rotation_vector(tool_.orientation, hand.orientation), turn_);
  return spring;
}

/// Upper bound of the displacement of any tool point in a step `delta` [m].
double VirtualTool::length_of(const Vec6& delta) const noexcept {
  return delta.head<3>().norm() + delta.tail<3>().norm() * options_.reach_m / options_.lever_m;
}

/// Longest step from here that passes no wall [m].
double VirtualTool::longest_step(std::span<const ToolGround> grounds) const noexcept {
  const double edge = options_.edge_m;
  double longest = std::numeric_limits<double>::infinity();
  if (!rows_.empty())
    longest = 0.0;
  for (const ToolGround& ground : grounds) {
    const voxmap::Grid& grid = ground.query->voxmap().grid();
    const Vec3 u = (tool_.position - ground.displacement - grid.origin) / grid.edge;
    longest = std::min(
        longest, grid.edge * ground.query->voxmap().free_distance_voxels(u) - options_.reach_m);
  }
  return std::max(longest, limits::kToolStepEdges * edge);
}

EquilibriumStep VirtualTool::solve(const Vec6& spring, double friction) const noexcept {
  const EquilibriumStep free = equilibrium_step(rows_, spring);
  return friction > 0.0 ? with_friction(rows_, spring, options_.lever_m, friction, free) : free;
}

/// Returns to an earlier pose of this frame, whose rows are in `others_`.
void VirtualTool::go_back_to(const Kept& kept, VirtualToolFrame& out) noexcept {
  tool_ = kept.tool;
  rows_ = others_;  // equal capacity: no allocation
  rows_energy_ = kept.rows_energy, worst_depth_m_ = kept.worst_depth_m;
  out.surface_hits = kept.surface_hits, out.interior_hits = kept.interior_hits,
  out.points_tested = kept.points_tested;
}

/// Moves the virtual tool towards equilibrium with `hand`. \returns the last computed step, which
/// is not taken.
EquilibriumStep VirtualTool::follow(const Pose& hand, double friction,
                                    std::span<const ToolGround> grounds, const Reach& reach,
                                    VirtualToolFrame& out) noexcept {
  const double edge = options_.edge_m, pull = limits::kPullEdges * edge;
  const double rest = std::clamp(limits::kConvergenceRatio * reach.hand_m,
                                 limits::kRestEdges * edge, limits::kRestMostEdges * edge);
  double remaining_m = reach.tool_m;
  Kept best;
  blocked_ = false;
  int worse = 0;
  for (int queries = 0;; ++queries) {
    const Vec6 spring = spring_to(hand);
    const double length = spring.norm();
    const Vec6 cut = !rows_.empty() && length > pull ? Vec6(spring * (pull / length)) : spring;
    // Once the path is used up, remaining penetrations are resolved without further motion.
    const bool pulled = remaining_m > 0.1 * limits::kRestEdges * edge;
    const EquilibriumStep step =
        pulled ? solve(cut, friction) : equilibrium_step(rows_, Vec6::Zero());
    const double moved_m = length_of(step.delta);
    out.iterations += step.iterations;
    out.residual_m = moved_m;
    const bool rests =
        (moved_m < rest && (step.pushed || !pulled)) || (moved_m == 0.0 && same(tool_, hand));
    const bool done =
        queries >= (step.pushed ? limits::kMaxQueriesInContact : limits::kMaxQueries) || rests;
    const double energy = spring_energy(length, pull) + rows_energy_;
    const double bump = limits::kHysteresisRatio * reach.hand_m * std::min(length, pull);
    if (worse == 0 || energy <= best.energy + bump) {
      best = {tool_,
              energy,
              rows_energy_,
              worst_depth_m_,
              out.surface_hits,
              out.interior_hits,
              out.points_tested};
      worse = 0;
    } else if (done || worse >= limits::kMaxWorse) {
      go_back_to(best, out);
      blocked_ = true;
      return balance(hand, friction, out);
    }
    if (done)
      return pulled ? step : balance(hand, friction, out);
    const double most =
        pulled ? std::min(longest_step(grounds), remaining_m) : longest_step(grounds);
    const double fraction = moved_m <= most ? 1.0 : most / moved_m;
    if (worse++ == 0)
      others_ = rows_;
    if (pulled && !step.pushed && moved_m <= most && length <= pull) {
      tool_ = hand;
    } else {
      tool_.position = quantize(tool_.position + fraction * step.delta.head<3>(), options_.edge_m);
      tool_.orientation =
          turned(tool_.orientation, fraction * step.delta.tail<3>() / options_.lever_m);
    }
    look_up(tool_, grounds, moved_m <= limits::kSmoothPathEdges * edge, out);
    remaining_m -= fraction * moved_m;
  }
}

/// The step from the present pose: remaining spring and contact forces.
EquilibriumStep VirtualTool::balance(const Pose& hand, double friction,
                                     VirtualToolFrame& out) noexcept {
  const double pull = limits::kPullEdges * options_.edge_m;
  Vec6 spring = spring_to(hand);
  if (const double length = spring.norm(); !rows_.empty() && length > pull)
    spring *= pull / length;
  const EquilibriumStep step = solve(spring, friction);
  out.iterations += step.iterations;
  out.residual_m = length_of(step.delta);
  return step;
}

void VirtualTool::report_step(const EquilibriumStep& step, VirtualToolFrame& out) noexcept {
  out.tool = tool_;
  const Vec6 spring = spring_to(hand_);
  out.shift = spring.head<3>();
  out.turn = turn_ = spring.tail<3>() / options_.lever_m;
  out.worst_depth_m = worst_depth_m_;
  out.saturated = step.pushed && spring.norm() > limits::kPullEdges * options_.edge_m;
  if (step.pushed) {
    out.displayed = Mat6::Identity() - step.loose * step.hessian.inverse() * step.loose;
  } else if (blocked_) {
    out.displayed.setIdentity();  // no row determines the direction in which it yields: as without
                                  // contact
  }
  double most = 0.0;
  for (const ConstraintRow& row : rows_) {
    const double push = limits::kRowStiffness * depth_after(row, step.delta);
    if (!(push > 0.0))
      continue;
    ++out.rows;
    Wrench& sum = pushes_[row.object];
    sum.force += push * row.normal();
    sum.torque += push * row.arm.cross(row.normal());
    if (push <= most)
      continue;
    most = push;
    out.contact_point = tool_.position + row.arm;
    out.contact_normal = row.normal();
    out.contact_object = row.object;
  }
}

VirtualToolFrame VirtualTool::frame(const HandSample& sample,
                                    std::span<const ToolGround> grounds) noexcept {
  VirtualToolFrame out;
  out.lever_m = options_.lever_m;
  out.tool = tool_;
  out.not_initialised = !placed_;
  std::fill(pushes_.begin(), pushes_.end(), Wrench{});
  Pose hand = sample.pose;
  out.pose_status = status_of(hand, grounds);
  if (out.pose_status != PoseStatus::kUsable)
    return out;

  const double moved = placed_ ? objects_moved(grounds) : 0.0;
  out.moved_too_far = moved > limits::kToolStepEdges * options_.edge_m;
  if (!placed_) {
    if (!start(hand, grounds, out))
      return out;
    out.not_initialised = false;
    placed_s_ = 0.0;
    hand_ = hand;
  } else {
    placed_s_ += std::max(0.0, sample.period_s);
  }
  if (!rows_known_)
    look_up(tool_, grounds, true, out);

  Vec6 hand_path;
  hand_path << hand.position - hand_.position,
      options_.lever_m * rotation_vector(hand_.orientation, hand.orientation);
  Reach reach{length_of(hand_path) + moved, std::numeric_limits<double>::infinity()};
  if (pressed_)  // in contact the tool catches up slowly; in free space it is the hand
    reach.tool_m = reach.hand_m + std::max(limits::kCatchUpRatio * length_of(spring_to(hand)),
                                           limits::kSnapEdges * options_.edge_m);
  hand_ = hand;
  const EquilibriumStep step = follow(hand, std::max(0.0, sample.friction), grounds, reach, out);
  report_step(step, out);
  const bool free = same(tool_, hand);
  // Just in front of a face, with no point in its voxels, no row is active. The further motion was
  // tried and led into the wall.
  out.not_converged = !free && !step.pushed && !pressed_ && !blocked_;
  out.constrained = !free && !out.not_converged;
  pressed_ = out.constrained;
  if (!out.not_converged)
    out.fraction = options_.fade_s > 0.0 ? std::min(1.0, placed_s_ / options_.fade_s) : 1.0;
  return out;
}

}  // namespace voxtouch::contact
