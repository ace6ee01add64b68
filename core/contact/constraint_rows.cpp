#include "core/contact/constraint_rows.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "core/contact/direction_bins.hpp"
#include "core/contact/field_samples.hpp"
#include "core/contact/limits.hpp"
#include "core/contact/push_sums.hpp"
#include "core/contact/wall_faces.hpp"
#include "core/types/clones.hpp"

namespace voxtouch::contact {
namespace {

constexpr std::size_t kSides = 8;

/// Selected rows of each direction: the row of least gap, and the rows that are deepest after a
/// tilt to each side. Row numbers are stored as doubles.
struct Chosen {
  double row = 0.0, gap = std::numeric_limits<double>::infinity();
  alignas(64) double side[3][kSides];
  alignas(64) double tilted_row[kSides], tilted_gap[kSides];
};

/// Eight directions around `normal`.
std::array<Vec3, kSides> sides_of(const Vec3& normal) noexcept {
  const Vec3 a = normal.unitOrthogonal(), b = normal.cross(a);
  constexpr double h = 0.70710678118654752;
  return {a,        Vec3(h * (a + b)),  b,        Vec3(h * (b - a)),
          Vec3(-a), Vec3(-h * (a + b)), Vec3(-b), Vec3(h * (a - b))};
}

void begin_choice(const Vec3& normal, Chosen& chosen) noexcept {
  const std::array<Vec3, kSides> sides = sides_of(normal);
  for (std::size_t k = 0; k < kSides; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      chosen.side[axis][k] = sides[k][static_cast<Eigen::Index>(axis)];
    chosen.tilted_row[k] = 0.0, chosen.tilted_gap[k] = std::numeric_limits<double>::infinity();
  }
}

/// Block of rows for `choose`.
struct RowBlock {
  static constexpr std::size_t kRows = NormalBlock::kNormals;
  std::size_t first = 0, count = 0;
  std::uint32_t bin[kRows];
  double gap[kRows], arm[3][kRows];
};

VOXTOUCH_CLONES void choose(const RowBlock& __restrict rows, double tilt,
                            Chosen* __restrict bins) noexcept {
  for (std::size_t n = 0; n < rows.count; ++n) {
    Chosen& chosen = bins[rows.bin[n]];
    const double number = static_cast<double>(rows.first + n), gap = rows.gap[n],
                 x = rows.arm[0][n], y = rows.arm[1][n], z = rows.arm[2][n];
    if (gap < chosen.gap)
      chosen.gap = gap, chosen.row = number;
    for (std::size_t k = 0; k < kSides; ++k) {
      const double tilted = gap - tilt * ((x * chosen.side[0][k] + y * chosen.side[1][k]) +
                                          z * chosen.side[2][k]),
                   best = chosen.tilted_gap[k];
      chosen.tilted_row[k] = tilted < best ? number : chosen.tilted_row[k];
      chosen.tilted_gap[k] = tilted < best ? tilted : best;
    }
  }
}

/// Result for each hit of a block.
struct Screened {
  static constexpr double kOfFace = 4.0;
  /// 1: a row, if its gap is small enough; 2: a row of the wall's face, if there is one; 3: like 2,
  /// otherwise of the field; kOfFace: taken from the face.
  alignas(64) double kind[HitBlock::kHits];
};

VOXTOUCH_CLONES void screen(const HitBlock& __restrict block,
                            const FieldSamples& __restrict samples,
                            const FieldPlanes& __restrict planes, bool in_surface,
                            Screened& __restrict out) noexcept {
  const double bends = in_surface ? 2.0 : 0.0;
  for (std::size_t n = 0; n < block.filled(); ++n) {
    const double steepness = planes.steepness[n];
    const double along = (samples.gradient[0][n] * block.normal[0][n] +
                          samples.gradient[1][n] * block.normal[1][n]) +
                         samples.gradient[2][n] * block.normal[2][n];
    const double against = along < -limits::kSheetAgainst * steepness ? bends : 0.0;
    out.kind[n] = (steepness < limits::kSheetGradient ? bends : against) +
                  (steepness >= limits::kMinGradient ? 1.0 : 0.0);
  }
}

/// The second halves of the jacobians.
VOXTOUCH_CLONES void find_levers(const HitBlock& __restrict block,
                                 const FieldPlanes& __restrict planes, double lever,
                                 double (&__restrict levers)[3][HitBlock::kHits]) noexcept {
  for (std::size_t n = 0; n < block.filled(); ++n) {
    const double x = block.arm[0][n], y = block.arm[1][n], z = block.arm[2][n],
                 nx = planes.normal[0][n], ny = planes.normal[1][n], nz = planes.normal[2][n];
    levers[0][n] = (y * nz - z * ny) / lever, levers[1][n] = (z * nx - x * nz) / lever,
    levers[2][n] = (x * ny - y * nx) / lever;
  }
}

Vec3 taken(const double (&columns)[3][HitBlock::kHits], std::size_t n) noexcept {
  return {columns[0][n], columns[1][n], columns[2][n]};
}

/// Replaces the plane of a hit in a bent field by that of the wall's face, with kind kOfFace.
/// Without a face the plane of the field remains.
void take_wall_faces(const HitBlock& block, const voxmap::DistanceField& field,
                     const RowFrame& frame, Screened& screened, FieldPlanes& planes) noexcept {
  WallFaces faces;
  std::array<std::size_t, WallFaces::kPoints> whose;
  const auto take = [&]() noexcept {
    find_wall_faces(field, faces);
    for (std::size_t k = 0; k < faces.count; ++k) {
      const std::size_t n = whose[k];
      screened.kind[n] = faces.found[k] ? Screened::kOfFace : screened.kind[n] == 3.0 ? 1.0 : 0.0;
      if (!faces.found[k])
        continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        planes.normal[axis][n] = faces.normal[k][static_cast<Eigen::Index>(axis)];
      planes.gap_m[n] = faces.gap_m[k];
    }
    faces.count = 0;
  };
  for (std::size_t n = 0; n < block.count; ++n) {
    if (screened.kind[n] < 2.0)
      continue;
    faces.at[faces.count] = (frame.local + taken(block.arm, n)) / field.grid().edge;
    faces.outward[faces.count] = taken(block.normal, n);
    whose[faces.count++] = n;
    if (faces.count == WallFaces::kPoints)
      take();
  }
  if (faces.count > 0)
    take();
}

}  // namespace

void add_rows(const Hits& hits, bool in_surface, const voxmap::DistanceField& field,
              const RowFrame& frame, std::vector<ConstraintRow>& rows) noexcept {
  const PushKernel& kernel = push_kernel(instructions());
  const double widest = limits::kRowGapEdges * field.grid().edge;
  HitBlock block;
  FieldSamples samples;
  FieldPlanes planes;
  Screened screened;
  alignas(64) double levers[3][HitBlock::kHits];
  for (std::size_t begin = 0; begin < hits.size(); begin += HitBlock::kHits) {
    fill_block(kernel, hits, begin, block);
    sample_block(field, frame.local, block, samples);
    find_planes(block, samples, planes);
    screen(block, samples, planes, in_surface, screened);
    if (in_surface)
      take_wall_faces(block, field, frame, screened, planes);
    find_levers(block, planes, frame.lever_m, levers);
    for (std::size_t n = 0; n < block.count; ++n) {
      if (!(screened.kind[n] > 0.0 && planes.gap_m[n] <= widest))
        continue;
      const Vec3 normal = taken(planes.normal, n), half = taken(levers, n);
      rows.emplace_back(Vec6(normal.x(), normal.y(), normal.z(), half.x(), half.y(), half.z()),
                        taken(block.arm, n), planes.gap_m[n], hits.point(begin + n), frame.object,
                        screened.kind[n] == Screened::kOfFace);
    }
  }
}

void add_edge_rows(const HitList& hits, const ContactQuery& edges,
                   const voxmap::DistanceField& tool, bool smooth, const RowFrame& frame,
                   const Quat& orientation, std::vector<ConstraintRow>& rows) noexcept {
  const RowFrame swapped{hits.pose_WT.position - tool.grid().origin, frame.lever_m, frame.object};
  const std::size_t first = rows.size();
  add_rows(hits.surface, false, tool, swapped, rows);
  add_rows(hits.interior, false, tool, swapped, rows);
  if (smooth)
    smooth_normals(tool, swapped, std::span(rows).subspan(first));
  std::size_t kept = first;
  for (std::size_t n = first; n < rows.size(); ++n) {
    const ConstraintRow& row = rows[n];
    const Vec3 normal = -(orientation * row.normal());
    if (!(normal.dot(edges.shell().normal(row.point)) < -limits::kEdgeAgree))
      continue;
    const Vec3 arm = orientation * (hits.pose_WT.position + row.arm),
               half = arm.cross(normal) / frame.lever_m;
    rows[kept++] = {Vec6(normal.x(), normal.y(), normal.z(), half.x(), half.y(), half.z()),
                    arm,
                    row.gap_m,
                    row.point,
                    row.object,
                    true};
  }
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(kept), rows.end());
}

