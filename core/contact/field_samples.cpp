#include "core/contact/field_samples.hpp"

#include <cmath>

#include "core/contact/limits.hpp"
#include "core/types/clones.hpp"
#include "core/voxmap/interpolation.hpp"

namespace voxtouch::contact {
namespace {

constexpr std::size_t kHits = HitBlock::kHits;
using Arrays = voxmap::DistanceField::Arrays;

/// Voxels of the table and the positions in them.
struct Places {
  alignas(64) double within[3][kHits], inside[kHits];  ///< 0: outside the table
  alignas(64) std::int32_t voxel[3][kHits];
};

// The arguments of the following functions do not overlap. Without this declaration the loops are
// not vectorised.

VOXTOUCH_CLONES void find_places(const HitBlock& __restrict block, const Vec3& local, double edge,
                                 const Arrays& arrays, Places& __restrict places) noexcept {
  const std::size_t filled = block.filled();
  for (std::size_t n = 0; n < filled; ++n)
    places.inside[n] = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double origin = local[static_cast<Eigen::Index>(axis)], base = arrays.base[axis];
    const double size = static_cast<double>(arrays.cells[axis] * voxmap::DistanceField::kBrickEdge);
    for (std::size_t n = 0; n < filled; ++n) {
      const double u = (origin + block.arm[axis][n]) / edge - base;
      const double above = u >= 0.0 ? places.inside[n] : 0.0, inside = u < size ? above : 0.0,
                   in_table = inside > 0.0 ? u : 0.0;
      const auto voxel = static_cast<std::int32_t>(in_table);
      places.voxel[axis][n] = voxel;
      places.within[axis][n] = in_table - voxel;
      places.inside[n] = inside;
    }
  }
}

/// The eight nodes of each voxel. Without a stored entry all have the cut-off value.
void find_nodes(const Places& places, const Arrays& arrays, std::size_t count,
                double (&nodes)[8][kHits]) noexcept {
  using Field = voxmap::DistanceField;
  constexpr std::int32_t kY = Field::kNodeEdge, kZ = Field::kNodeEdge * Field::kNodeEdge;
  for (std::size_t n = 0; n < count; ++n) {
    const std::int32_t x = places.voxel[0][n], y = places.voxel[1][n], z = places.voxel[2][n];
    const std::int32_t entry =
        places.inside[n] == 0.0
            ? Field::kFree
            : arrays.table[(x >> 3) +
                           arrays.cells[0] * ((y >> 3) + arrays.cells[1] * std::int64_t{z >> 3})];
    if (entry < 0) {
      const double all = entry == Field::kDeep ? -arrays.depth_voxels : arrays.band_voxels;
      for (std::size_t k = 0; k < 8; ++k)
        nodes[k][n] = all;
      continue;
    }
    const float* const node = arrays.bricks[entry].data() + ((x & 7) + kY * (y & 7) + kZ * (z & 7));
    for (std::size_t k = 0; k < 8; ++k)
      nodes[k][n] = node[(k & 1) + kY * (k >> 1 & 1) + kZ * (k >> 2)];
  }
}

VOXTOUCH_CLONES void interpolate(const Places& __restrict places,
                                 const double (&__restrict nodes)[8][kHits], std::size_t filled,
                                 double edge, FieldSamples& __restrict samples) noexcept {
  for (std::size_t n = 0; n < filled; ++n) {
    const double d[8] = {nodes[0][n], nodes[1][n], nodes[2][n], nodes[3][n],
                         nodes[4][n], nodes[5][n], nodes[6][n], nodes[7][n]};
    const voxmap::Interpolated at =
        voxmap::interpolated(d, places.within[0][n], places.within[1][n], places.within[2][n]);
    samples.distance_m[n] = edge * at.value;
    samples.gradient[0][n] = at.along_x, samples.gradient[1][n] = at.along_y,
    samples.gradient[2][n] = at.along_z;
    double least = d[0];
    for (std::size_t k = 1; k < 8; ++k)
      least = d[k] < least ? d[k] : least;
    samples.least[n] = least;
  }
}

/// Three products, summed as in Eigen's dot product: the first two form a packet.
VOXTOUCH_INLINE double dot(double x, double y, double z) noexcept { return (x + y) + z; }

/// `length` >= 0 as a divisor. It is a sum, because for a conditional expression GCC 12 selects
/// between quotients and divides by zero.
VOXTOUCH_INLINE double one_where_zero(double length) noexcept {
  return length + (length > 0.0 ? 0.0 : 1.0);
}

/// `ends`: 1 if the force would not grow with depth, else 0.
VOXTOUCH_CLONES void weigh(const HitBlock& __restrict block, const FieldSamples& __restrict samples,
                           double depth_voxels, PenaltyForces& __restrict normal,
                           PenaltyForces& __restrict gradient,
                           double (&__restrict ends)[kHits]) noexcept {
  constexpr double kFlat = limits::kFlatGradient;
  const std::size_t filled = block.filled();
  for (std::size_t n = 0; n < filled; ++n) {
    const double gx = samples.gradient[0][n], gy = samples.gradient[1][n],
                 gz = samples.gradient[2][n];
    const double nx = block.normal[0][n], ny = block.normal[1][n], nz = block.normal[2][n];
    const double weight = block.weight[n], force = weight * -samples.distance_m[n];
    const double squared = dot(gx * gx, gy * gy, gz * gz), steepness = std::sqrt(squared);
    const double over = 1.0 / one_where_zero(steepness);
    normal.j[0][n] = nx, normal.j[1][n] = ny, normal.j[2][n] = nz;
    gradient.j[0][n] = gx * over, gradient.j[1][n] = gy * over, gradient.j[2][n] = gz * over;
    normal.force[n] = force > 0.0 ? force : 0.0;
    const double half = 0.5 * weight * steepness;
    normal.weight[n] = gradient.weight[n] = force > 0.0 ? half : 0.0;
    const double deep = samples.least[n] <= -depth_voxels ? 1.0 : 0.0,
                 flat = squared < kFlat * kFlat ? 1.0 : deep;
    ends[n] = dot(nx * gx, ny * gy, nz * gz) < -kFlat ? 1.0 : flat;
  }
}

}  // namespace

