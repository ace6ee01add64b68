#include <algorithm>
#include <cmath>

#include "core/pointshell/build_shell.hpp"
#include "core/pointshell/clip.hpp"
#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/exact_sign.hpp"
#include "core/voxmap/outward.hpp"
#include "core/voxmap/slabs.hpp"
#include "core/voxmap/triangle_voxels.hpp"

namespace voxtouch::pointshell {
namespace {

constexpr double kTie = 1e-9;        // [e] distances that count as equal
constexpr double kSamePoint = 1e-7;  // [e] points that count as one
constexpr std::size_t kTrianglesPerJob = 4096;

/// One triangle in one voxel.
struct Pair {
  std::uint64_t voxel;  ///< number of the voxel within its slab, rising with (i, j, k)
  std::uint32_t triangle;
  bool open;
};

/// A triangle's contribution to a voxel. Grid units, origin at the voxel's centre.
struct Piece {
  std::uint32_t triangle = 0;
  Vec3 nearest = Vec3::Zero();
  double distance = 0.0;
};

/// Data of the mesh for every voxel.
struct ShellBuilder {
  const voxmap::GridMesh& mesh;
  const voxmap::Grid& grid;
  std::vector<voxmap::TriangleState> state;
  std::vector<Vec3> normal;  ///< unit, outward; zero for a triangle without area

