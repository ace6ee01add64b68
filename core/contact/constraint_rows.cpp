#include "core/contact/constraint_rows.hpp"

#include <algorithm>
#include <array>

#include "core/contact/limits.hpp"
#include "core/contact/patch_normals.hpp"

namespace voxtouch {
namespace {

struct Plane {
  Vec3 normal = Vec3::Zero();
  double gap_m = 0.0;
};

/// Whether any corner of the point's voxel is inside.
bool inside_near(const DistanceField& field, const Vec3& u) noexcept {
  const VoxelIndex v = Grid::voxel_of(u);
  for (int corner = 0; corner < 8; ++corner)
    if (field.node({v.i + (corner & 1), v.j + (corner >> 1 & 1), v.k + (corner >> 2 & 1)}) < 0.0) return true;
  return false;
}

/// The wall's plane as the field has it an edge farther out along the point's own normal. False where that is no plane of this wall:
/// the normal runs along it, or the field is bent there too.
bool plane_of_sheet(const Hit& hit, const DistanceField& field, const Vec3& u, Plane& plane) noexcept {
  const FieldSample out = field.at(u + hit.normal);
  const double steepness = out.gradient.norm();
  if (!(steepness >= contact_limits::kSheetGradient)) return false;
  plane.normal = out.gradient / steepness;
  const double agree = plane.normal.dot(hit.normal);
  plane.gap_m = out.distance_m / steepness - field.grid().edge * agree;
  return agree >= contact_limits::kSheetAgree;
}

bool is_bent(const Hit& hit, const FieldSample& at, double steepness) noexcept {
  return steepness < contact_limits::kSheetGradient || at.gradient.dot(hit.normal) < -contact_limits::kSheetAgainst * steepness;
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
  return {a, Vec3(h * (a + b)), b, Vec3(h * (b - a)), Vec3(-a), Vec3(-h * (a + b)), Vec3(-b), Vec3(h * (a - b))};
}

}  // namespace

bool make_row(const Hit& hit, bool in_surface, const DistanceField& field, const RowFrame& frame, ConstraintRow& row) noexcept {
  const double edge = field.grid().edge;
  const Vec3 u = (frame.local + hit.arm) / edge;
  const FieldSample at = field.at(u);
  const double steepness = at.gradient.norm();
  Plane plane;
  if (!(in_surface && is_bent(hit, at, steepness) && !inside_near(field, u) && plane_of_sheet(hit, field, u, plane))) {
    if (!(steepness >= contact_limits::kLeastGradient)) return false;
    plane = {at.gradient / steepness, at.distance_m / steepness};
  }
  if (!(plane.gap_m <= contact_limits::kRowGapEdges * edge)) return false;
  row.jacobian.head<3>() = plane.normal;
  row.jacobian.tail<3>() = hit.arm.cross(plane.normal) / frame.lever_m;
  row.arm = hit.arm;
  row.gap_m = plane.gap_m;
  row.point = hit.point;
  row.object = frame.object;
  return true;
}

void keep_nearest(std::vector<ConstraintRow>& rows, double tilt) noexcept {
  if (rows.size() <= contact_limits::kMaxRows) return;
  std::array<Chosen, PatchNormals::kBins> bins;
  std::array<std::array<Vec3, kSides>, PatchNormals::kBins> sides;
  std::array<bool, PatchNormals::kBins> used{};
  for (std::uint32_t n = 0; n < rows.size(); ++n) {
    const ConstraintRow& row = rows[n];
    const std::size_t k = PatchNormals::nearest_bin(row.normal());
    if (!used[k]) {
      used[k] = true;
      sides[k] = sides_of(row.normal());
      bins[k].row.fill(kNone);
      bins[k].gap.fill(0.0);
    }
    for (std::size_t choice = 0; choice < kChoices; ++choice) {
      const double gap = choice == 0 ? row.gap_m : row.gap_m - tilt * row.arm.dot(sides[k][choice - 1]);
      if (bins[k].row[choice] != kNone && !(gap < bins[k].gap[choice])) continue;
      bins[k].row[choice] = n;
      bins[k].gap[choice] = gap;
    }
  }
  // First the nearest of every direction, then one side after the other, until there is no room.
  std::array<std::uint32_t, contact_limits::kMaxRows> kept;
  std::size_t count = 0;
  for (std::size_t choice = 0; choice < kChoices; ++choice)
    for (std::size_t k = 0; k < PatchNormals::kBins && count < kept.size(); ++k)
      if (used[k] && std::find(kept.begin(), kept.begin() + count, bins[k].row[choice]) == kept.begin() + count)
        kept[count++] = bins[k].row[choice];
  std::sort(kept.begin(), kept.begin() + count);
  for (std::size_t n = 0; n < count; ++n) rows[n] = rows[kept[n]];
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(count), rows.end());
}

}  // namespace voxtouch
