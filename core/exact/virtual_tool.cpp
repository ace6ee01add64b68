#include "core/exact/virtual_tool.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/exact/limits.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::exact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Near 180 degrees, `rotation` or the equal one about the opposite axis: the one nearer to `last`.
Vec3 keep_axis(const Vec3& rotation, const Vec3& last) noexcept {
  constexpr double kNear180Degrees = 3.0;
  const double angle = rotation.norm();
  if (angle < kNear180Degrees)
    return rotation;
  const Vec3 other = (1.0 - 2.0 * std::numbers::pi / angle) * rotation;
  return other.dot(last) > rotation.dot(last) ? other : rotation;
}

/// `pose` after a displacement. The position is rounded to a lattice, so that adding and
/// subtracting multiples of its step gives bit-identical positions.
Pose moved(const Pose& pose, const Vec3& shift, const Vec3& rotation) noexcept {
  const Vec3 there = (pose.position + shift) / limits::kLatticeM;
  Pose out{limits::kLatticeM * there.array().round().matrix(), pose.orientation};
  const double angle = rotation.norm();
  if (!(angle > 0.0))
    return out;
  const Quat by(Eigen::AngleAxisd(angle, rotation / angle));
  out.orientation = (by * pose.orientation).normalized();
  return out;
}

bool positive(double x) noexcept { return std::isfinite(x) && x > 0.0; }

VirtualToolOptions with_lever(VirtualToolOptions options, double reach_m) noexcept {
  if (options.lever_m == 0.0)
    options.lever_m = reach_m;
  return options;
}

}  // namespace

Mat6 VirtualToolFrame::stiffness(double k) const noexcept {
  Vec6 scale;
  scale << Vec3::Ones(), Vec3::Constant(lever_m);
  return (ratio * k) * (scale.asDiagonal() * displayed * scale.asDiagonal());
}

VirtualTool::VirtualTool(const ToolBody& tool, std::span<const ObjectBody* const> objects,
                         const VirtualToolOptions& options)
    : options_(with_lever(options, tool.features().reach_m)),
      reach_m_(tool.features().reach_m),
      contacts_(tool, objects, options_.pair_capacity, options_.lever_m),
      objects_before_(objects.size()),
      forces_(contacts_.owners()) {
  if (objects.empty() || !positive(reach_m_) || !positive(options_.lever_m) ||
      !std::isfinite(options_.fade_s) || options_.fade_s < 0.0)
    throw std::invalid_argument(
        "virtual tool: needs objects, and reach, lever and fade that are finite");
}

void VirtualTool::reset() noexcept {
  placed_ = pressed_ = converged_ = false;
  start_ = {};
  rotation_ = Vec3::Zero();
  longest_step_m_ = 0.0;
  last_ = {};
}

/// Validates the input and normalises the quaternion; one of unit norm stays bit-identical.
PoseStatus VirtualTool::check(Pose& hand, std::span<const Pose> objects) const noexcept {
  Quat unit = hand.orientation;
  if (objects.size() != contacts_.size() || !hand.position.allFinite() ||
      !normalise_within(unit, limits::kMinQuaternionNorm, limits::kMaxQuaternionNorm))
    return PoseStatus::kNotAPose;
  if (std::abs(hand.orientation.squaredNorm() - 1.0) > 1e-15)
    hand.orientation = unit;
  bool within = hand.position.cwiseAbs().maxCoeff() < limits::kMaxCoordinateM;
  for (const Pose& object : objects)
    within &= object.finite() && object.position.cwiseAbs().maxCoeff() < limits::kMaxCoordinateM;
  return within ? PoseStatus::kUsable : PoseStatus::kOutOfRange;
}

/// Bound of the displacement of each point of the tool in a step `delta` [m].
double VirtualTool::length_of(const Vec6& delta) const noexcept {
  return delta.head<3>().norm() + delta.tail<3>().norm() * reach_m_ / options_.lever_m;
}

Vec6 VirtualTool::spring_between(const Pose& tool, const Pose& hand) const noexcept {
  Vec6 spring;
  spring << hand.position - tool.position,
      options_.lever_m * keep_axis(rotation_vector(tool.orientation, hand.orientation), rotation_);
  return spring;
}

