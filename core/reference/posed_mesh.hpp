#pragma once
/// One mesh of a scene, static or dynamic, with the queries of the reference. Lengths in metres,
/// points in W (T for the dynamic one).
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "core/reference/closed_forms.hpp"
#include "core/reference/inside_test.hpp"
#include "core/reference/mesh_distance.hpp"

namespace voxtouch::reference {

/// Computes in the frame of the mesh, so that an object far from the world's origin loses no
/// digits.
class PosedMesh {
 public:
  /// Throws as `read_reference_mesh` does.
  explicit PosedMesh(const scene::MeshSpec& spec);

  /// Moves the mesh by `shift` from its position in the scene.
  void move_by(const Vec3& shift) noexcept { pose_.position = rest_ + shift; }

  /// Signed distance and the result of its cross-check.
  struct Answer {
    SignedPoint signed_point;    ///< nearest point in W
    bool closed_form = false;    ///< from declared primitives
    double check_error_m = 0.0;  ///< difference between two methods beyond the tolerance
  };
  /// Signed distance of `x` in W [m], negative inside. Allocates.
  Answer signed_distance(const Vec3& x) const;
  /// Signed distance by the triangles alone.
  SignedPoint mesh_signed_distance(const Vec3& x) const;
  /// Unsigned: by the primitives outside of them, otherwise by the triangles; for points with a
  /// known side.
  Vec3 nearest(const Vec3& x) const;
  /// Whether `x` (W) is inside the mesh; false for an open mesh.
  bool inside(const Vec3& x) const noexcept;

  /// Lower bound of its signed distance to a body within `reach_m` of `x` (W) [m], by its bounding
  /// box; minus infinity if they may meet.
  double at_least_m(const Vec3& x, double reach_m = 0.0) const noexcept;

  bool closed() const noexcept { return mesh_.closed; }
  /// Largest distance between the triangles and the shape that they approximate [m].
  double chord_error_m() const noexcept { return chord_error_m_; }
  const ReferenceMesh& mesh() const noexcept { return mesh_; }
  const MeshDistance& distance() const noexcept { return distance_; }
  const Pose& pose() const noexcept { return pose_; }
  /// One corner of each connected part, in the mesh's frame. If surfaces do not meet, a part is
  /// inside or outside as a whole.
  const std::vector<Vec3>& one_of_each_part() const noexcept { return one_of_each_part_; }

 private:
  SignedPoint local_mesh(const Vec3& local) const;

  Pose pose_;
  Vec3 rest_;
  ReferenceMesh mesh_;
  InsideTest inside_;
  MeshDistance distance_;
  std::vector<scene::Primitive> primitives_;
  std::vector<Vec3> one_of_each_part_;
  double chord_error_m_ = 0.0;
  Vec3 box_min_, box_max_;  ///< of the mesh, in its own frame
};

/// Broad phase: calls `visit(index)`, which returns the smallest distance found so far, for the
/// objects by ascending bound. Ends when no other object can be nearer; objects of equal distance
/// are all visited. `x`, `reach_m`: as PosedMesh::at_least_m.
template <class Visit>
void visit_nearest_first(const std::vector<PosedMesh>& objects, const Vec3& x, double reach_m,
                         Visit visit) {
  if (objects.size() == 1)
    return void(visit(std::size_t{0}));
  std::vector<std::pair<double, std::size_t>> bounds;
  bounds.reserve(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i)
    bounds.emplace_back(objects[i].at_least_m(x, reach_m), i);
  std::sort(bounds.begin(), bounds.end());
  double least_m = std::numeric_limits<double>::infinity();
  for (const auto& [bound_m, i] : bounds) {
    if (bound_m > least_m)
      return;
    least_m = std::min(least_m, visit(i));
  }
}

}  // namespace voxtouch::reference