void smooth_normals(const voxmap::DistanceField& field, const RowFrame& frame,
                    std::span<ConstraintRow> rows) noexcept {
  constexpr std::size_t kTogether = voxmap::DistanceField::kSmoothTogether;
  const double widest = limits::kSmoothGapEdges * field.grid().edge;
  ConstraintRow* whose[kTogether];
  Vec3 at[kTogether], gradients[kTogether];
  std::size_t count = 0;
  const auto smooth = [&]() noexcept {
    field.smooth_gradients(count, at, gradients);
    for (std::size_t n = 0; n < count; ++n) {
      ConstraintRow& row = *whose[n];
      const double steepness = gradients[n].norm();
      if (!(steepness >= limits::kSmoothGradient))
        continue;
      row.jacobian.head<3>() = gradients[n] / steepness;
      row.jacobian.tail<3>() = row.arm.cross(row.normal()) / frame.lever_m;
    }
    count = 0;
  };
  for (ConstraintRow& row : rows) {
    if (row.object != frame.object || row.of_face || row.gap_m > widest)
      continue;
    at[count] = (frame.local + row.arm) / field.grid().edge;
    whose[count++] = &row;
    if (count == kTogether)
      smooth();
  }
  if (count > 0)
    smooth();
}

void keep_nearest(std::vector<ConstraintRow>& rows, double tilt) noexcept {
  if (rows.size() <= limits::kMaxRows)
    return;
  std::array<Chosen, kDirectionBins> bins;
  std::array<bool, kDirectionBins> used{};
  NormalBlock normals;
  RowBlock block;
  for (; block.first < rows.size(); block.first += RowBlock::kRows) {
    normals.count = block.count = std::min(RowBlock::kRows, rows.size() - block.first);
    for (std::size_t n = 0; n < block.count; ++n) {
      const ConstraintRow& row = rows[block.first + n];
      block.gap[n] = row.gap_m;
      for (int axis = 0; axis < 3; ++axis)
        normals.along[axis][n] = row.jacobian[axis], block.arm[axis][n] = row.arm[axis];
    }
    nearest_direction_bins(normals, block.bin);
    for (std::size_t n = 0; n < block.count; ++n)
      if (const std::uint32_t k = block.bin[n]; !used[k])
        used[k] = true, begin_choice(rows[block.first + n].normal(), bins[k]);
    choose(block, tilt, bins.data());
  }
  // First the nearest row of every direction, then one side after the other while there is room.
  std::array<std::uint32_t, limits::kMaxRows> kept;
  std::size_t count = 0;
  const auto keep = [&](double row) {
    const auto number = static_cast<std::uint32_t>(row);
    if (count < kept.size() &&
        std::find(kept.begin(), kept.begin() + count, number) == kept.begin() + count)
      kept[count++] = number;
  };
  for (std::size_t k = 0; k < kDirectionBins; ++k)
    if (used[k])
      keep(bins[k].row);
  for (std::size_t side = 0; side < kSides; ++side)
    for (std::size_t k = 0; k < kDirectionBins; ++k)
      if (used[k])
        keep(bins[k].tilted_row[side]);
  std::sort(kept.begin(), kept.begin() + count);
  for (std::size_t n = 0; n < count; ++n)
    rows[n] = rows[kept[n]];
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(count), rows.end());
}

}  // namespace voxtouch::contact