Vec6 VirtualTool::spring_to(const Pose& hand) const noexcept {
  return spring_between(contacts_.tool(), hand);
}

/// Whether a step shortens the spring s enough: full steps may oscillate between curved rows.
/// Armijo's rule (Nocedal and Wright 2006, 3.1); restoring a missing margin m may lengthen s:
///
///     (|s|^2 - |s'|^2) / 2 + 2 m |s| >= kArmijoRatio |taken|^2     [m^2]
bool VirtualTool::shortens(const Vec6& spring, const Vec6& taken, const Pose& tool,
                           const Pose& hand) const noexcept {
  double missing = 0.0;
  for (const Row& row : contacts_.rows())
    missing = std::max(missing, std::min(limits::kMarginM - row.gap_m, limits::kMaxMarginRestoreM));
  const double falls = 0.5 * (spring.squaredNorm() - spring_between(tool, hand).squaredNorm());
  return falls + 2.0 * missing * spring.norm() >= limits::kArmijoRatio * taken.squaredNorm();
}

void VirtualTool::relocate() noexcept {
  if (!placed_)
    return;
  start_ = {.before = contacts_.tool(), .returns = true};
  const std::span<const Pose> objects = contacts_.objects();
  std::copy(objects.begin(), objects.end(), objects_before_.begin());
  placed_ = false;
}

void VirtualTool::start_at(const Pose& tool) noexcept {
  reset();
  start_ = {.pose = tool, .given = true, .whole_force = true};
}

/// Ends a start whose pose is not valid. Returns true if the tool continues from its last pose.
bool VirtualTool::start_is_blocked() noexcept {
  const Start blocked = start_;
  start_ = {};
  if (!blocked.returns)
    return false;
  contacts_.put(blocked.before, objects_before_);
  placed_ = pressed_ = true;
  placed_s_ = 0.0;
  return true;
}

/// Continues the check of a start, with tool and objects where they were when it began. Returns
/// true once the tool is initialised and all lists are complete.
bool VirtualTool::initialise(const Pose& hand, std::span<const Pose> objects, Work& work) noexcept {
  if (!start_.begun) {
    start_.begun = true;
    contacts_.put(start_.given ? start_.pose : hand, objects);
  }
  const double need = limits::kMinReachM + 3.0 * limits::kMarginM;
  for (Opposite& opposite : contacts_.opposites()) {
    const StartVerdict verdict =
        opposite.start_check().advance(opposite.tool(), opposite.object(), opposite.now(), work);
    if (verdict == StartVerdict::kPending)
      return false;
    if (verdict == StartVerdict::kBlocked)
      return start_is_blocked();
    opposite.renew(need, limits::kListReaches * need + limits::kListRestM, work);
    if (opposite.allowed_m() < need)
      return false;
    if (opposite.nearest_m() < limits::kStartGapM)
      return start_is_blocked();
  }
  placed_s_ = start_.whole_force ? options_.fade_s : 0.0;
  start_ = {};
  placed_ = true;
  return true;
}

bool VirtualTool::place(const Pose& tool, std::span<const Pose> objects) noexcept {
  Pose pose = tool;
  reset();
  Work work;
  if (check(pose, objects) != PoseStatus::kUsable)
    return false;
  start_at(pose);
  if (!initialise(pose, objects, work))
    return false;
  hand_ = pose;
  return true;
}

/// Renews the lists for rows within `rows_m` and sets the largest step of this query: `need_m` if
/// all these rows are known, since pairs beyond them are checked once the step is known.
void VirtualTool::reach_of_query(double need_m, double rows_m, Query& query, Work& work) noexcept {
  const double rest = 3.0 * limits::kMarginM;  // rows within it beyond the reach push, and rounding
  double allowed = kInfinity, nearest = kInfinity;
  for (Opposite& opposite : contacts_.opposites()) {
    opposite.renew(rows_m + rest, limits::kListReaches * rows_m + limits::kListRestM, work);
    allowed = std::min(allowed, opposite.allowed_m());
    nearest = std::min(nearest, opposite.nearest_m());
  }
  allowed = std::max(0.0, allowed - rest);
  query.rows_m = std::min(rows_m, allowed);
  query.lists_m = allowed < rows_m ? allowed : need_m;
  if (nearest > allowed + rest)
    query.lists_m = std::max(query.lists_m, allowed);
}

