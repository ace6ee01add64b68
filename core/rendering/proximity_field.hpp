#pragma once
/// Resources of the effect `proximity`: distances around the static objects, and the query points
/// of the tool.
#include <cstdint>
#include <vector>

#include "core/effects/effect.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::rendering {

/// The smoothed distance field of the static meshes: the quadratic B-spline over every m-th node
/// along each axis. The length h = m e is the smallest multiple of the voxel edge that is at least
/// the requested smoothing length.
/// It is exact in front of a flat wall. Elsewhere the error is the curvature times h^2 / 8 for each
/// axis. In front of a ball of radius r the distance is h^2 / (4 r) too large. Distances have a
/// slope of at most 1. Differences of neighbouring nodes are thus at most h, and second differences
/// at most 2 h, which gives the bounds of ProximitySample.
class ProximityField final : public effects::Proximity {
 public:
  /// Builds distances that are valid up to `range_m` on both sides, for the mesh of `voxmap`. Open
  /// parts have no distances. Throws like build_distance_field.
  ProximityField(const mesh::TriangleMesh& mesh, const voxmap::Voxmap& voxmap, double range_m,
                 double smoothing_m, const ParallelFor& parallel_for);
  effects::ProximitySample at(const Vec3& x) const noexcept override;

  std::uint64_t bytes() const noexcept { return field_.bytes(); }
  std::uint64_t nodes() const noexcept { return field_.stored_nodes(); }
  double smoothing_m() const noexcept { return stride_ * field_.grid().edge; }
  /// Cut-off of the distances: beyond the range, so that the smoothing within it uses no cut-off
  /// value.
  double reach_m() const noexcept { return reach_m_; }

 private:
  std::int32_t stride_ = 1;
  voxmap::DistanceField field_;
  double band_voxels_ = 0.0;
  double reach_m_ = 0.0;
};

/// Query points of the tool, in a number that does not depend on its size.
struct ToolPoints {
  /// Largest number of lookups per sample.
  static constexpr std::size_t kMaxPoints = 128;
  std::vector<effects::ToolPoint> points;
  double gap_m = 0.0;    ///< largest distance of a shell point from the nearest of these
  double reach_m = 0.0;  ///< largest distance of these from the tool's origin
};

/// Spreads the points over the shell: each next one is the shell point farthest from those selected
/// (Gonzalez 1985: the gap is at most twice the optimum). Ties follow the order of the shell. Each
/// point gets the area of the shell points nearest to it.
ToolPoints spread_tool_points(const pointshell::Pointshell& shell,
                              std::size_t most = ToolPoints::kMaxPoints);

}  // namespace voxtouch::rendering
