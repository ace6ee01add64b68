#include "plain_rows.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <limits>

#include "core/contact/direction_bins.hpp"
#include "core/contact/limits.hpp"

namespace voxtouch::test {
namespace {

using contact::ConstraintRow;
using contact::Hit;
using contact::RowFrame;
namespace limits = contact::limits;

struct Plane {
  Vec3 normal = Vec3::Zero();
  double gap_m = 0.0;
};

/// Distances at the corners of two voxels: the point's own, and the one an edge farther out along
/// the tool's normal.
struct Corners {
  std::array<Vec3, 16> from_point;  ///< [e]
  std::array<double, 16> distance;  ///< [e], as the field has it
  std::size_t count = 0;
};

Corners corners_near(const voxmap::DistanceField& field, const Vec3& u,
                     const Vec3& outward) noexcept {
  Corners corners;
  const voxmap::VoxelIndex here = voxmap::Grid::voxel_of(u),
                           out = voxmap::Grid::voxel_of(u + outward);
  for (int voxel = 0; voxel < (out == here ? 1 : 2); ++voxel) {
    const voxmap::VoxelIndex& v = voxel == 0 ? here : out;
    for (int k = 0; k < 8; ++k) {
      const voxmap::VoxelIndex at{v.i + (k & 1), v.j + (k >> 1 & 1), v.k + (k >> 2 & 1)};
      const double distance = field.node(at);
      if (distance > limits::kSheetFarEdges)
        continue;  // may be cut off
      corners.from_point[corners.count] = Vec3(at.i, at.j, at.k) - u;
      corners.distance[corners.count++] = distance;
    }
  }
  return corners;
}

/// The plane n.x = c through the wall's face on the side of `normal`, fitted to the corners that
/// lie on this side. For these n.x_k - d_k is c; behind the wall it falls short of c by its
/// thickness and twice the distance, so they are those near the largest. \returns how many they
/// are; `normal` is turned to the plane's.
std::size_t fit_face(const Corners& corners, double tolerance, Vec3& normal, double& c) noexcept {
  double most = -std::numeric_limits<double>::infinity();
  std::array<double, 16> reach;
  for (std::size_t k = 0; k < corners.count; ++k) {
    reach[k] = normal.dot(corners.from_point[k]) - corners.distance[k];
    most = std::max(most, reach[k]);
  }
  const auto on_this_side = [&](std::size_t k) noexcept { return reach[k] >= most - tolerance; };
  Vec3 middle = Vec3::Zero();
  double mean = 0.0;
  std::size_t used = 0;
  for (std::size_t k = 0; k < corners.count; ++k)
    if (on_this_side(k))
      middle += corners.from_point[k], mean += corners.distance[k], ++used;
  middle /= static_cast<double>(used), mean /= static_cast<double>(used);
  constexpr double kKeep = 1e-3;  // where the corners leave a direction open, the one before stays
  Mat3 moments = kKeep * Mat3::Identity();
  Vec3 slopes = kKeep * normal;
  for (std::size_t k = 0; k < corners.count; ++k)
    if (on_this_side(k)) {
      const Vec3 from = corners.from_point[k] - middle;
      moments += from * from.transpose();
      slopes += (corners.distance[k] - mean) * from;
    }
  const Vec3 next = moments.ldlt().solve(slopes);
  const double length = next.norm();
  if (!(length > 0.5))
    return 0;
  normal = next / length;
  c = normal.dot(middle) - mean;
  return used;
}

/// Whether the face may reach the point's foot on it: nothing lies nearer to a corner than its
/// distance, so a foot that does is beyond the face's rim.
bool reaches(const Corners& corners, const Vec3& nearest) noexcept {
  for (std::size_t k = 0; k < corners.count; ++k)
    if ((nearest - corners.from_point[k]).norm() <
        std::abs(corners.distance[k]) - limits::kSheetBeyond)
      return false;
  return true;
}

/// The wall's face on the tool's side. False where there is none that the tool's normal agrees
/// with.
bool plane_of_sheet(const Hit& hit, const voxmap::DistanceField& field, const Vec3& u,
                    Plane& plane) noexcept {
  const Corners corners = corners_near(field, u, hit.normal);
  if (corners.count < limits::kSheetCorners)
    return false;
  const Vec3 out = field.at(u + hit.normal).gradient;
  const double steepness = out.norm();
  Vec3 normal =
      steepness > 0.3 && out.dot(hit.normal) > 0.5 * steepness ? Vec3(out / steepness) : hit.normal;
  double c = 0.0;
  for (const double tolerance : {limits::kSheetCoarse, limits::kSheetFine, limits::kSheetFine})
    if (fit_face(corners, tolerance, normal, c) < limits::kSheetCorners)
      return false;
  plane = {normal, -c * field.grid().edge};
  if (!(normal.dot(hit.normal) >= limits::kSheetAgree))
    return false;
  if (!reaches(corners, c * normal))
    return false;
  // In a thick body one is deeper an edge farther in. Without this a round hole would be too narrow
  // for its pin.
  return field.at(u - normal).distance_m >= plane.gap_m;
}

bool is_bent(const Hit& hit, const Vec3& gradient, double steepness) noexcept {
  return steepness < limits::kSheetGradient ||
         gradient.dot(hit.normal) < -limits::kSheetAgainst * steepness;
}

/// `plane`: what the field says at the hit, whose gradient there is so long.
bool row_at(const Hit& hit, bool in_surface, const voxmap::DistanceField& field,
            const Vec3& gradient, double steepness, Plane plane, const RowFrame& frame,
            ConstraintRow& row, int& faces) noexcept {
  const double edge = field.grid().edge;
  Plane sheet;
  if (in_surface && is_bent(hit, gradient, steepness) &&
      plane_of_sheet(hit, field, (frame.local + hit.arm) / edge, sheet)) {
    plane = sheet;
    ++faces;
  } else if (!(steepness >= limits::kMinGradient)) {
    return false;
  }
  if (!(plane.gap_m <= limits::kRowGapEdges * edge))
    return false;
  row.jacobian.head<3>() = plane.normal;
  row.jacobian.tail<3>() = hit.arm.cross(plane.normal) / frame.lever_m;
  row.arm = hit.arm;
  row.gap_m = plane.gap_m;
  row.point = hit.point;
  row.object = frame.object;
  return true;
}

constexpr std::size_t kSides = 8, kChoices = kSides + 1;
constexpr std::uint32_t kNone = 0xffffffff;

/// In each direction: the row of least gap, and the rows deepest after a tilt to each side.
struct Chosen {
  std::array<std::uint32_t, kChoices> row;
  std::array<double, kChoices> gap;
};

/// Eight directions round `normal`.
std::array<Vec3, kSides> sides_of(const Vec3& normal) noexcept {
  const Vec3 a = normal.unitOrthogonal(), b = normal.cross(a);
  constexpr double h = 0.70710678118654752;
  return {a,        Vec3(h * (a + b)),  b,        Vec3(h * (b - a)),
          Vec3(-a), Vec3(-h * (a + b)), Vec3(-b), Vec3(h * (a - b))};
}

std::uint32_t bin_of(const Vec3& normal) noexcept {
  contact::NormalBlock one;
  std::uint32_t bins[contact::NormalBlock::kNormals];
  one.count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    one.along[axis][0] = normal[static_cast<Eigen::Index>(axis)];
  contact::nearest_direction_bins(one, bins);
  return bins[0];
}

}  // namespace

bool plain_row(const Hit& hit, bool in_surface, const voxmap::DistanceField& field,
               const RowFrame& frame, ConstraintRow& row, int& faces) noexcept {
  const voxmap::FieldSample at = field.at((frame.local + hit.arm) / field.grid().edge);
  const double steepness = at.gradient.norm(), divisor = steepness > 0.0 ? steepness : 1.0;
  return row_at(hit, in_surface, field, at.gradient, steepness,
                {at.gradient / divisor, at.distance_m / divisor}, frame, row, faces);
}

void keep_nearest_plainly(std::vector<contact::ConstraintRow>& rows, double tilt) noexcept {
  if (rows.size() <= limits::kMaxRows)
    return;
  std::array<Chosen, contact::kDirectionBins> bins;
  std::array<std::array<Vec3, kSides>, contact::kDirectionBins> sides;
  std::array<bool, contact::kDirectionBins> used{};
  for (std::uint32_t n = 0; n < rows.size(); ++n) {
    const ConstraintRow& row = rows[n];
    const std::size_t k = bin_of(row.normal());
    if (!used[k]) {
      used[k] = true;
      sides[k] = sides_of(row.normal());
      bins[k].row.fill(kNone);
      bins[k].gap.fill(0.0);
    }
    for (std::size_t choice = 0; choice < kChoices; ++choice) {
      const double gap =
          choice == 0 ? row.gap_m : row.gap_m - tilt * row.arm.dot(sides[k][choice - 1]);
      if (bins[k].row[choice] != kNone && !(gap < bins[k].gap[choice]))
        continue;
      bins[k].row[choice] = n;
      bins[k].gap[choice] = gap;
    }
  }
  // First the nearest of every direction, then one side after the other, until there is no room.
  std::array<std::uint32_t, limits::kMaxRows> kept;
  std::size_t count = 0;
  for (std::size_t choice = 0; choice < kChoices; ++choice)
    for (std::size_t k = 0; k < contact::kDirectionBins && count < kept.size(); ++k)
      if (used[k] && std::find(kept.begin(), kept.begin() + count, bins[k].row[choice]) ==
                         kept.begin() + count)
        kept[count++] = bins[k].row[choice];
  std::sort(kept.begin(), kept.begin() + count);
  for (std::size_t n = 0; n < count; ++n)
    rows[n] = rows[kept[n]];
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(count), rows.end());
}

}  // namespace voxtouch::test