/// Projects `target` on the rows. `rotation_rad`: expected rotation of the step; the point of a row
/// leaves its tangent by at most rotation^2 |arm| / 2 (Taylor). `restore_margin`: rows nearer than
/// the margin require the tool to move out. Otherwise their gap must not decrease, which the zero
/// step fulfils unless an object moves.
Projection VirtualTool::solve_with(const Vec6& target, double rotation_rad, bool restore_margin,
                                   VirtualToolFrame& out, Work& work) noexcept {
  const double most = restore_margin ? limits::kMaxMarginRestoreM : 0.0;
  const std::span<const Row> rows = contacts_.rows();
  const std::span<Halfspace> halfspaces = contacts_.halfspaces();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    const double bend = 0.5 * rotation_rad * rotation_rad * row.arm.norm();
    halfspaces[k].least_m =
        std::min(limits::kMarginM - row.gap_m, most) + row.closes_m + row.missed_m + bend;
  }
  const Projection projection = project(halfspaces, target, work);
  out.iterations += projection.iterations;
  return projection;
}

void VirtualTool::limit_to(double ratio, Work& work) const noexcept {
  work.set_limit(static_cast<std::uint64_t>(ratio * static_cast<double>(options_.max_work)));
}

/// Projects `target` on the rows without curvature, in `last_`; a zero step if that fails.
void VirtualTool::solve(const Vec6& target, VirtualToolFrame& out, Work& work) noexcept {
  last_ = solve_with(target, 0.0, true, out, work);
  if (!last_.feasible)
    last_ = solve_with(target, 0.0, false, out, work);
  if (!last_.feasible || !last_.converged)
    last_.delta.setZero();
}

/// The step nearest to `step` that satisfies all rows with their curvature; a shortened step would
/// restore only a part of the missing margins. Returns `step` if there is none.
Vec6 VirtualTool::kept_by_rows(const Vec6& step, VirtualToolFrame& out, Work& work) noexcept {
  const double rotation = step.tail<3>().norm() / options_.lever_m;
  Projection kept = solve_with(step, rotation, true, out, work);
  if (!kept.feasible)
    kept = solve_with(step, rotation, false, out, work);
  return kept.feasible && kept.converged ? kept.delta : step;
}

/// Reduces the step in `last_` to the part that friction allows.
void VirtualTool::hold_by_friction(const Vec6& spring, double friction) noexcept {
  loose_.setIdentity();
  if (!(friction > 0.0) || last_.count == 0)
    return;
  std::array<FrictionContact, 6> contacts;
  for (std::size_t k = 0; k < last_.count; ++k) {
    const Row& row = contacts_.rows()[last_.active[k]];
    contacts[k] = {row.normal, row.arm, last_.forces_m[k]};
  }
  const FrictionStep held = with_friction({contacts.data(), last_.count}, contacts_.halfspaces(),
                                          spring, last_.delta, options_.lever_m, friction);
  last_.delta = held.delta;
  loose_ = held.loose;
}

/// Whether the tried step, of length `path_m`, cannot touch a pair without rows. If it may, the
/// query requests more rows. If that is unknown, the query is limited to the reach of the rows.
bool VirtualTool::clear_beyond_rows(Opposite& opposite, double path_m, Query& query,
                                    Work& work) noexcept {
  const double seen = query.rows_m + 2.0 * limits::kMarginM;
  if (path_m <= seen)
    return true;
  const StepVerdict verdict = opposite.check_step(path_m + limits::kMarginM, seen, work);
  query.more_rows = verdict == StepVerdict::kMayTouch;
  if (verdict != StepVerdict::kUnknown)
    return !query.more_rows;
  query.lists_m = query.rows_m;
  query.reach_m = std::min(query.reach_m, query.lists_m);
  return false;
}

