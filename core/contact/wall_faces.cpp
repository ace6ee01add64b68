#include "core/contact/wall_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/limits.hpp"
#include "core/types/clones.hpp"

namespace voxtouch::contact {
namespace {

constexpr std::size_t kPoints = WallFaces::kPoints, kCorners = 16;
using Lanes = double[kPoints];

/// Distances at the corners of two voxels for each point: its own, and that one edge farther along
/// the tool's normal.
struct Corners {
  /// From the point to the lower and upper faces of either voxel on each axis [e].
  alignas(64) Lanes offset[2][3][2];
  alignas(
      /// [e]; as stored in the field. Beyond limits::kSheetFarEdges it may be cut off, or the two
      /// voxels coincide.
      64) Lanes distance[kCorners];

  VOXTOUCH_INLINE double from_point(std::size_t k, std::size_t axis, std::size_t n) const noexcept {
    return offset[k / 8][axis][k >> axis & 1][n];
  }
};

/// Planes n.x = c fitted to the corners.
struct Fits {
  alignas(64) Lanes normal[3], c,
      is_plane;  ///< the last: 1; 0 without a plane, and the previous normal is kept
};

VOXTOUCH_INLINE bool is_there(double distance) noexcept {
  return distance <= limits::kSheetFarEdges;
}

/// The distances at the corners of one voxel.
void look_up(const voxmap::DistanceField::Arrays& arrays, const voxmap::VoxelIndex& v,
             double (&distance)[8]) noexcept {
  using Field = voxmap::DistanceField;
  constexpr std::int32_t kY = Field::kNodeEdge, kZ = Field::kNodeEdge * Field::kNodeEdge;
  const std::int64_t x = std::int64_t{v.i} - arrays.base[0], y = std::int64_t{v.j} - arrays.base[1],
                     z = std::int64_t{v.k} - arrays.base[2];
  const bool in_table = (x | y | z) >= 0 && (x >> 3) < arrays.cells[0] &&
                        (y >> 3) < arrays.cells[1] && (z >> 3) < arrays.cells[2];
  const std::int32_t entry =
      in_table ? arrays.table[(x >> 3) + arrays.cells[0] * ((y >> 3) + arrays.cells[1] * (z >> 3))]
               : Field::kFree;
  if (entry < 0) {  // no stored entry: all have the cut-off value
    for (int k = 0; k < 8; ++k)
      distance[k] = entry == Field::kDeep ? -arrays.depth_voxels : arrays.band_voxels;
    return;
  }
  const float* const node = arrays.bricks[entry].data() + ((x & 7) + kY * (y & 7) + kZ * (z & 7));
  for (int k = 0; k < 8; ++k)
    distance[k] = node[(k & 1) + kY * (k >> 1 & 1) + kZ * (k >> 2)];
}

/// \returns the number of corners.
std::size_t put_corners(const voxmap::DistanceField::Arrays& arrays, const Vec3& u,
                        const Vec3& outward, std::size_t lane, Corners& corners) noexcept {
  const voxmap::VoxelIndex here = voxmap::Grid::voxel_of(u),
                           out = voxmap::Grid::voxel_of(u + outward);
  std::size_t count = 0;
  double distance[8];
  for (std::size_t which = 0; which < 2; ++which) {
    const voxmap::VoxelIndex& v = which == 0 ? here : out;
    const bool asked = which == 0 || !(out == here);
    if (asked) {
      look_up(arrays, v, distance);
    } else {
      std::fill_n(distance, 8, 2.0 * limits::kSheetFarEdges);
    }
    for (std::size_t k = 0; k < 8; ++k) {
      corners.distance[8 * which + k][lane] = distance[k];
      count += is_there(distance[k]);
    }
    const double low[3] = {static_cast<double>(v.i), static_cast<double>(v.j),
                           static_cast<double>(v.k)};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const std::size_t above : {0, 1})
        corners.offset[which][axis][above][lane] =
            (low[axis] + static_cast<double>(above)) - u[static_cast<Eigen::Index>(axis)];
  }
  return count;
}

/// Repeats the fit with the corners on the side of the normal. For these n.x_k - d_k is c. Behind
/// the wall it is less than c by the thickness of the wall and twice the distance, so the valid
/// corners are those near the largest value. Sums are in the order of the corners, unrolled to stay
/// in registers. The planes follow from the L D L' factors of the moments.
VOXTOUCH_CLONES void fit(const Corners& __restrict corners, double tolerance,
                         Fits& __restrict fits) noexcept {
  constexpr double kKeep = 1e-3;  // if the corners leave a direction undetermined, the previous one
                                  // is kept
  for (std::size_t n = 0; n < kPoints; ++n) {
    const double nx0 = fits.normal[0][n], ny0 = fits.normal[1][n], nz0 = fits.normal[2][n];
    double reach[kCorners], most = -std::numeric_limits<double>::infinity();
#pragma GCC unroll 16
    for (std::size_t k = 0; k < kCorners; ++k) {
      const double along = (nx0 * corners.from_point(k, 0, n) + ny0 * corners.from_point(k, 1, n)) +
                           nz0 * corners.from_point(k, 2, n);
      reach[k] = is_there(corners.distance[k][n]) ? along - corners.distance[k][n]
                                                  : -std::numeric_limits<double>::infinity();
      most = reach[k] > most ? reach[k] : most;
    }
    const double low = most - tolerance;
    double used = 0.0, mean = 0.0, mx = 0.0, my = 0.0, mz = 0.0;
#pragma GCC unroll 16
    for (std::size_t k = 0; k < kCorners; ++k) {
      const bool on = reach[k] >= low;
      mx = on ? mx + corners.from_point(k, 0, n) : mx;
      my = on ? my + corners.from_point(k, 1, n) : my;
      mz = on ? mz + corners.from_point(k, 2, n) : mz;
      mean = on ? mean + corners.distance[k][n] : mean;
      used = on ? used + 1.0 : used;
    }
    mean /= used, mx /= used, my /= used, mz /= used;
    double xx = kKeep, yy = kKeep, zz = kKeep, xy = 0.0, xz = 0.0, yz = 0.0, sx = kKeep * nx0,
           sy = kKeep * ny0, sz = kKeep * nz0;
#pragma GCC unroll 16
    for (std::size_t k = 0; k < kCorners; ++k) {
      const bool on = reach[k] >= low;
      const double x = corners.from_point(k, 0, n) - mx, y = corners.from_point(k, 1, n) - my,
                   z = corners.from_point(k, 2, n) - mz, off = corners.distance[k][n] - mean;
      xx = on ? xx + x * x : xx, yy = on ? yy + y * y : yy, zz = on ? zz + z * z : zz;
      xy = on ? xy + x * y : xy, xz = on ? xz + x * z : xz, yz = on ? yz + y * z : yz;
      sx = on ? sx + off * x : sx, sy = on ? sy + off * y : sy, sz = on ? sz + off * z : sz;
    }
    const double yx = xy / xx, zx = xz / xx, d_y = yy - yx * xy, rest = yz - yx * xz,
                 zy = rest / d_y, d_z = (zz - zx * xz) - zy * rest;
    const double a = sx, b = sy - yx * a, c = (sz - zx * a) - zy * b;
    const double z = c / d_z, y = b / d_y - zy * z, x = (a / xx - yx * y) - zx * z;
    const double length = std::sqrt((x * x + y * y) + z * z),
                 enough = used >= static_cast<double>(limits::kSheetCorners) ? 1.0 : 0.0;
    const double long_enough = length > 0.5 ? 1.0 : 0.0, divisor = length + (1.0 - long_enough);
    const double nx = x / divisor, ny = y / divisor, nz = z / divisor;
    fits.normal[0][n] = long_enough > 0.0 ? nx : nx0;
    fits.normal[1][n] = long_enough > 0.0 ? ny : ny0;
    fits.normal[2][n] = long_enough > 0.0 ? nz : nz0;
    fits.c[n] = (nx * mx + ny * my) + nz * mz - mean;
    fits.is_plane[n] = long_enough * enough;
  }
}

/// Whether the faces may reach the projections of the points (1, else 0). No surface is nearer to a
/// corner than its distance, so a nearer projection is beyond the rim of the face.
VOXTOUCH_CLONES void ask_whether_reached(const Corners& __restrict corners,
                                         const Fits& __restrict fits,
                                         Lanes& __restrict reached) noexcept {
  for (std::size_t n = 0; n < kPoints; ++n)
    reached[n] = 1.0;
  for (std::size_t k = 0; k < kCorners; ++k)
    for (std::size_t n = 0; n < kPoints; ++n) {
      const double x = fits.c[n] * fits.normal[0][n] - corners.from_point(k, 0, n),
                   y = fits.c[n] * fits.normal[1][n] - corners.from_point(k, 1, n),
                   z = fits.c[n] * fits.normal[2][n] - corners.from_point(k, 2, n);
      const double nearer = std::sqrt((x * x + y * y) + z * z) <
                                    std::abs(corners.distance[k][n]) - limits::kSheetBeyond
                                ? 0.0
                                : 1.0;
      const double there = is_there(corners.distance[k][n]) ? 1.0 : 0.0;
      reached[n] = there > nearer ? 0.0 : reached[n];
    }
}

}  // namespace

