#pragma once
/// Scenes and shells for the contact tests: the reference vectors, and shapes simple enough to
/// reason about.
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/contact/contact_renderer.hpp"

namespace voxtouch::test {

/// A mesh of the reference vectors as voxmap and shells; shell ids = row numbers, points in Morton
/// order.
struct VectorMesh {
  voxmap::Voxmap voxmap;
  pointshell::Pointshell exact, naive;
};
VectorMesh load_vector_mesh(const std::string& name);

/// One row of a pose file.
struct VectorPose {
  Pose pose;  ///< quaternion normalised
  std::uint32_t surface = 0, interior = 0;
  std::string coherence;  ///< as printed
  Wrench original, adapted;
  std::vector<std::uint32_t> ids;
};
std::vector<VectorPose> load_vector_poses(const std::string& file);

/// The shell with its points in another order: `order[k]` is the old index of new point k.
pointshell::Pointshell reordered(const pointshell::Pointshell& shell,
                                 const std::vector<std::uint32_t>& order);
pointshell::Pointshell morton_ordered(const pointshell::Pointshell& shell);

/// Solid block of voxels first..last (inclusive): a surface layer one voxel thick round an
/// interior.
void add_block(voxmap::Voxmap& voxmap, const voxmap::VoxelIndex& first,
               const voxmap::VoxelIndex& last);
voxmap::Voxmap block(const voxmap::Grid& grid, const voxmap::VoxelIndex& first,
                     const voxmap::VoxelIndex& last);

/// About one point per edge^2 on a sphere about the tool's origin, mirrored in the plane x = 0;
/// Morton order.
pointshell::Pointshell sphere_shell(double radius_m, double edge_m);
pointshell::Pointshell shell_of(const std::vector<std::pair<Vec3, Vec3>>& points_and_normals,
                                double edge_m);

/// Hits without a query, of a tool that is not rotated: numbers (ascending), normals, weights and
/// `to_centre` (below half an edge along each axis) as given, and `arm` = -to_centre.
contact::Hits made_hits(const std::vector<contact::Hit>& hits, double edge_m);

Quat random_rotation(std::mt19937_64& random);
/// Uniform in [low, high), the same on every standard library.
double uniform(std::mt19937_64& random, double low, double high);

/// True if both wrenches are bit-identical results.
bool same_bits(const Wrench& a, const Wrench& b);

}  // namespace voxtouch::test