/// Records the largest decrease of a gap, from which the next frame derives the reach of its rows.
void VirtualTool::note_closing(const Vec6& taken) noexcept {
  for (const Halfspace& row : contacts_.halfspaces())
    closing_m_ = std::max(closing_m_, -row.jacobian.dot(taken));
}

/// Takes the step if it is within the limits of the query and no features pass through each other.
bool VirtualTool::try_step(const Pose& tool, const Vec6& taken, Query& query, VirtualToolFrame& out,
                           Work& work) noexcept {
  limit_to(limits::kBeyondRatio, work);
  contacts_.try_step(tool);
  bool listed = true;
  for (Opposite& opposite : contacts_.opposites()) {
    const double path = opposite.path_between(opposite.now().pose(), opposite.next().pose());
    listed = listed && path <= query.lists_m + limits::kMarginM &&
             clear_beyond_rows(opposite, path, query, work);
  }
  limit_to(1.0, work);
  if (!listed || contacts_.passes_something(taken, work)) {
    ++out.rejected_steps;
    return false;
  }
  contacts_.accept();
  return true;
}

/// Computes the step with rows and friction, in `last_`. Returns the fraction of it within the
/// limits of the query.
double VirtualTool::solve_query(const Query& query, const Vec6& spring, VirtualToolFrame& out,
                                Work& work) noexcept {
  limit_to(limits::kProjectionRatio, work);
  solve(spring, out, work);
  hold_by_friction(spring, query.friction);
  out.residual_m = length_of(last_.delta);
  const double limit = std::min(query.reach_m, std::max(0.0, query.remaining_m));
  const double ratio = out.residual_m > limit ? limit / out.residual_m : 1.0;
  // The curvature of rows moves the tool farther than the straight step.
  const double rotation = ratio * last_.delta.tail<3>().norm() / options_.lever_m;
  const double bent = ratio * out.residual_m + 0.5 * rotation * rotation * reach_m_;
  return last_.count > 0 && bent > limit ? ratio * limit / bent : ratio;
}

/// Computes a step and takes the part of it that the query allows, halved until it is valid.
/// Returns the length of the step taken [m]; 0: none.
double VirtualTool::step(Query& query, VirtualToolFrame& out, Work& work) noexcept {
  const Vec6 spring = spring_to(query.hand);
  const bool objects_move = query.objects_ratio > 0.0;
  double ratio = solve_query(query, spring, out, work);
  converged_ = out.residual_m < query.convergence_m && !objects_move &&
               (last_.count > 0 || out.residual_m == 0.0);
  if (converged_ && last_.count > 0)
    return 0.0;
  if (!objects_move && last_.count > 0) {
    const double expected = last_residual_m_ - limits::kSettlingRatio * last_step_m_;
    if (last_step_m_ > 0.0 && out.residual_m < limits::kSettlingM && out.residual_m > expected)
      damping_ *= 0.5;
    last_residual_m_ = out.residual_m;
    last_step_m_ = 0.0;
    converged_ = damping_ < limits::kLeastDamping;
    if (converged_)
      return 0.0;
  }
  double scale = damping_;
  for (int attempt = 0; attempt < limits::kMaxAttempts && !work.done(); ++attempt) {
    if (attempt == 1 && scale == damping_)
      ratio = solve_query(query, spring, out, work);
    const bool whole = last_.count == 0 && scale * ratio == 1.0 && attempt == 0;
    Vec6 taken = scale * ratio * last_.delta;
    limit_to(limits::kProjectionRatio, work);
    if (!whole)
      taken = kept_by_rows(taken, out, work);
    limit_to(1.0, work);
    const Pose tool =
        whole ? query.hand
              : moved(contacts_.tool(), taken.head<3>(), taken.tail<3>() / options_.lever_m);
    const bool shorter = objects_move || whole || shortens(spring, taken, tool, query.hand);
    if (shorter && try_step(tool, taken, query, out, work)) {
      note_closing(taken);
      return length_of(taken);
    }
    if (query.more_rows)
      return 0.0;
    if (shorter && attempt == 0)
      continue;  // again with the rows of the features that would pass
    scale *= 0.5;
    if (!objects_move)
      continue;
    contacts_.plan_objects(scale * query.objects_ratio);
    contacts_.renew_closes();
  }
  return 0.0;
}