void find_wall_faces(const voxmap::DistanceField& field, WallFaces& faces) noexcept {
  const voxmap::DistanceField::Arrays arrays = field.arrays();
  Corners corners;
  Fits fits;
  std::size_t left = 0;
  for (std::size_t n = 0; n < kPoints; ++n) {
    const std::size_t p = n < faces.count ? n : 0;  // padded with the first point
    const Vec3 &u = faces.at[p], &outward = faces.outward[p];
    faces.found[n] =
        put_corners(arrays, u, outward, n, corners) >= limits::kSheetCorners && n < faces.count;
    left += faces.found[n];
    Vec3 normal = outward;
    if (faces.found[n]) {
      const Vec3 out = field.at(u + outward).gradient;
      const double steepness = out.norm();
      if (steepness > 0.3 && out.dot(outward) > 0.5 * steepness)
        normal = out / steepness;
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      fits.normal[axis][n] = normal[static_cast<Eigen::Index>(axis)];
    fits.c[n] = 0.0;
  }
  for (const double tolerance : {limits::kSheetCoarse, limits::kSheetFine, limits::kSheetFine}) {
    if (left == 0)
      return;
    fit(corners, tolerance, fits);
    for (std::size_t n = 0; n < faces.count; ++n)
      if (faces.found[n] && !(fits.is_plane[n] > 0.0))
        faces.found[n] = false, --left;
  }
  left = 0;
  for (std::size_t n = 0; n < faces.count; ++n) {
    faces.normal[n] = Vec3(fits.normal[0][n], fits.normal[1][n], fits.normal[2][n]);
    faces.gap_m[n] = -fits.c[n] * field.grid().edge;
    // In a thick body the depth increases one edge farther in. Without this test a round hole would
    // be too narrow for its pin.
    faces.found[n] = faces.found[n] &&
                     faces.normal[n].dot(faces.outward[n]) >= limits::kSheetAgree &&
                     field.at(faces.at[n] - faces.normal[n]).distance_m >= faces.gap_m[n];
    left += faces.found[n];
  }
  if (left == 0)
    return;
  alignas(64) Lanes reached;
  ask_whether_reached(corners, fits, reached);
  for (std::size_t n = 0; n < faces.count; ++n)
    faces.found[n] = faces.found[n] && reached[n] > 0.0;
}

}  // namespace voxtouch::contact