  /// `pieces` is scratch memory.
  ShellPoint point_of(const voxmap::VoxelIndex& voxel, const Pair* first, const Pair* last,
                      std::vector<Piece>& pieces) const;
};

/// Sums over the triangles of a voxel that have an area.
struct NormalSums {
  Vec3 weighted = Vec3::Zero(), plain = Vec3::Zero();
  double area = 0.0, fraction = 0.0;
  int count = 0;
};

/// Whether the triangle lies in the plane of one of the voxel's faces.
bool lies_in_face(const Vec3& a, const Vec3& b, const Vec3& c,
                  const voxmap::VoxelIndex& v) noexcept {
  const std::array<std::int32_t, 3> low{v.i, v.j, v.k};
  for (int axis = 0; axis < 3; ++axis) {
    const double x = a[axis], from = low[static_cast<std::size_t>(axis)];
    if (x == b[axis] && x == c[axis] && (x == from || x == from + 1.0))
      return true;
  }
  return false;
}

/// The normal rule; see the header. `face`: outward normal of the triangle that holds the point,
/// zero if it has no area.
void set_normals(const NormalSums& sums, const Vec3& face, const Vec3& to_centre,
                 ShellPoint& point) noexcept {
  // A voxel that only zero-area triangles meet has no normal; any unit vector is as good, and its
  // weight is zero.
  Vec3 alone = to_centre.stableNormalized();
  if (!(alone.squaredNorm() > 0.5))
    alone = Vec3::UnitZ();
  const Vec3 own = face.isZero(0.0) ? alone : Vec3(-face);
  const bool touch_only = sums.area <= kTouchArea;
  const Vec3 sum = touch_only ? sums.plain : sums.weighted;
  const double total = touch_only ? sums.count : sums.area;
  point.coherence = total > 0.0 ? sum.norm() / total : 0.0;
  const double plain = sums.plain.norm();
  point.plain_cancels = sums.count > 0 && plain <= kNormalsCancel * sums.count;
  point.plain_normal = point.plain_cancels ? Vec3(Vec3::Zero())
                       : sums.count > 0    ? Vec3(-sums.plain / plain)
                                           : own;
  if (point.coherence <= kNormalsCancel) {
    point.rule = NormalRule::kFaceForCancelling;
    point.normal = own;
  } else if (sum.dot(face) < 0.0) {
    point.rule = NormalRule::kFaceForOutward;
    point.normal = own;
  } else {
    point.normal = -sum.normalized();
  }
}

ShellPoint ShellBuilder::point_of(const voxmap::VoxelIndex& voxel, const Pair* first,
                                  const Pair* last, std::vector<Piece>& pieces) const {
  const Vec3 centre(voxel.i + 0.5, voxel.j + 0.5, voxel.k + 0.5);
  NormalSums sums;
  pieces.clear();
  ShellPoint point;
  point.voxel = voxel;
  double least = INFINITY;
  for (const Pair* pair = first; pair != last; ++pair) {
    const std::uint32_t t = pair->triangle;
    point.open = point.open || pair->open;
    if (state[t] == voxmap::TriangleState::kDuplicate)
      continue;
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const std::array<Vec3, 3> triangle{a - centre, b - centre, c - centre};
    const VoxelPolygon polygon = clip_to_voxel(triangle[0], triangle[1], triangle[2]);
    const Vec3 nearest = nearest_to_centre(triangle, normal[t], polygon);
    pieces.push_back({t, nearest, nearest.norm()});
    least = std::min(least, pieces.back().distance);
    if (state[t] == voxmap::TriangleState::kZeroArea)
      continue;
    const double size = area(polygon);
    sums.weighted += size * normal[t];
    sums.plain += normal[t];
    sums.area += size;
    sums.fraction += lies_in_face(a, b, c, voxel) ? 0.5 * size : size;
    ++sums.count;
  }
  const Piece& best = *std::find_if(pieces.begin(), pieces.end(),
                                    [&](const Piece& p) { return p.distance == least; });
  const Piece* owner = nullptr;  // lowest-numbered triangle that holds the point, to rounding
  const Piece* face =
      nullptr;  // the same among those with an area; if none holds it, the nearest of them
  double face_distance = INFINITY;
  for (const Piece& piece : pieces) {
    const bool contains =
        (piece.nearest - best.nearest).norm() <= kSamePoint && piece.distance <= least + kTie;
    if (contains && !owner)
      owner = &piece;
    if (!contains && piece.distance <= least + kTie)
      point.tie = true;
    const double distance = contains ? -1.0 : piece.distance;
    if (state[piece.triangle] == voxmap::TriangleState::kSound && distance < face_distance)
      face = &piece, face_distance = distance;
  }
  point.triangle = owner->triangle;
  point.point = grid.from_grid(centre + owner->nearest);
  point.distance_m = least * grid.edge;
  point.area_m2 = sums.fraction * grid.edge * grid.edge;
  set_normals(sums, face ? normal[face->triangle] : Vec3::Zero(), -owner->nearest, point);
  return point;
}

/// All pairs of one slab, sorted by voxel and triangle.
std::vector<Pair> pairs_of(const voxmap::GridMesh& mesh, const voxmap::Slabs& slabs,
                           std::size_t slab, const voxmap::VoxelIndex& base, std::uint64_t rows,
                           std::uint64_t columns) {
  std::vector<Pair> pairs;
  for (const std::uint32_t t : slabs.triangles(slab)) {
    const voxmap::TriangleVoxels triangle(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    const bool along_k = triangle.run_axis() == 2;
    const auto add = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
      const auto number = (static_cast<std::uint64_t>(i - slabs.first(slab)) * rows +
                           static_cast<std::uint64_t>(j - base.j)) *
                              columns +
                          static_cast<std::uint64_t>(k - base.k);
      pairs.push_back({number, t, triangle.meeting({i, j, k}) == voxmap::Meeting::kOpen});
    };
    triangle.for_each_run(
        slabs.first(slab), slabs.last(slab),
        [&](std::int32_t i, std::int32_t row, std::int32_t first, std::int32_t last) {
          for (std::int32_t n = first; n <= last; ++n)
            along_k ? add(i, row, n) : add(i, n, row);
        });
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.voxel != b.voxel ? a.voxel < b.voxel : a.triangle < b.triangle;
  });
  return pairs;
}

/// The shell's memory budget: points and pairs instead of table and bricks.
voxmap::VoxelEstimate shell_estimate(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid) {
  voxmap::VoxelEstimate estimate = voxmap::estimate_voxels(mesh, grid);
  estimate.table_cells = 0.0;
  estimate.bytes = estimate.surface_voxels * sizeof(ShellPoint);
  estimate.build_bytes = estimate.surface_voxels * (2.0 * sizeof(ShellPoint) + 3.0 * sizeof(Pair)) +
                         static_cast<double>(mesh.triangles.size()) * 80.0 +
                         static_cast<double>(mesh.vertices.size()) * 28.0;
  return estimate;
}

/// Unit normal of each triangle; zero without area. The orientation of an inverted mesh is
/// corrected: it would pull the tool into the surface.
std::vector<Vec3> outward_normals(const voxmap::GridMesh& mesh,
                                  const std::vector<std::uint32_t>& welded,
                                  const std::vector<voxmap::TriangleState>& state,
                                  const ParallelFor& parallel_for) {
  const std::vector<std::int8_t> side =
      voxmap::outward_sides(mesh, voxmap::find_closed_shells(mesh, welded, state));
  std::vector<Vec3> normal(mesh.size());
  parallel_for((mesh.size() + kTrianglesPerJob - 1) / kTrianglesPerJob, [&](std::size_t job) {
    for (std::size_t t = job * kTrianglesPerJob;
         t < std::min((job + 1) * kTrianglesPerJob, mesh.size()); ++t)
      normal[t] =
          side[t] * voxmap::area_vector(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))
                        .stableNormalized();
  });
  return normal;
}

