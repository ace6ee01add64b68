#include "core/contact/wall_faces.hpp"

#include <cmath>
#include <limits>

#include "core/contact/limits.hpp"
#include "core/types/clones.hpp"

namespace voxtouch::contact {
namespace {

constexpr std::size_t kPoints = WallFaces::kPoints, kCorners = 16;
using Lanes = double[kPoints];

/// Distances at the corners of two voxels for each point: its own, and the one an edge farther out along the tool's normal.
struct Corners {
  alignas(64) Lanes from_point[kCorners][3], distance[kCorners];  ///< [e]; the distance as the field has it
  alignas(64) Lanes is_there[kCorners];  ///< 1; 0 where it may be cut off, or the two voxels are one
};

/// Planes n.x = c, and what they are fitted to.
struct Fits {
  alignas(64) Lanes normal[3], c;
  alignas(64) Lanes used, middle[3], mean, slopes[3], moments[6];
};

/// The points and their two voxels, in grid coordinates.
struct Places {
  alignas(64) Lanes at[3], voxel[2][3];
};

/// The distances at the corners of one voxel.
void look_up(const voxmap::DistanceField::Arrays& arrays, const voxmap::VoxelIndex& v, double (&distance)[8]) noexcept {
  using Field = voxmap::DistanceField;
  constexpr std::int32_t kY = Field::kNodeEdge, kZ = Field::kNodeEdge * Field::kNodeEdge;
  const std::int64_t x = std::int64_t{v.i} - arrays.base[0], y = std::int64_t{v.j} - arrays.base[1], z = std::int64_t{v.k} - arrays.base[2];
  const bool in_table = (x | y | z) >= 0 && (x >> 3) < arrays.cells[0] && (y >> 3) < arrays.cells[1] && (z >> 3) < arrays.cells[2];
  const std::int32_t entry = in_table ? arrays.table[(x >> 3) + arrays.cells[0] * ((y >> 3) + arrays.cells[1] * (z >> 3))] : Field::kFree;
  if (entry < 0) {  // nothing is stored: all are cut off
    for (int k = 0; k < 8; ++k) distance[k] = entry == Field::kDeep ? -arrays.depth_voxels : arrays.band_voxels;
    return;
  }
  const float* const node = arrays.bricks[entry].data() + ((x & 7) + kY * (y & 7) + kZ * (z & 7));
  for (int k = 0; k < 8; ++k) distance[k] = node[(k & 1) + kY * (k >> 1 & 1) + kZ * (k >> 2)];
}

/// \returns how many corners there are.
std::size_t put_corners(const voxmap::DistanceField::Arrays& arrays, const Vec3& u, const Vec3& outward, std::size_t lane, Places& places,
                        Corners& corners) noexcept {
  const voxmap::VoxelIndex here = voxmap::Grid::voxel_of(u), out = voxmap::Grid::voxel_of(u + outward);
  std::size_t count = 0;
  double distance[8];
  for (std::size_t which = 0; which < 2; ++which) {
    const voxmap::VoxelIndex& v = which == 0 ? here : out;
    const bool asked = which == 0 || !(out == here);
    if (asked) look_up(arrays, v, distance);
    for (std::size_t k = 0; k < 8; ++k) {
      const bool there = asked && !(distance[k] > limits::kSheetFarEdges);
      corners.distance[8 * which + k][lane] = distance[k];
      corners.is_there[8 * which + k][lane] = there ? 1.0 : 0.0;
      count += there;
    }
    places.voxel[which][0][lane] = v.i, places.voxel[which][1][lane] = v.j, places.voxel[which][2][lane] = v.k;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) places.at[axis][lane] = u[static_cast<Eigen::Index>(axis)];
  return count;
}

VOXTOUCH_CLONES void put_ways(const Places& __restrict places, Corners& __restrict corners) noexcept {
  for (std::size_t k = 0; k < kCorners; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double beside = static_cast<double>(k >> axis & 1);
      for (std::size_t n = 0; n < kPoints; ++n) corners.from_point[k][axis][n] = (places.voxel[k / 8][axis][n] + beside) - places.at[axis][n];
    }
}

/// Sums over the corners on the side of the normal, in the corners' order. For these n.x_k - d_k is c; behind the wall it falls short of c by the wall's
/// thickness and twice the distance, so they are those near the largest.
VOXTOUCH_CLONES void sum_up(const Corners& __restrict corners, double tolerance, Fits& __restrict fits) noexcept {
  constexpr double kKeep = 1e-3;  // where the corners leave a direction open, the one before stays
  alignas(64) Lanes reach[kCorners], most, here[3], low;
  for (std::size_t n = 0; n < kPoints; ++n) most[n] = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < kCorners; ++k)
    for (std::size_t n = 0; n < kPoints; ++n) {
      const double along = (fits.normal[0][n] * corners.from_point[k][0][n] + fits.normal[1][n] * corners.from_point[k][1][n]) +
                           fits.normal[2][n] * corners.from_point[k][2][n];
      reach[k][n] = corners.is_there[k][n] > 0.0 ? along - corners.distance[k][n] : -std::numeric_limits<double>::infinity();
      most[n] = reach[k][n] > most[n] ? reach[k][n] : most[n];
    }
  for (std::size_t n = 0; n < kPoints; ++n) {
    low[n] = most[n] - tolerance;
    fits.used[n] = fits.mean[n] = fits.middle[0][n] = fits.middle[1][n] = fits.middle[2][n] = 0.0;
  }
  for (std::size_t k = 0; k < kCorners; ++k)
    for (std::size_t n = 0; n < kPoints; ++n) {
      const bool on = reach[k][n] >= low[n];
      for (std::size_t axis = 0; axis < 3; ++axis)
        fits.middle[axis][n] = on ? fits.middle[axis][n] + corners.from_point[k][axis][n] : fits.middle[axis][n];
      fits.mean[n] = on ? fits.mean[n] + corners.distance[k][n] : fits.mean[n];
      fits.used[n] = on ? fits.used[n] + 1.0 : fits.used[n];
    }
  for (std::size_t n = 0; n < kPoints; ++n) {
    fits.mean[n] /= fits.used[n];
    for (std::size_t axis = 0; axis < 3; ++axis) fits.middle[axis][n] /= fits.used[n], fits.slopes[axis][n] = kKeep * fits.normal[axis][n];
    for (std::size_t m = 0; m < 6; ++m) fits.moments[m][n] = m < 3 ? kKeep : 0.0;  // xx yy zz, xy xz yz
  }
  for (std::size_t k = 0; k < kCorners; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t n = 0; n < kPoints; ++n) here[axis][n] = corners.from_point[k][axis][n] - fits.middle[axis][n];
    for (std::size_t n = 0; n < kPoints; ++n) {
      const bool on = reach[k][n] >= low[n];
      const double x = here[0][n], y = here[1][n], z = here[2][n], off = corners.distance[k][n] - fits.mean[n];
      const double of[6] = {x * x, y * y, z * z, x * y, x * z, y * z};
      for (std::size_t m = 0; m < 6; ++m) fits.moments[m][n] = on ? fits.moments[m][n] + of[m] : fits.moments[m][n];
      const double along[3] = {off * x, off * y, off * z};
      for (std::size_t axis = 0; axis < 3; ++axis) fits.slopes[axis][n] = on ? fits.slopes[axis][n] + along[axis] : fits.slopes[axis][n];
    }
  }
}

