#pragma once
/// The dynamic object's pointshell: exact (paper, section 2.1, "Exact PointShell Creation") and
/// naive.
///
/// One point a surface voxel V: the point of (union of the triangles that meet the closed V) within
/// V that is nearest to V's centre. All cases of the paper come to this: each triangle is cut to V
/// and its polygon's nearest point taken.
///
/// Normal (points INTO the object): minus the mean of the triangles' unit normals weighted by the
/// area of (triangle within V); unweighted where all only touch V. Where that mean cancels
/// (coherence <= 0.1) or points out of the face that holds the point, it is that face's own.
/// Zero-area triangles count for points and not for normals; of duplicates (same corners, either
/// way round) the first counts. A closed part points into its solid whatever way round its
/// triangles run (outward.hpp); an open part has no outside, and its normals follow the triangles
/// as they run in the file.
///
/// Weight: the area of (surface within V), where a piece that lies in a face of V counts half,
/// since the voxel across that face holds it too. So the weights sum to the area of the mesh also
/// where it lies on the grid.
#include <cstdint>
#include <vector>

#include "core/pointshell/pointshell.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::pointshell {

inline constexpr double kNormalsCancel =
    0.1;  ///< coherence up to which a mean of normals is not used

enum class NormalRule : std::uint8_t { kMean = 0, kFaceForCancelling = 1, kFaceForOutward = 2 };

/// All that is known of one point; the rows of `<mesh>_surface.csv`.
struct ShellPoint {
  voxmap::VoxelIndex voxel;
  std::uint32_t triangle = 0;   ///< lowest-numbered triangle that holds the point
  Vec3 point = Vec3::Zero();    ///< [m], frame of the mesh
  Vec3 normal = Vec3::UnitZ();  ///< unit, inward, by the rule above
  /// unit, inward: unweighted mean over all triangles that meet the closed voxel; zero where these
  /// cancel (a mean as long as kNormalsCancel of a unit vector, or shorter): what is left there is
  /// rounding
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

/// The largest distance between the points of two surface voxels that share a face [m]. `points`
/// sorted by voxel.
double largest_gap_m(const std::vector<ShellPoint>& points);

/// Shell points as the contact models take them, in Morton order. The naive shell has the voxels'
/// centres as points, with the normals and weights of the exact one.
Pointshell make_exact_shell(const std::vector<ShellPoint>& points, const voxmap::Grid& grid);
Pointshell make_naive_shell(const std::vector<ShellPoint>& points, const voxmap::Grid& grid);

}  // namespace voxtouch::pointshell