/// One after the other: the memory of a part is freed once it has been copied.
std::vector<ShellPoint> joined(std::vector<std::vector<ShellPoint>> parts) {
  std::size_t total = 0;
  for (const auto& part : parts)
    total += part.size();
  std::vector<ShellPoint> points;
  points.reserve(total);
  for (auto& part : parts) {
    points.insert(points.end(), part.begin(), part.end());
    std::vector<ShellPoint>().swap(part);
  }
  return points;
}

}  // namespace

std::vector<ShellPoint> shell_points(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid,
                                     const ParallelFor& parallel_for,
                                     std::uint64_t memory_limit_bytes) {
  const voxmap::VoxelEstimate estimate = shell_estimate(mesh, grid);
  voxmap::require_affordable(estimate, grid, memory_limit_bytes);
  const voxmap::GridMesh in_grid(mesh, grid);
  const std::vector<std::uint32_t> welded = voxmap::weld_vertices(in_grid);
  ShellBuilder builder{in_grid, grid, voxmap::judge_triangles(in_grid, welded), {}};
  builder.normal = outward_normals(in_grid, welded, builder.state, parallel_for);

  const voxmap::VoxelIndex base{static_cast<std::int32_t>(estimate.first[0]),
                                static_cast<std::int32_t>(estimate.first[1]),
                                static_cast<std::int32_t>(estimate.first[2])};
  const auto count = [&](std::size_t axis) {
    return static_cast<std::uint64_t>(estimate.last[axis] - estimate.first[axis]) + 1;
  };
  const std::uint64_t rows = count(1), columns = count(2);
  const voxmap::Slabs slabs(in_grid, base.i, count(0) / 8 + 1);
  std::vector<std::vector<ShellPoint>> parts(slabs.size());
  parallel_for(slabs.size(), [&](std::size_t s) {
    std::vector<Piece> pieces;
    const std::vector<Pair> pairs = pairs_of(in_grid, slabs, s, base, rows, columns);
    for (std::size_t at = 0; at < pairs.size();) {
      std::size_t end = at;
      while (end < pairs.size() && pairs[end].voxel == pairs[at].voxel)
        ++end;
      const std::uint64_t n = pairs[at].voxel;
      const voxmap::VoxelIndex voxel{
          slabs.first(s) + static_cast<std::int32_t>(n / (rows * columns)),
          base.j + static_cast<std::int32_t>(n / columns % rows),
          base.k + static_cast<std::int32_t>(n % columns)};
      parts[s].push_back(builder.point_of(voxel, &pairs[at], pairs.data() + end, pieces));
      at = end;
    }
  });
  return joined(std::move(parts));
}

}  // namespace voxtouch::pointshell
