#pragma once
/// What the effect `proximity` looks up: distances round the static objects, and the points of the
/// tool they are asked for.
#include <cstdint>
#include <vector>

#include "core/effects/effect.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::rendering {

/// The distance field of the static meshes, smoothed: the quadratic B-spline over every m-th node
/// along each axis, h = m e the least multiple of the voxel edge that is not below the smoothing
/// asked for. Exact before a flat wall, off by the curvature times h^2 / 8 an axis elsewhere
/// (before a ball of radius r: h^2 / (4 r) farther). With distances of slope 1 at most all
/// differences of neighbouring nodes are at most h, those of second order 2 h: hence the bounds of
/// ProximitySample.
class ProximityField final : public effects::Proximity {
 public:
  /// Distances that are right out to `range_m` on both sides, for the mesh that `voxmap` was made
  /// from. Parts that are open have none. Throws like build_distance_field.
  ProximityField(const mesh::TriangleMesh& mesh, const voxmap::Voxmap& voxmap, double range_m,
                 double smoothing_m, const ParallelFor& parallel_for);
  effects::ProximitySample at(const Vec3& x) const noexcept override;

  std::uint64_t bytes() const noexcept { return field_.bytes(); }
  std::uint64_t nodes() const noexcept { return field_.stored_nodes(); }
  double smoothing_m() const noexcept { return stride_ * field_.grid().edge; }
  /// Distances are cut off here: above the range, so that nothing of the smoothing is cut off
  /// within it.
  double reach_m() const noexcept { return reach_m_; }

 private:
  std::int32_t stride_ = 1;
  voxmap::DistanceField field_;
  double band_voxels_ = 0.0;
  double reach_m_ = 0.0;
};

/// Points of the tool, for a cost that its size does not change.
struct ToolPoints {
  /// Lookups a sample at most.
  static constexpr std::size_t kMaxPoints = 128;
  std::vector<effects::ToolPoint> points;
  double gap_m = 0.0;    ///< no point of the shell is farther from one of these
  double reach_m = 0.0;  ///< of them from the tool's origin
};

/// Spread over the shell: each next one is the shell point farthest from those there are (Gonzalez
/// 1985: the gap is at most twice the least possible), ties by the shell's order; each takes the
/// area of the shell points that are nearest to it.
ToolPoints spread_tool_points(const pointshell::Pointshell& shell,
                              std::size_t most = ToolPoints::kMaxPoints);

}  // namespace voxtouch::rendering