/// The planes of the sums, by the factors L D L' of their moments. `is_plane`: 1; 0 where there is none, and the normal before stays.
VOXTOUCH_CLONES void solve(Fits& __restrict fits, Lanes& __restrict is_plane) noexcept {
  for (std::size_t n = 0; n < kPoints; ++n) {
    const double xx = fits.moments[0][n], yy = fits.moments[1][n], zz = fits.moments[2][n], xy = fits.moments[3][n], xz = fits.moments[4][n], yz = fits.moments[5][n];
    const double yx = xy / xx, zx = xz / xx, d_y = yy - yx * xy, rest = yz - yx * xz, zy = rest / d_y, d_z = (zz - zx * xz) - zy * rest;
    const double a = fits.slopes[0][n], b = fits.slopes[1][n] - yx * a, c = (fits.slopes[2][n] - zx * a) - zy * b;
    const double z = c / d_z, y = b / d_y - zy * z, x = (a / xx - yx * y) - zx * z;
    const double length = std::sqrt((x * x + y * y) + z * z), enough = fits.used[n] >= static_cast<double>(limits::kSheetCorners) ? 1.0 : 0.0;
    const double long_enough = length > 0.5 ? 1.0 : 0.0, divisor = length + (1.0 - long_enough);
    const double nx = x / divisor, ny = y / divisor, nz = z / divisor;
    fits.normal[0][n] = long_enough > 0.0 ? nx : fits.normal[0][n];
    fits.normal[1][n] = long_enough > 0.0 ? ny : fits.normal[1][n];
    fits.normal[2][n] = long_enough > 0.0 ? nz : fits.normal[2][n];
    fits.c[n] = (nx * fits.middle[0][n] + ny * fits.middle[1][n]) + nz * fits.middle[2][n] - fits.mean[n];
    is_plane[n] = long_enough * enough;
  }
}

