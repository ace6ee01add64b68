#include "core/contact/contact_query.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "core/contact/limits.hpp"

// One source, compiled for what the processor has: the same IEEE operations in the same order (contraction is off), so the
// bits do not depend on the choice. Sanitizers do not stand the start-up resolver that this needs.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define VOXTOUCH_CLONES __attribute__((target_clones("default", "sse4.1", "avx2", "arch=x86-64-v4")))
#else
#define VOXTOUCH_CLONES
#endif

namespace voxtouch {
namespace contact_query_detail {

/// Tool to grid: u = (R p + t) / edge with t already relative to the grid's origin.
struct Frame {
  double r[3][3];
  double t[3];
  double edge;
};

/// One leaf's grid coordinates, and which of its points are in voxels that are not free, as bits.
struct Leaf {
  double u[3][SphereTree::kLeafPoints];
  std::uint32_t surface = 0, interior = 0;
};

VOXTOUCH_CLONES
void classify(const Voxmap& voxmap, const Frame& f, const double* x, const double* y, const double* z, std::uint32_t count,
              Leaf& leaf) noexcept {
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t p = 0; p < count; ++p)
      leaf.u[axis][p] = (f.r[axis][0] * x[p] + f.r[axis][1] * y[p] + f.r[axis][2] * z[p] + f.t[axis]) / f.edge;
  std::uint32_t surface = 0, interior = 0;
  for (std::uint32_t p = 0; p < count; ++p) {
    const VoxelKind kind = voxmap.at(Grid::voxel_of(Vec3(leaf.u[0][p], leaf.u[1][p], leaf.u[2][p])));
    surface |= static_cast<std::uint32_t>(kind == VoxelKind::kSurface) << p;
    interior |= static_cast<std::uint32_t>(kind == VoxelKind::kInterior) << p;
  }
  leaf.surface = surface;
  leaf.interior = interior;
}

}  // namespace contact_query_detail

namespace {

using contact_query_detail::Frame;
using contact_query_detail::Leaf;

void check(const Pointshell& shell) {
  const std::size_t n = shell.size();
  if (shell.y.size() != n || shell.z.size() != n || shell.nx.size() != n || shell.ny.size() != n || shell.nz.size() != n ||
      shell.id.size() != n)
    throw std::invalid_argument("contact: the pointshell's arrays differ in length; build it with core/pointshell");
  for (std::size_t p = 0; p < n; ++p)
    if (!shell.point(p).allFinite() || !shell.normal(p).allFinite())
      throw std::invalid_argument("contact: point " + std::to_string(shell.id[p]) +
                                  " of the pointshell is not finite; check the mesh it came from");
}

void check_areas(const Pointshell& shell) {
  if (shell.area_m2.size() != shell.size())
    throw std::invalid_argument("contact: the pointshell has no areas to weigh its points with; build it anew");
  for (std::size_t p = 0; p < shell.size(); ++p)
    if (!std::isfinite(shell.area_m2[p]) || shell.area_m2[p] < 0.0)
      throw std::invalid_argument("contact: the area of point " + std::to_string(shell.id[p]) +
                                  " of the pointshell is not a number of at least 0; check the mesh it came from");
}

/// The voxmap's bound holds from anywhere in the 4-voxel cell of u. Where it is not zero, the straight way to whatever is not
/// free first leaves that cell, which takes at least the distance to its nearest face: that much may be added. (Outside the
/// table too: its border of free bricks is wider than half a cell.)
double free_distance(const Voxmap& voxmap, const Vec3& u) noexcept {
  const double from_cell = voxmap.free_distance_voxels(u);
  if (!(from_cell > 0.0)) return 0.0;
  double to_face = Voxmap::kCellEdge;
  for (int axis = 0; axis < 3; ++axis) {
    const double in_cell = u[axis] - Voxmap::kCellEdge * std::floor(u[axis] / Voxmap::kCellEdge);
    to_face = std::min({to_face, in_cell, Voxmap::kCellEdge - in_cell});
  }
  return from_cell + to_face;
}

Hit make_hit(const Pointshell& shell, const Mat3& rotation, double edge, const Leaf& leaf, std::uint32_t slot,
             std::uint32_t point, PointWeights weights) noexcept {
  const Vec3 u(leaf.u[0][slot], leaf.u[1][slot], leaf.u[2][slot]);
  const VoxelIndex v = Grid::voxel_of(u);
  // Centre minus point within the voxel: the grid's own origin, perhaps 1e6 m away, never enters.
  return {point, rotation * Vec3(shell.x[point], shell.y[point], shell.z[point]),
          rotation * Vec3(shell.nx[point], shell.ny[point], shell.nz[point]),
          edge * Vec3((v.i + 0.5) - u.x(), (v.j + 0.5) - u.y(), (v.k + 0.5) - u.z()),
          weights == PointWeights::kArea ? shell.area_m2[point] : 1.0};
}

}  // namespace

ContactQuery::ContactQuery(const Voxmap& voxmap, Pointshell shell, PointWeights weights)
    : voxmap_(voxmap), shell_(std::move(shell)), weights_(weights) {
  check(shell_);
  if (weights_ == PointWeights::kArea) check_areas(shell_);
  tree_ = SphereTree(shell_);
  for (std::size_t p = 0; p < shell_.size(); ++p) reach_m_ = std::max(reach_m_, shell_.point(p).norm());
}

void ContactQuery::find(const Pose& tool_in_world, HitList& hits) const noexcept {
  hits.clear();
  Quat orientation = tool_in_world.orientation;
  if (!tool_in_world.position.allFinite() ||
      !normalise_within(orientation, contact_limits::kMinQuaternionNorm, contact_limits::kMaxQuaternionNorm)) {
    hits.pose_status = PoseStatus::kNotAPose;
    return;
  }
  hits.pose = {tool_in_world.position, orientation};
  const Grid& grid = voxmap_.grid();
  const Mat3 rotation = orientation.toRotationMatrix();
  const Vec3 local = tool_in_world.position - grid.origin;
  const double reach_voxels = reach_m_ / grid.edge;
  if (!(local.cwiseAbs().maxCoeff() / grid.edge + reach_voxels < contact_limits::kMaxGridCoordinate)) {
    hits.pose_status = PoseStatus::kOutOfRange;
    return;
  }

  Frame frame{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) frame.r[row][column] = rotation(row, column);
    frame.t[row] = local[row];
  }
  frame.edge = grid.edge;

  const auto culled = [&](const SphereTree::Sphere& s) noexcept {
    return free_distance(voxmap_, (rotation * Vec3(s.x, s.y, s.z) + local) / grid.edge) >
           s.radius / grid.edge + contact_limits::kCullSafetyVoxels;
  };
  const auto test = [&](std::uint32_t begin, std::uint32_t end) noexcept {
    Leaf leaf;
    contact_query_detail::classify(voxmap_, frame, &shell_.x[begin], &shell_.y[begin], &shell_.z[begin], end - begin, leaf);
    hits.tested += end - begin;
    for (std::uint32_t bits = leaf.surface | leaf.interior; bits != 0; bits &= bits - 1) {
      const auto slot = static_cast<std::uint32_t>(std::countr_zero(bits));
      std::vector<Hit>& list = (leaf.surface >> slot & 1U) != 0 ? hits.surface : hits.interior;
      list.push_back(make_hit(shell_, rotation, grid.edge, leaf, slot, begin + slot, weights_));
    }
  };
  tree_.visit(culled, test);
}

}  // namespace voxtouch
