#pragma once
/// Distances to a mesh by FCL.
#include <memory>

#include "core/reference/reference_mesh.hpp"

namespace voxtouch::reference {

/// Nearest point of a mesh and the unsigned distance to it [m], in the mesh's frame.
struct NearestPoint {
  double distance_m = 0.0;
  Vec3 point = Vec3::Zero();
};

/// Nearest points of two separate meshes, in the first mesh's frame; `distance_m` is 0 if they meet
/// (points zero).
struct NearestPair {
  double distance_m = 0.0;
  Vec3 mine = Vec3::Zero(), other = Vec3::Zero();
};

/// A bounding-volume tree of OBBRSS over one mesh. Queries are const and may run concurrently; they
/// allocate.
class MeshDistance {
 public:
  /// Builds the tree over all triangles. Allocates.
  explicit MeshDistance(const ReferenceMesh& mesh);
  ~MeshDistance();
  MeshDistance(MeshDistance&&) noexcept;
  MeshDistance& operator=(MeshDistance&&) noexcept;

  /// First method: FCL's mesh against a sphere of radius 0, whose triangle test is a closed-form
  /// projection. FCL leaves the distance unset for a point on a triangle; this is detected, and the
  /// second method is used.
  NearestPoint nearest(const Vec3& x) const;

  /// Second method, which has only the tree in common with the first: FCL's mesh against a mesh of
  /// one triangle, small enough to represent a point. Its error is at most
  /// `second_method_error_m()`.
  double second_method(const Vec3& x) const;
  /// The error bound of `second_method` [m].
  double second_method_error_m() const noexcept;

  /// Distance to another mesh posed in this one's frame.
  NearestPair to(const MeshDistance& other, const Pose& other_in_mine) const;

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace voxtouch::reference
