#include "core/reference/dynamic_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace voxtouch::reference {
namespace {

scene::MeshSpec without_primitives(scene::MeshSpec spec) {
  spec.primitives.clear();
  return spec;
}

}  // namespace

DynamicMesh::DynamicMesh(const scene::MeshSpec& spec) : body_(without_primitives(spec)) {
  for (const Vec3& vertex : body_.mesh().vertices)
    centre_ += vertex / static_cast<double>(body_.mesh().vertices.size());
  for (const Vec3& vertex : body_.mesh().vertices)
    radius_m_ = std::max(radius_m_, (vertex - centre_).norm());
}

GapResult DynamicMesh::gap(const std::vector<PosedMesh>& statics, const Pose& pose_WT) const {
  GapResult best;
  double error = 0.0, inside_depth = 0.0;
  bool check = true;
  std::size_t which = statics.size();
  visit_near(statics, pose_WT, [&](std::size_t i) {
    GapResult other = against(statics[i], pose_WT);
    error = std::max(error, other.self_error_m),
    inside_depth = std::max(inside_depth, other.inside_depth_m), check = check && other.self_check;
    const double gap_m = other.gap_m;
    if (which == statics.size() || gap_m < best.gap_m || (gap_m == best.gap_m && i < which))
      best = std::move(other), which = i;
    return gap_m;
  });
  best.self_error_m = error, best.self_check = check, best.inside_depth_m = inside_depth;
  return best;
}

double DynamicMesh::apart_m(const std::vector<PosedMesh>& statics, const Pose& pose_WT) const {
  double least = std::numeric_limits<double>::infinity();
  visit_near(statics, pose_WT, [&](std::size_t i) {
    const PosedMesh& object = statics[i];
    return least = std::min(
               least, object.distance()
                          .to(body_.distance(), object.pose().inverse() * (pose_WT * body_.pose()))
                          .distance_m);
  });
  return least;
}

bool DynamicMesh::one_encloses_other(const PosedMesh& object, const Pose& pose_OM) const {
  const Pose its_in_mine = pose_OM.inverse();
  const auto inside_it = [&](const Vec3& corner) {
    return object.inside(object.pose() * (pose_OM * corner));
  };
  const auto inside_me = [&](const Vec3& corner) {
    return body_.inside(body_.pose() * (its_in_mine * corner));
  };
  const std::vector<Vec3>&mine = body_.one_of_each_part(), &its = object.one_of_each_part();
  return std::any_of(mine.begin(), mine.end(), inside_it) ||
         std::any_of(its.begin(), its.end(), inside_me);
}

GapResult DynamicMesh::against(const PosedMesh& object, const Pose& pose_WT) const {
  const Pose pose_WM = pose_WT * body_.pose();
  const Pose pose_OM = object.pose().inverse() * pose_WM;
  const NearestPair pair = object.distance().to(body_.distance(), pose_OM);
  if (pair.distance_m <= 0 || one_encloses_other(object, pose_OM))
    return overlap(object, pose_WM, pair.distance_m);
  GapResult gap;
  gap.method = GapMethod::kMeshMesh;
  gap.gap_m = pair.distance_m;
  gap.nearest_static = object.pose() * pair.mine;
  gap.nearest_dynamic = object.pose() * pair.other;
  gap.direction = (gap.nearest_dynamic - gap.nearest_static).normalized();
  gap.depth_exact = true;
  // Second method: the point that FCL reports as mine must lie on this mesh, and the point test
  // must give the same distance from the static mesh.
  const double mine_off = body_.distance().nearest(pose_OM.inverse() * pair.other).distance_m;
  const double differ =
      std::abs(object.distance().nearest(pair.other).distance_m - pair.distance_m);
  const double allowed =
      object.distance().second_method_error_m() + body_.distance().second_method_error_m();
  gap.self_error_m = std::max(0.0, std::max(mine_off, differ) - allowed);
  gap.self_check = gap.self_error_m <= 0.0;
  return gap;
}

GapResult DynamicMesh::overlap(const PosedMesh& object, const Pose& pose_WM,
                               double surfaces_apart_m) const {
  GapResult gap;
  gap.method = GapMethod::kVertexDepth;
  gap.self_error_m = 0.0;
  gap.self_check = true;
  for (const Vec3& corner : body_.mesh().vertices) {
    const Vec3 x = pose_WM * corner;
    if (!object.inside(x))
      continue;
    const SignedPoint at = object.mesh_signed_distance(x);
    if (-at.distance_m <= gap.inside_depth_m)
      continue;
    gap.inside_depth_m = -at.distance_m;
    gap.nearest_static = at.nearest, gap.nearest_dynamic = x;
    gap.direction = (at.nearest - x).normalized();
  }
  gap.gap_m = -std::max(gap.inside_depth_m, surfaces_apart_m);
  return gap;
}

}  // namespace voxtouch::reference