/// Whether the faces may reach the points' feet on them (1, else 0): nothing lies nearer to a corner than its distance, so a foot that does is beyond the
/// face's rim.
VOXTOUCH_CLONES void ask_whether_reached(const Corners& __restrict corners, const Fits& __restrict fits, Lanes& __restrict reached) noexcept {
  for (std::size_t n = 0; n < kPoints; ++n) reached[n] = 1.0;
  for (std::size_t k = 0; k < kCorners; ++k)
    for (std::size_t n = 0; n < kPoints; ++n) {
      const double x = fits.c[n] * fits.normal[0][n] - corners.from_point[k][0][n], y = fits.c[n] * fits.normal[1][n] - corners.from_point[k][1][n],
                   z = fits.c[n] * fits.normal[2][n] - corners.from_point[k][2][n];
      const double nearer = std::sqrt((x * x + y * y) + z * z) < std::abs(corners.distance[k][n]) - limits::kSheetBeyond ? 0.0 : 1.0;
      reached[n] = corners.is_there[k][n] > nearer ? 0.0 : reached[n];
    }
}

}  // namespace

void find_wall_faces(const voxmap::DistanceField& field, WallFaces& faces) noexcept {
  const voxmap::DistanceField::Arrays arrays = field.arrays();
  Corners corners;
  Places places;
  Fits fits;
  alignas(64) Lanes is_plane;
  std::size_t left = 0;
  for (std::size_t n = 0; n < kPoints; ++n) {
    const std::size_t p = n < faces.count ? n : 0;  // filled up with the first once more
    const Vec3 &u = faces.at[p], &outward = faces.outward[p];
    faces.found[n] = put_corners(arrays, u, outward, n, places, corners) >= limits::kSheetCorners && n < faces.count;
    left += faces.found[n];
    Vec3 normal = outward;
    if (faces.found[n]) {
      const Vec3 out = field.at(u + outward).gradient;
      const double steepness = out.norm();
      if (steepness > 0.3 && out.dot(outward) > 0.5 * steepness) normal = out / steepness;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) fits.normal[axis][n] = normal[static_cast<Eigen::Index>(axis)];
    fits.c[n] = 0.0;
  }
  if (left > 0) put_ways(places, corners);
  for (const double tolerance : {limits::kSheetCoarse, limits::kSheetFine, limits::kSheetFine}) {
    if (left == 0) return;
    sum_up(corners, tolerance, fits);
    solve(fits, is_plane);
    for (std::size_t n = 0; n < faces.count; ++n)
      if (faces.found[n] && !(is_plane[n] > 0.0)) faces.found[n] = false, --left;
  }
  alignas(64) Lanes reached;
  ask_whether_reached(corners, fits, reached);
  for (std::size_t n = 0; n < faces.count; ++n) {
    faces.normal[n] = Vec3(fits.normal[0][n], fits.normal[1][n], fits.normal[2][n]);
    faces.gap_m[n] = -fits.c[n] * field.grid().edge;
    // In a thick body one is deeper an edge farther in. Without this a round hole would be too narrow for its pin.
    faces.found[n] = faces.found[n] && faces.normal[n].dot(faces.outward[n]) >= limits::kSheetAgree && reached[n] > 0.0 &&
                     field.at(faces.at[n] - faces.normal[n]).distance_m >= faces.gap_m[n];
  }
}

}  // namespace voxtouch::contact
