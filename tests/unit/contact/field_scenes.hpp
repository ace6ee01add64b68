#pragma once
/// Meshes, static scenes and tools for the tests of the contact model `field`, and the law's
/// integral by another method.
#include <functional>
#include <random>
#include <vector>

#include "core/contact/contact_renderer.hpp"
#include "core/mesh/triangle_mesh.hpp"
#include "tests/support/exact_shell.hpp"

namespace voxtouch::test {

mesh::TriangleMesh box_mesh(const Vec3& size, const Pose& pose = {});
/// A square of the pose's x and y, `thick_m` thick; 0: an open sheet of two triangles.
mesh::TriangleMesh plate_mesh(double wide_m, double thick_m, const Pose& pose = {});
/// An icosahedron with faces split in four `splits` times, its vertices on the sphere.
mesh::TriangleMesh sphere_mesh(double radius_m, int splits);
/// About the z axis, from -length/2 to length/2.
mesh::TriangleMesh cylinder_mesh(double radius_m, double length_m, int sides);
mesh::TriangleMesh joined(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b);
/// Inverts the faces.
mesh::TriangleMesh inside_out(mesh::TriangleMesh mesh);

/// A static mesh with the model's data.
struct Ground {
  voxmap::Voxmap voxmap;
  voxmap::DistanceField field;
  Ground(const mesh::TriangleMesh& mesh, double edge, double depth_voxels = 12.0);
  Ground(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid, double depth_voxels);
  /// With k = 1 N/mm^3.
  contact::ContactRenderer renderer(
      const pointshell::Pointshell& tool,
      contact::ContactModelKind kind = contact::ContactModelKind::kField,
      bool memoryless = false) const;
};

inline constexpr double kPressure = 1e9;  ///< k [N/m^3]

/// A ball with its centre off the origin of T and at an arbitrary place in its voxel: a shell on a
/// grid through the centre would be symmetric, and its errors would cancel.
struct Ball {
  mesh::TriangleMesh mesh;
  Vec3 centre;  ///< in T
  Ball(double radius_m, int splits);
  /// T in W for a ball at `at`.
  Pose posed(const Vec3& at, const Quat& turn) const { return {at - turn * centre, turn}; }
  /// About the ball's centre.
  Vec3 torque(const Wrench& wrench, const Pose& pose) const {
    return wrench.torque - (pose.orientation * centre).cross(wrench.force);
  }
};

/// The wrench about the tool's origin that the law gives the tessellated tool: the integral of k
/// depth n over its triangles, each split in 64. `depth` of a point in W [m], negative outside;
/// 1-Lipschitz.
Wrench integral_over(const mesh::TriangleMesh& tool, const Pose& pose,
                     const std::function<double(const Vec3&)>& depth);

/// The value below which `fraction` of them lie.
double quantile(std::vector<double> values, double fraction);
double rms(const std::vector<double>& values);
/// Standard deviation over mean.
double noise(const std::vector<double>& values);
double degrees_between(const Vec3& a, const Vec3& b);

}  // namespace voxtouch::test
