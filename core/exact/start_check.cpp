#include "core/exact/start_check.hpp"

#include <cmath>
#include <limits>

#include "core/exact/crossing.hpp"
#include "core/exact/limits.hpp"

namespace voxtouch::exact {
namespace {

constexpr std::uint64_t kTrianglePair = 12;  // units of work

/// Whether the ray from `from` along `ray` meets the box.
bool ray_meets(const Box& box, const Vec3& from, const Vec3& ray) noexcept {
  double enters = 0.0, leaves = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double to_low = (box.low[k] - from[k]) / ray[k],
                 to_high = (box.high[k] - from[k]) / ray[k];
    enters = std::max(enters, std::min(to_low, to_high));
    leaves = std::min(leaves, std::max(to_low, to_high));
  }
  return enters <= leaves;
}

/// 1 where the ray leaves through the front of a face, -1 where it enters, 0 where it misses it.
int crossing(const Vec3& from, const Vec3& ray, const FeatureMesh& mesh, std::uint32_t f) noexcept {
  const Vec3 a = mesh.corner(f, 0) - from, b = mesh.corner(f, 1) - from,
             c = mesh.corner(f, 2) - from;
  const double u = ray.dot(c.cross(b)), v = ray.dot(a.cross(c)), w = ray.dot(b.cross(a));
  const bool front = u < 0.0 && v < 0.0 && w<0.0, back = u> 0.0 && v > 0.0 && w > 0.0;
  if (!front && !back)
    return 0;
  const Vec3& n = mesh.faces[f].normal;
  const double faces = n.dot(ray);
  return n.dot(a) / faces > 0.0 ? (faces > 0.0 ? 1 : -1) : 0;
}

bool meets(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    if (segment_meets_triangle(a[k], a[(k + 1) % 3], b))
      return true;
    if (segment_meets_triangle(b[k], b[(k + 1) % 3], a))
      return true;
  }
  return false;
}

std::array<Vec3, 3> corners_of(const FeatureMesh& mesh, std::uint32_t f) noexcept {
  return {mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)};
}

/// Whether face `f` of the tool meets a face of the object.
bool face_meets(std::uint32_t f, const ToolBody& tool, const ObjectBody& object, PosedPoints& posed,
                Work& work) noexcept {
  std::array<Vec3, 3> corners;
  Box box;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = posed.at(tool.features().faces[f].corners[k]);
    box.add(corners[k]);
  }
  bool met = false;
  Work all;  // a face is checked whole
  const Vec3 normal = posed.rotation() * tool.features().faces[f].normal;
  const auto bound = [&](const Box& other) {
    const double half = 0.5 * normal.cwiseAbs().dot(other.high - other.low) + limits::kTouchM;
    const double from_plane = std::abs(normal.dot(other.centre() - corners[0])) - half;
    return std::max(distance(box, other), from_plane);
  };
  object.faces().walk(
      bound, 0.0,
      [&](std::uint32_t other) {
        all.add(kTrianglePair);
        met = meets(corners, corners_of(object.features(), other));
        return !met;
      },
      all);
  work.add(all.used());
  return met;
}

}  // namespace

bool inside_closed_part(const Vec3& point, const FeatureMesh& mesh, const BoxTree& faces,
                        Work& work) noexcept {
  static const std::array<Vec3, 3> kDirections{
      Vec3(0.2761, 0.5443, 0.7921), Vec3(-0.8137, 0.1429, 0.5634), Vec3(0.3319, -0.9157, 0.2263)};
  int votes = 0;
  for (const Vec3& ray : kDirections) {
    int winding = 0;
    Work all;
    const auto bound = [&](const Box& box) {
      return ray_meets(box, point, ray) ? 0.0 : std::numeric_limits<double>::infinity();
    };
    faces.walk(
        bound, 0.0,
        [&](std::uint32_t f) {
          all.add(Work::kPair);
          if (!mesh.faces[f].two_sided)
            winding += crossing(point, ray, mesh, f);
          return true;
        },
        all);
    work.add(all.used());
    if (winding > 0)
      ++votes;
  }
  return votes >= 2;
}

StartVerdict StartCheck::advance(const ToolBody& tool, const ObjectBody& object, PosedPoints& posed,
                                 Work& work) noexcept {
  const FeatureMesh &a = tool.features(), &b = object.features();
  Box around;
  around.add(Vec3(posed.pose().position.array() - a.reach_m));
  around.add(Vec3(posed.pose().position.array() + a.reach_m));
  if (distance(around, object.faces().bounds()) > limits::kTouchM)
    return StartVerdict::kFree;
  for (; next_face_ < a.faces.size(); ++next_face_) {
    if (work.done())
      return StartVerdict::kPending;
    if (face_meets(next_face_, tool, object, posed, work))
      return StartVerdict::kBlocked;
  }
  for (; next_tool_part_ < a.parts.size(); ++next_tool_part_) {
    if (work.done())
      return StartVerdict::kPending;
    const Vec3& point = posed.at(a.parts[next_tool_part_].vertex);
    if (inside_closed_part(point, b, object.faces(), work))
      return StartVerdict::kBlocked;
  }
  for (; next_object_part_ < b.parts.size(); ++next_object_part_) {
    if (work.done())
      return StartVerdict::kPending;
    const Vec3 point = posed.to_tool(b.points[b.parts[next_object_part_].vertex]);
    work.add(1);
    if (point.norm() > a.reach_m)
      continue;
    if (inside_closed_part(point, a, tool.face_boxes(), work))
      return StartVerdict::kBlocked;
  }
  return StartVerdict::kFree;
}

bool intersect(const ToolBody& tool, const ObjectBody& object, PosedPoints& posed) noexcept {
  Work work;
  for (std::uint32_t f = 0; f < tool.features().faces.size(); ++f)
    if (face_meets(f, tool, object, posed, work))
      return true;
  return false;
}

}  // namespace voxtouch::exact
