#include "core/reference/god_object.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/reference/least_distance.hpp"
#include "core/reference/mesh_distance.hpp"
#include "core/reference/near_parts.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::reference {
namespace {

// Ratios of the tool's reach.
constexpr double kLongestStep = 0.01;
constexpr double kMarginOnTheWay = 1e-4, kMarginAtRest = 5e-6;
constexpr double kRestStep = 1e-7;

constexpr double kClosestRatio = 0.5;   ///< of the margin: nearer is a meeting
constexpr double kStrictRatio = 0.999;  ///< of the present distance, once the energy stays
constexpr int kStepsWithoutGain = 10;   ///< until then
constexpr double kRangeSteps = 3.0;     ///< range of the near parts, in longest steps

constexpr int kStepsOfHand = 8, kStepsOnTheWay = 300, kStepsAtRest = 3000;
constexpr int kMaxMeetings = 200, kMaxRescalings = 5;

Quat rotation_by(const Vec3& vector) {
  const double angle = vector.norm();
  return angle > 0.0 ? Quat(Eigen::AngleAxisd(angle, vector / angle)) : Quat::Identity();
}

}  // namespace

struct GodObject::Solver {
  Solver(const ReferenceMesh& tool, const ReferenceMesh& scene, double lever)
      : near(tool, scene, range(tool)),
        tool_distance(tool),
        scene_distance(scene),
        lever_m(lever > 0.0 ? lever : near.tool_reach_m()),
        step_m(kLongestStep * near.tool_reach_m()) {}

  static double range(const ReferenceMesh& tool) {
    double reach = 0.0;
    for (const Vec3& vertex : tool.vertices)
      reach = std::max(reach, vertex.norm());
    return kRangeSteps * kLongestStep * reach;
  }
  double scaled(double ratio) const { return ratio * near.tool_reach_m(); }

  bool place(const Pose& at) {
    pose = at;
    pose.orientation.normalize();
    near.move_to(pose);
    step_m = scaled(kLongestStep);
    steps = 0;
    const double apart = near.distance_m();
    margin_m = std::min(apart, scaled(kMarginOnTheWay));
    return apart > scaled(kMarginAtRest);
  }

  Vec6 spring(const Pose& hand, const Pose& tool) const {
    Vec6 d;
    d << hand.position - tool.position,
        lever_m * rotation_vector(tool.orientation, hand.orientation);
    return d;
  }
  Pose moved(const Vec6& by) const {
    return {pose.position + by.head<3>(),
            (rotation_by(by.tail<3>() / lever_m) * pose.orientation).normalized()};
  }
  double length(const Vec6& step) const {
    return step.head<3>().norm() + near.tool_reach_m() / lever_m * step.tail<3>().norm();
  }

  /// The condition on the step that keeps the parts of `meeting` a margin apart at its end, to
  /// first order.
  Inequality inequality(const Meeting& meeting, const Vec6& step) const {
    const Vec3 normal = meeting.at.direction();
    const Vec3 arm = meeting.at.mine - pose.position - meeting.time * step.head<3>();
    Inequality out;
    out.normal << normal, arm.cross(normal) / lever_m;
    const double bound = margin_m - meeting.at.distance_m + meeting.time * out.normal.dot(step);
    out.bound = std::min(bound, (1.0 - kClosestRatio) * margin_m);
    return out;
  }

  struct Projected {
    Vec6 step = Vec6::Zero();
    double margin_cost =
        0.0;  ///< rise of |d|^2 / 2 that restoring the margin costs, to first order
    bool solved = false;
  };

  /// The projection of `d`, shortened to the longest step. Bounds hold for the shortened step.
  Projected project(const Vec6& d, const std::vector<Inequality>& limits) const {
    const double scale = std::max(d.norm(), margin_m);
    Projected out;
    double ratio = 1.0;
    for (int n = 0; n < kMaxRescalings; ++n) {
      std::vector<Inequality> rows = limits;
      for (Inequality& row : rows)
        row.bound = (row.bound / ratio - row.normal.dot(d)) / scale;
      const LeastDistance found = least_distance(rows);
      if (!found.solved)
        return {};
      const Vec6 whole = d + scale * found.x;
      const double next = std::min(1.0, step_m / std::max(length(whole), 1e-300));
      out.step = next * whole;
      out.margin_cost = 0.0;
      for (std::size_t k = 0; k < limits.size(); ++k)
        out.margin_cost += scale * found.multipliers[k] * std::max(limits[k].bound, 0.0);
      if (std::abs(next - ratio) <= 1e-6 * ratio)
        break;
      ratio = next;
    }
    out.solved = true;
    return out;
  }