/// Collects pairs and rows for the largest step that work and memory allow. Returns false if they
/// allow none.
bool VirtualTool::collect_for(Query& query, double objects_m, Work& work) noexcept {
  for (;; query.lists_m *= 0.5) {
    query.objects_ratio = 0.0;
    query.reach_m = query.lists_m;
    if (objects_m > 0.0) {
      query.objects_ratio = std::min(1.0, limits::kObjectsReachRatio * query.lists_m / objects_m);
      query.reach_m = query.lists_m - query.objects_ratio * objects_m;
    }
    contacts_.plan_objects(query.objects_ratio);
    query.rows_m = std::min(query.rows_m, query.lists_m);
    if (contacts_.collect(query.rows_m, work))
      return true;
    if (query.lists_m < limits::kRestM || work.done())
      return false;
    query.lists_m = std::min(query.lists_m, query.rows_m);
  }
}

/// Moves the tool towards the hand by queries, until it has converged or a limit ends the frame:
/// number of queries, work, or, in contact, a path proportional to that of the hand.
void VirtualTool::follow(const HandSample& sample, double hand_path_m, VirtualToolFrame& out,
                         Work& work) noexcept {
  double remaining = kInfinity;
  if (pressed_) {
    const double catch_up = limits::kCatchUpRatio * length_of(spring_to(sample.pose));
    remaining = limits::kFollowRatio * hand_path_m + std::max(catch_up, limits::kCatchUpM);
  }
  Query query{.hand = sample.pose, .friction = sample.friction};
  query.convergence_m = std::max(limits::kRestM, limits::kMovingRestRatio * hand_path_m);
  double expected =
      std::clamp(limits::kReachRatio * longest_step_m_, limits::kMinReachM, limits::kMaxReachM);
  const double closing = closing_m_;
  all_rows_frames_ = std::max(0, all_rows_frames_ - 1);
  double longest = 0.0;
  closing_m_ = 0.0;
  converged_ = false;
  while (out.queries < limits::kMaxQueries) {
    out.queries += !query.more_rows;
    const double objects = contacts_.object_path();
    if (objects == 0.0 && same(contacts_.tool(), sample.pose)) {
      converged_ = true;
      last_ = {};
      break;
    }
    const double requested = length_of(spring_to(sample.pose)) + objects;
    all_rows_frames_ = query.more_rows ? limits::kAllRowsFrames : all_rows_frames_;
    const bool all = objects > 0.0 || all_rows_frames_ > 0;
    double need = all ? std::min(expected, requested)
                      : std::min({requested, std::max(expected, remaining), limits::kMaxReachM});
    if (objects > 0.0)  // room for the objects' whole displacement
      need = std::max(need, std::min(objects / limits::kObjectsReachRatio, limits::kMaxReachM));
    limit_to(limits::kRenewalRatio, work);
    // If an object moves, a row may close from any distance.
    const double closes = std::max(limits::kReachRatio * closing, limits::kMinReachM);
    const double rows = all ? need : std::min(need, closes);
    query.more_rows = false;
    reach_of_query(need, rows, query, work);
    if (objects > 0.0)
      remaining += objects;
    query.remaining_m = remaining;
    limit_to(limits::kPairsRatio, work);
    if (!collect_for(query, objects, work))
      break;
    out.rows_seen = std::max(out.rows_seen, static_cast<std::uint32_t>(contacts_.rows().size()));
    out.pairs_seen = std::max(out.pairs_seen, static_cast<std::uint32_t>(contacts_.pairs()));
    const double path_m = step(query, out, work);
    if (query.more_rows && !work.done())
      continue;
    last_step_m_ = path_m;
    longest = std::max(longest, path_m);
    remaining -= path_m;
    limit_to(limits::kWidenRatio, work);
    if (path_m > 0.9 * query.reach_m && !work.done())
      expected = std::min(2.0 * expected, limits::kMaxReachM);
    if (converged_ || (path_m == 0.0 && objects == 0.0))
      break;
    if (remaining < limits::kRestM && contacts_.object_path() == 0.0) {
      converged_ = true;  // the path of this frame is used up
      break;
    }
  }
  limit_to(limits::kRenewalRatio, work);
  out.cut_short = !converged_ && work.done();
  out.object_delay_m = contacts_.object_path();
  longest_step_m_ = longest;
}

