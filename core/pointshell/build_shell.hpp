#pragma once
/// The dynamic object's pointshell: exact (paper, section 2.1, "Exact PointShell Creation") and
/// naive.
///
/// Each surface voxel V has one point. It is the point of the surface within V that is nearest to
/// V's centre. This covers all cases of the paper: each triangle is cut to V, and the nearest point
/// of the polygon is taken.
///
/// Normal (points INTO the object): minus the mean of the triangles' unit normals weighted by the
/// area of (triangle within V); unweighted if all only touch V. If that mean cancels (coherence <=
/// 0.1) or points out of the face with the point, the normal of that face is used. Zero-area
/// triangles count for points but not for normals. Of duplicates (same corners in any order) the
/// first counts. Normals of a closed part point into its solid for any orientation of its triangles
/// (outward.hpp). An open part has no outside, and its normals follow the orientation in the file.
///
/// Weight: the area of (surface within V). A piece in a face of V counts half, since it also
/// belongs to the voxel across that face. The weights thus sum to the area of the mesh, also for
/// faces on the grid.
#include <cstdint>
#include <vector>

#include "core/pointshell/pointshell.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::pointshell {

inline constexpr double kNormalsCancel =
    0.1;  ///< coherence up to which a mean of normals is not used

enum class NormalRule : std::uint8_t { kMean = 0, kFaceForCancelling = 1, kFaceForOutward = 2 };

/// Properties of one point: a row of `<mesh>_surface.csv`.
struct ShellPoint {
  voxmap::VoxelIndex voxel;
  std::uint32_t triangle = 0;   ///< lowest-numbered triangle that holds the point
  Vec3 point = Vec3::Zero();    ///< [m], frame of the mesh
  Vec3 normal = Vec3::UnitZ();  ///< unit, inward, by the rule above
  /// unit, inward: unweighted mean over all triangles that meet the closed voxel; zero if these
  /// cancel (a mean of length kNormalsCancel or less), because only rounding is left
  Vec3 plain_normal = Vec3::UnitZ();
  bool plain_cancels = false;
  double distance_m = 0.0;  ///< from the voxel's centre
  double area_m2 = 0.0;     ///< the point's fraction of the surface
  double coherence = 0.0;   ///< |sum A n| / sum A
  bool open = false;        ///< a triangle reaches the open cube; false: touch only
  bool tie = false;         ///< another point of the surface in V is as near, to 1e-9 e
  NormalRule rule = NormalRule::kMean;
};

/// One point a surface voxel, sorted by (i, j, k): a point's rank is its id. Throws like
/// `voxelise`. Bit-identical whatever the loop does.
std::vector<ShellPoint> shell_points(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid,
                                     const ParallelFor& parallel_for,
                                     std::uint64_t memory_limit_bytes = voxmap::kVoxelMemoryLimit);

/// The largest distance between the points of two surface voxels with a common face [m]. `points`
/// sorted by voxel.
double largest_gap_m(const std::vector<ShellPoint>& points);

/// Shell points as the contact models take them, in Morton order. The naive shell has the voxels'
/// centres as points, with the normals and weights of the exact one.
Pointshell make_exact_shell(const std::vector<ShellPoint>& points, const voxmap::Grid& grid);
Pointshell make_naive_shell(const std::vector<ShellPoint>& points, const voxmap::Grid& grid);

}  // namespace voxtouch::pointshell
