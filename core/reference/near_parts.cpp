#include "core/reference/near_parts.hpp"

#include <algorithm>
#include <map>

#include "core/types/rotation_vector.hpp"

namespace voxtouch::reference {
namespace {

/// A part of a tool that moves straight from `from` to `to`, opposite to a part at rest.
class StraightMotion {
 public:
  StraightMotion(const ConvexPart& from, const ConvexPart& to, const ConvexPart& other,
                 double closest_m)
      : from_(from),
        to_(to),
        other_(other),
        closest_m_(closest_m) {
    for (std::size_t k = 0; k < from.corners; ++k)
      length_m_ = std::max(length_m_, (to.corner[k] - from.corner[k]).norm());
  }

  /// The parts are farther apart at 0.
  std::optional<Meeting> first_meeting() const { return between(0.0, near_at(0.0), 1.0); }

 private:
  ConvexPart at(double time) const {
    ConvexPart part = from_;
    for (std::size_t k = 0; k < part.corners; ++k)
      part.corner[k] += time * (to_.corner[k] - from_.corner[k]);
    return part;
  }
  Nearness near_at(double time) const { return nearness(at(time), other_); }

  /// Corners move straight, so planes that separate the parts at both ends do so in between.
  bool separated(const Nearness& by, double time) const {
    return by.distance_m >= closest_m_ &&
           separation(at(time), other_, by.direction()) >= closest_m_;
  }

  std::optional<Meeting> between(double begin, const Nearness& at_begin, double end) const {
    constexpr double kFineRatio = 0.125;  ///< relative to the requested distance
    if (separated(at_begin, end))
      return std::nullopt;
    const Nearness at_end = near_at(end);
    if (separated(at_end, begin))
      return std::nullopt;
    if ((end - begin) * length_m_ < kFineRatio * closest_m_)
      return Meeting{begin, at_begin};
    const double middle = 0.5 * (begin + end);
    if (const auto found = between(begin, at_begin, middle))
      return found;
    return between(middle, near_at(middle), end);
  }

  const ConvexPart &from_, &to_, &other_;
  double closest_m_, length_m_ = 0.0;
};

}  // namespace

NearParts::Parts::Parts(const ReferenceMesh& mesh) : points(mesh.vertices) {
  for (std::uint32_t v = 0; v < points.size(); ++v)
    corners.push_back({{v, v, v}, 1});
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  for (const auto& t : mesh.triangles) {
    std::array<std::uint32_t, 7> parts{t[0], t[1], t[2]};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [found, is_new] = edges.try_emplace(std::minmax(t[k], t[(k + 1) % 3]),
                                                     static_cast<std::uint32_t>(corners.size()));
      if (is_new)
        corners.push_back({{t[k], t[(k + 1) % 3], t[k]}, 2});
      parts[3 + k] = found->second;
    }
    parts[6] = static_cast<std::uint32_t>(corners.size());
    corners.push_back({{t[0], t[1], t[2]}, 3});
    of_triangle.push_back(parts);
  }
}

ConvexPart NearParts::Parts::part(std::uint32_t which, const std::vector<Vec3>& at) const {
  ConvexPart out;
  out.corners = corners[which].count;
  for (std::size_t k = 0; k < out.corners; ++k)
    out.corner[k] = at[corners[which].points[k]];
  return out;
}

NearParts::NearParts(const ReferenceMesh& tool, const ReferenceMesh& scene, double range_m)
    : tool_(tool),
      scene_(scene),
      tool_tree_(tool),
      scene_tree_(scene),
      range_m_(range_m) {
  for (const Vec3& point : tool_.points)
    reach_m_ = std::max(reach_m_, point.norm());
}

std::vector<Vec3> NearParts::posed(const Pose& pose) const {
  std::vector<Vec3> out;
  out.reserve(tool_.points.size());
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  for (const Vec3& point : tool_.points)
    out.push_back(rotation * point + pose.position);
  return out;
}

double NearParts::displacement_m(const Pose& from, const Pose& to) const {
  return (to.position - from.position).norm() +
         reach_m_ * rotation_vector(from.orientation, to.orientation).norm();
}

void NearParts::move_to(const Pose& pose) {
  const double displacement = displacement_m(pose_, pose);
  path_m_ += displacement;
  pose_ = pose;
  points_ = posed(pose);
  ++pose_number_;
  if (pose_number_ == 1 || path_m_ > 0.5 * range_m_)
    return find_pairs();
  for (Pair& pair : pairs_)
    pair.at_least_m -= displacement;
}

void NearParts::find_pairs() {
  path_m_ = 0.0;
  pairs_.clear();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
  for (const auto& [at_scene, at_tool] : scene_tree_.near(tool_tree_, pose_, range_m_)) {
    const auto& mine = tool_.of_triangle[at_tool];
    const auto& other = scene_.of_triangle[at_scene];
    for (std::size_t k = 0; k < 3; ++k) {
      found.emplace_back(mine[k], other[6]);
      found.emplace_back(mine[6], other[k]);
      for (std::size_t j = 0; j < 3; ++j)
        found.emplace_back(mine[3 + k], other[3 + j]);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  for (const auto& [mine, other] : found) {
    Pair pair{mine, other};
    measure(pair);
    if (pair.at_least_m < range_m_)
      pairs_.push_back(pair);
  }
}

void NearParts::measure(Pair& pair) {
  if (pair.known_at == pose_number_)
    return;
  const Nearness found =
      nearness(tool_.part(pair.mine, points_), scene_.part(pair.other, scene_.points));
  pair.at_least_m = found.distance_m;
  pair.direction = found.direction();
  pair.known_at = pose_number_;
}

double NearParts::distance_m() {
  double least = range_m_;
  for (Pair& pair : pairs_) {
    if (pair.at_least_m >= least)
      continue;
    measure(pair);
    least = std::min(least, pair.at_least_m);
  }
  return least;
}

std::optional<Meeting> NearParts::first_meeting(const Pose& next, double closest_m) {
  const double displacement = displacement_m(pose_, next);
  const std::vector<Vec3> then = posed(next);
  std::optional<Meeting> first;
  for (Pair& pair : pairs_) {
    if (pair.at_least_m - displacement >= closest_m)
      continue;
    measure(pair);
    if (pair.at_least_m - displacement >= closest_m)
      continue;
    const ConvexPart to = tool_.part(pair.mine, then),
                     other = scene_.part(pair.other, scene_.points);
    if (separation(to, other, pair.direction) >= closest_m)
      continue;
    const ConvexPart from = tool_.part(pair.mine, points_);
    const auto met = StraightMotion(from, to, other, closest_m).first_meeting();
    if (met && (!first || met->time < first->time))
      first = met;
  }
  return first;
}

}  // namespace voxtouch::reference