/// Coherence of the rows that touch, with or without a force: a tool that fills a slot touches both
/// walls.
double VirtualTool::coherence_of_rows() const noexcept {
  Vec3 normals = Vec3::Zero();
  int touching = 0;
  for (const Row& row : contacts_.rows())
    if (row.gap_m <= limits::kCoherentGapM)
      normals += row.normal, ++touching;
  return touching > 0 ? normals.norm() / touching : 1.0;
}

void VirtualTool::report(VirtualToolFrame& out) noexcept {
  out.tool = contacts_.tool();
  const Vec6 spring = spring_to(hand_);
  out.shift = spring.head<3>();
  rotation_ = spring.tail<3>() / options_.lever_m;
  out.rotation = rotation_;
  const bool free = same(contacts_.tool(), hand_);
  if (free)
    last_ = {};
  if (last_.count == 0)
    loose_.setIdentity();
  double most = 0.0;
  out.coherence = last_.count > 0 ? coherence_of_rows() : 1.0;
  for (std::size_t k = 0; k < last_.count; ++k) {
    const Row& row = contacts_.rows()[last_.active[k]];
    const double force = last_.forces_m[k];
    Wrench& sum = forces_[row.owner];
    sum.force += force * row.normal;
    sum.torque += force * row.arm.cross(row.normal);
    ++out.rows;
    if (force <= most)
      continue;
    most = force;
    out.contact_point = contacts_.objects()[row.object] * row.on_object;
    out.contact_normal = row.normal;
    out.contact_owner = row.owner;
  }
  const bool unfinished = !free && last_.count == 0 && !pressed_;
  out.constrained = !free && !unfinished;
  out.not_converged = !converged_;
  if (out.constrained) {
    // Without an active row no direction is known to be free, so all are displayed as stiff.
    const Mat6 unconstrained =
        last_.count > 0 ? Mat6(Mat6::Identity() - last_.held) : Mat6(Mat6::Zero());
    out.displayed = Mat6::Identity() - loose_ * unconstrained * loose_;
  }
  pressed_ = out.constrained;
  if (!unfinished)
    out.ratio = options_.fade_s > 0.0 ? std::min(1.0, placed_s_ / options_.fade_s) : 1.0;
}

VirtualToolFrame VirtualTool::frame(const HandSample& sample,
                                    std::span<const Pose> objects) noexcept {
  VirtualToolFrame out;
  out.lever_m = options_.lever_m;
  out.tool = contacts_.tool();
  out.not_initialised = !placed_;
  std::fill(forces_.begin(), forces_.end(), Wrench{});
  HandSample hand = sample;
  out.pose_status = check(hand.pose, objects);
  if (out.pose_status != PoseStatus::kUsable)
    return out;

  Work work(options_.max_work);
  if (placed_) {
    placed_s_ += std::max(0.0, sample.period_s);
  } else {
    const bool whole = initialise(hand.pose, objects, work);
    out.work = work.used();
    if (!whole)
      return out;
    out.not_initialised = false;
    hand_ = hand.pose;
  }
  contacts_.set_targets(objects);
  Vec6 hand_step;
  hand_step << hand.pose.position - hand_.position,
      options_.lever_m * rotation_vector(hand_.orientation, hand.pose.orientation);
  if (!same(hand_, hand.pose) || contacts_.objects_move()) {
    damping_ = 1.0;
    last_step_m_ = 0.0;
  }
  hand_ = hand.pose;
  follow(hand, length_of(hand_step), out, work);
  out.work = work.used();
  report(out);
  if (out.object_delay_m > limits::kMaxObjectDelayM) {
    out.passed_through = out.not_initialised = true;
    out.ratio = 0.0;
    reset();
  }
  return out;
}

}  // namespace voxtouch::exact
