#include "core/reference/posed_mesh.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "core/reference/chord_error.hpp"

namespace voxtouch::reference {
namespace {
/// The chord error is the maximum over samples; the true maximum may be slightly larger.
constexpr double kChordSlack = 1.5;

/// One corner of each connected part of a mesh. If surfaces do not meet, a part is inside or
/// outside as a whole.
std::vector<Vec3> corner_of_each_part(const ReferenceMesh& mesh) {
  std::vector<std::uint32_t> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&root](std::uint32_t v) {
    while (root[v] != v)
      v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    root[find(t[1])] = find(t[0]), root[find(t[2])] = find(t[0]);
  std::vector<Vec3> corners;
  std::vector<bool> seen(root.size(), false);
  for (const auto& t : mesh.triangles)
    if (const std::uint32_t part = find(t[0]); !seen[part])
      seen[part] = true, corners.push_back(mesh.vertices[t[0]]);
  return corners;
}

}  // namespace

PosedMesh::PosedMesh(const scene::MeshSpec& spec)
    : pose_(spec.pose),
      rest_(spec.pose.position),
      mesh_(read_reference_mesh(spec)),
      inside_(mesh_),
      distance_(mesh_),
      primitives_(spec.primitives),
      one_of_each_part_(corner_of_each_part(mesh_)) {
  box_min_ = box_max_ = mesh_.vertices.front();
  for (const Vec3& vertex : mesh_.vertices)
    box_min_ = box_min_.cwiseMin(vertex), box_max_ = box_max_.cwiseMax(vertex);
  if (!primitives_.empty())
    chord_error_m_ = chord_error(mesh_, distance_, primitives_).value_m();
}

double PosedMesh::at_least_m(const Vec3& x, double reach_m) const noexcept {
  const Vec3 local = pose_.inverse() * x;
  const double apart_m = (local - local.cwiseMax(box_min_).cwiseMin(box_max_)).norm();
  // Declared primitives may extend beyond the mesh; the last term covers rounding.
  const double bound_m =
      apart_m - reach_m - kChordSlack * chord_error_m_ - 1e-9 * (1.0 + local.norm());
  return bound_m > 0.0 ? bound_m : -std::numeric_limits<double>::infinity();
}

bool PosedMesh::inside(const Vec3& x) const noexcept {
  return mesh_.closed && inside_.inside(pose_.inverse() * x);
}

SignedPoint PosedMesh::local_mesh(const Vec3& local) const {
  const NearestPoint found = distance_.nearest(local);
  const double sign = mesh_.closed && inside_.inside(local) ? -1.0 : 1.0;
  return {sign * found.distance_m, found.point};
}

SignedPoint PosedMesh::mesh_signed_distance(const Vec3& x) const {
  SignedPoint found = local_mesh(pose_.inverse() * x);
  found.nearest = pose_ * found.nearest;
  return found;
}

PosedMesh::Answer PosedMesh::signed_distance(const Vec3& x) const {
  const Vec3 local = pose_.inverse() * x;
  Answer answer{local_mesh(local), false, 0.0};
  const double by_mesh = answer.signed_point.distance_m;
  if (primitives_.empty()) {
    const double differ = std::abs(std::abs(by_mesh) - distance_.second_method(local));
    answer.check_error_m = std::max(0.0, differ - distance_.second_method_error_m());
  } else {
    const SignedPoint by_form = voxtouch::reference::signed_distance(primitives_, local);
    // Inside a union the closed form is only a bound, because seams between parts do not belong to
    // the surface. The mesh is more accurate there.
    const bool form_is_exact = by_form.distance_m > 0 || primitives_.size() == 1;
    const double allowed = kChordSlack * chord_error_m_ + distance_.second_method_error_m();
    const double side = mesh_.closed ? by_form.distance_m
                                     : std::abs(by_form.distance_m);  // open: the mesh has no sides
    const double differ = form_is_exact ? std::abs(side - by_mesh) : std::max(0.0, by_mesh);
    answer.check_error_m = std::max(0.0, differ - allowed);
    if (form_is_exact)
      answer.signed_point = by_form, answer.closed_form = true;
  }
  answer.signed_point.nearest = pose_ * answer.signed_point.nearest;
  return answer;
}

Vec3 PosedMesh::nearest(const Vec3& x) const {
  const Vec3 local = pose_.inverse() * x;
  if (!primitives_.empty())
    if (const SignedPoint by_form = voxtouch::reference::signed_distance(primitives_, local);
        by_form.distance_m > 0 || primitives_.size() == 1)
      return pose_ * by_form.nearest;
  return pose_ * distance_.nearest(local).point;
}

}  // namespace voxtouch::reference