  /// A step on which nothing meets; unsolved if there is none of this length.
  Projected free_step(const Vec6& d) {
    const double closest =
        strict ? kStrictRatio * std::min(near.distance_m(), margin_m) : kClosestRatio * margin_m;
    std::vector<Inequality> limits;
    for (int n = 0; n < kMaxMeetings; ++n) {
      Projected projected = project(d, limits);
      if (!projected.solved && !limits.empty()) {
        for (Inequality& limit : limits)
          limit.bound = std::min(limit.bound, 0.0);
        projected = project(d, limits);
      }
      if (!projected.solved)
        return {};
      const auto meeting = near.first_meeting(moved(projected.step), closest);
      if (!meeting)
        return projected;
      const Inequality limit = inequality(*meeting, projected.step);
      if (limit.normal.dot(projected.step) >= limit.bound - 1e-9 * margin_m)
        return {};  // already satisfied: the rotation bends the path too much
      limits.push_back(limit);
    }
    return {};
  }

  /// One step towards the hand. \returns its length [m], 0 if there is none.
  double step(const Pose& hand) {
    const Vec6 d = spring(hand, pose);
    while (step_m > scaled(kRestStep)) {
      const Projected projected = free_step(d);
      if (projected.solved) {
        const Pose next = moved(projected.step);
        const double rise = 0.5 * (spring(hand, next).squaredNorm() - d.squaredNorm());
        if (rise <= projected.margin_cost) {
          pose = next;
          near.move_to(pose);
          step_m = std::min(2.0 * step_m, longest_m);
          ++steps;
          return length(projected.step);
        }
      }
      step_m *= 0.5;
    }
    return 0.0;
  }

  /// Gaps may shrink to a fraction of the margin, which later steps restore at the cost of energy.
  /// If both alternate, gaps may not shrink, and then steps become shorter. \returns whether the
  /// last step was shorter than `convergence_m`.
  bool steps_to(const Pose& hand, int most, double convergence_m) {
    step_m = longest_m = scaled(kLongestStep);
    strict = false;
    double least = spring(hand, pose).squaredNorm();
    int without_gain = 0;
    for (int n = 0; n < most; ++n) {
      if (step(hand) < convergence_m)
        return true;
      const double energy = spring(hand, pose).squaredNorm();
      without_gain = energy < least ? 0 : without_gain + 1;
      least = std::min(least, energy);
      if (without_gain <= kStepsWithoutGain)
        continue;
      if (strict)
        longest_m *= 0.5;
      strict = true;
      without_gain = 0;
    }
    return false;
  }

  GodObjectRest settle(const Pose& hand) {
    steps_to(hand, kStepsOnTheWay, scaled(1e2 * kRestStep));
    margin_m = std::min(margin_m, scaled(kMarginAtRest));
    GodObjectRest out;
    out.settled = steps_to(hand, kStepsAtRest, scaled(kRestStep));
    const Vec6 d = spring(hand, pose);
    out.tool = pose;
    out.shift = d.head<3>();
    out.rotation = d.tail<3>() / lever_m;
    out.lever_m = lever_m;
    out.steps = steps;
    out.apart_m = scene_distance.to(tool_distance, pose).distance_m;
    return out;
  }

  NearParts near;
  MeshDistance tool_distance, scene_distance;
  double lever_m, step_m, longest_m = 0.0, margin_m = 0.0;
  Pose pose;
  int steps = 0;
  bool strict = false;
};

GodObject::GodObject(const ReferenceMesh& tool, const ReferenceMesh& scene, double lever_m) {
  if (!tool.closed)
    throw std::invalid_argument("the reference of a virtual tool needs a closed tool mesh");
  solver_ = std::make_unique<Solver>(tool, scene, lever_m);
}
GodObject::~GodObject() = default;

std::optional<GodObjectRest> GodObject::led(const Pose& from, const Pose& hand) {
  Solver& s = *solver_;
  if (!s.place(from))
    return std::nullopt;
  const double step = 2.0 * s.scaled(kLongestStep);
  const int count =
      std::max(1, static_cast<int>(std::ceil(s.near.displacement_m(from, hand) / step)));
  for (int n = 1; n <= count; ++n) {
    const double part = static_cast<double>(n) / count;
    s.steps_to({from.position + part * (hand.position - from.position),
                from.orientation.slerp(part, hand.orientation)},
               kStepsOfHand, 0.1 * step);
  }
  return s.settle(hand);
}

std::optional<GodObjectRest> GodObject::pulled(const Pose& from, const Pose& hand) {
  if (!solver_->place(from))
    return std::nullopt;
  return solver_->settle(hand);
}

double GodObject::lever_m() const noexcept { return solver_->lever_m; }
double GodObject::tool_reach_m() const noexcept { return solver_->near.tool_reach_m(); }

ReferenceMesh joined_mesh(const std::vector<std::pair<ReferenceMesh, Pose>>& meshes) {
  if (meshes.empty())
    throw std::invalid_argument("no mesh to join");
  ReferenceMesh out;
  out.closed = true;
  for (const auto& [mesh, pose] : meshes) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (const Vec3& vertex : mesh.vertices)
      out.vertices.push_back(pose * vertex);
    for (const auto& t : mesh.triangles)
      out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    out.closed = out.closed && mesh.closed;
  }
  return out;
}

}  // namespace voxtouch::reference