void sample_block(const voxmap::DistanceField& field, const Vec3& local, const HitBlock& block,
                  FieldSamples& samples) noexcept {
  const Arrays arrays = field.arrays();
  const double edge = field.grid().edge;
  Places places;
  alignas(64) double nodes[8][kHits];
  find_places(block, local, edge, arrays, places);
  find_nodes(places, arrays, block.filled(), nodes);
  interpolate(places, nodes, block.filled(), edge, samples);
}

bool field_forces(const HitBlock& block, const FieldSamples& samples, double depth_voxels,
                  PenaltyForces& along_normal, PenaltyForces& along_gradient,
                  PenaltyLanes& lanes) noexcept {
  alignas(64) double ends[kHits];
  weigh(block, samples, depth_voxels, along_normal, along_gradient, ends);
  bool at_its_end = false;
  along_normal.groups = 0;
  for (std::size_t begin = 0; begin < block.filled(); begin += kLanes) {
    bool any = false;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (!(along_normal.force[begin + lane] > 0.0))
        continue;
      any = true;
      at_its_end = at_its_end || ends[begin + lane] > 0.0;
      const double depth = -samples.distance_m[begin + lane];
      if (depth > lanes.deepest[lane])
        lanes.deepest[lane] = depth,
        lanes.deepest_hit[lane] = static_cast<double>(block.group_place(begin));
    }
    if (any)
      along_normal.group[along_normal.groups++] = static_cast<std::uint32_t>(begin);
  }
  along_gradient.groups = along_normal.groups;
  for (std::size_t g = 0; g < along_normal.groups; ++g)
    along_gradient.group[g] = along_normal.group[g];
  return at_its_end;
}

}  // namespace voxtouch::contact
