#include "core/contact/query_kernel.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/contact/limits.hpp"
#include "core/types/clones.hpp"

namespace voxtouch::contact {
namespace {

constexpr std::size_t kNodes = SphereTree::kFanOut;
constexpr std::size_t kRun = SphereTree::kLeafPoints;
constexpr std::size_t kRuns = 4;  ///< leaves that are looked at together
constexpr std::size_t kPoints = kRuns * kRun;

constexpr std::array<std::uint32_t, 32> kBit = [] {
  std::array<std::uint32_t, 32> out{};
  for (std::size_t n = 0; n < 32; ++n) out[n] = 1U << n;
  return out;
}();

constexpr std::array<float, 256> kVoxelsOf = [] {
  std::array<float, 256> out{};
  for (std::size_t n = 0; n < 256; ++n) out[n] = voxmap::free_distance::voxels(static_cast<std::uint8_t>(n));
  return out;
}();

/// Which of sixteen spheres may touch something, as bits. No distance falls faster than the way from where it was measured, the
/// middle of a 4-voxel cell; outside the table there is nothing nearer than the table.
VOXTOUCH_INLINE std::uint32_t near_spheres(const QueryFrame& f, const voxmap::Voxmap::Arrays& map, const std::array<std::int64_t, 3>& cells,
                                           const SphereTree::Level& level, std::size_t base) noexcept {
  const float* const x = level.x.data() + base;
  const float* const y = level.y.data() + base;
  const float* const z = level.z.data() + base;
  const float* const radius = level.radius.data() + base;
  alignas(64) std::uint32_t cell[kNodes];
  alignas(64) float way[kNodes], outside[kNodes];
  const auto ny = static_cast<std::uint32_t>(2 * cells[1]), nz = static_cast<std::uint32_t>(2 * cells[2]);
  constexpr float kHalf = 0.5F * voxmap::free_distance::kCellEdge;
  for (std::size_t n = 0; n < kNodes; ++n) {
    const float ux = f.a[0][0] * x[n] + f.a[0][1] * y[n] + f.a[0][2] * z[n] + f.corner_shift[0];
    const float uy = f.a[1][0] * x[n] + f.a[1][1] * y[n] + f.a[1][2] * z[n] + f.corner_shift[1];
    const float uz = f.a[2][0] * x[n] + f.a[2][1] * y[n] + f.a[2][2] * z[n] + f.corner_shift[2];
    const auto within = [](float u, float size) {
      const float low = u > 0.0F ? u : 0.0F;
      return low < size ? low : size;
    };
    const float wx = within(ux, f.size[0]), wy = within(uy, f.size[1]), wz = within(uz, f.size[2]);
    outside[n] = (ux - wx) * (ux - wx) + (uy - wy) * (uy - wy) + (uz - wz) * (uz - wz);
    const std::int32_t cx = static_cast<std::int32_t>(wx) >> 2, cy = static_cast<std::int32_t>(wy) >> 2,
                       cz = static_cast<std::int32_t>(wz) >> 2;
    const auto from_middle = [](float u, std::int32_t c) { return u - (static_cast<float>(c << 2) + kHalf); };
    const float dx = from_middle(ux, cx), dy = from_middle(uy, cy), dz = from_middle(uz, cz);
    way[n] = dx * dx + dy * dy + dz * dz;
    cell[n] = (static_cast<std::uint32_t>(cx) * ny + static_cast<std::uint32_t>(cy)) * nz + static_cast<std::uint32_t>(cz);
  }
  alignas(64) float free[kNodes];
  for (std::size_t n = 0; n < kNodes; ++n) free[n] = kVoxelsOf[map.free[cell[n]]];
  std::uint32_t near = 0;
  for (std::size_t n = 0; n < kNodes; ++n) {
    const float needed = radius[n] * f.per_metre + f.margin;
    const float spare = free[n] - needed;
    const float reach = spare > 0.0F ? spare : 0.0F;
    near |= ((reach * reach > way[n]) | (outside[n] > needed * needed)) ? 0U : kBit[n];
  }
  return near;
}

using HalfWord = std::uint32_t __attribute__((may_alias));
constexpr std::int32_t kHalfWords = sizeof(voxmap::Voxmap::Brick) / sizeof(HalfWord);
static_assert(std::endian::native == std::endian::little);  // the lower half comes first

/// Leaves collected until there is a block of points of them.
struct Block {
  std::uint32_t leaf[kRuns];
  std::size_t leaves = 0;
};

struct Kinds {
  std::uint32_t surface = 0, interior = 0, unsure = 0;  ///< one bit a point of the block
};

/// Puts a block of points into voxels. Both decisions are good where `unsure` is not set.
VOXTOUCH_INLINE Kinds classify(const QueryData& data, const QueryFrame& f, const voxmap::Voxmap::Arrays& map,
                               const std::array<std::int64_t, 3>& cells, const Block& block) noexcept {
  alignas(64) float px[kPoints], py[kPoints], pz[kPoints];
  for (std::size_t run = 0; run < kRuns; ++run) {
    const std::size_t from = kRun * block.leaf[run];
    for (std::size_t n = 0; n < kRun; ++n) px[kRun * run + n] = data.x[from + n];
    for (std::size_t n = 0; n < kRun; ++n) py[kRun * run + n] = data.y[from + n];
    for (std::size_t n = 0; n < kRun; ++n) pz[kRun * run + n] = data.z[from + n];
  }
  alignas(64) std::int32_t cell[kPoints], voxel[kPoints], brick[kPoints];
  const auto sx = static_cast<std::int32_t>(cells[0]), sy = static_cast<std::int32_t>(cells[1]);
  Kinds kinds;
  for (std::size_t p = 0; p < kPoints; ++p) {
    const auto within = [](float u, float low, float high) {
      const float above = u > low ? u : low;
      return above < high ? above : high;
    };
    const float ux = within(f.a[0][0] * px[p] + f.a[0][1] * py[p] + f.a[0][2] * pz[p] + f.shift[0], f.low[0], f.high[0]);
    const float uy = within(f.a[1][0] * px[p] + f.a[1][1] * py[p] + f.a[1][2] * pz[p] + f.shift[1], f.low[1], f.high[1]);
    const float uz = within(f.a[2][0] * px[p] + f.a[2][1] * py[p] + f.a[2][2] * pz[p] + f.shift[2], f.low[2], f.high[2]);
    const auto ix = static_cast<std::int32_t>(ux), iy = static_cast<std::int32_t>(uy), iz = static_cast<std::int32_t>(uz);
    const auto off_middle = [](float u, std::int32_t i) { return std::abs((u - static_cast<float>(i)) - 0.5F); };
    const float dx = off_middle(ux, ix), dy = off_middle(uy, iy), dz = off_middle(uz, iz);
    kinds.unsure |= ((dx < f.certain) & (dy < f.certain) & (dz < f.certain)) ? 0U : kBit[p];
    const std::int32_t vx = ix + f.first[0], vy = iy + f.first[1], vz = iz + f.first[2];
    cell[p] = (vx >> 3) + sx * ((vy >> 3) + sy * (vz >> 3));
    voxel[p] = (vx & 7) | (vy & 7) << 3 | (vz & 7) << 6;
  }
  std::int32_t any = 0;
  for (std::size_t p = 0; p < kPoints; ++p) {
    brick[p] = map.table[cell[p]];
    any |= brick[p];
  }
  static_assert(voxmap::Voxmap::kFreeBrick == 0);
  if (any == 0) return kinds;
  // In halves of the bricks' words, so that a look is one of 32 bits for each point at once.
  const auto* const words = reinterpret_cast<const HalfWord*>(map.bricks);
  alignas(64) std::uint32_t kind[kPoints];
  for (std::size_t p = 0; p < kPoints; ++p) kind[p] = words[brick[p] * kHalfWords + (voxel[p] >> 4)];
  for (std::size_t p = 0; p < kPoints; ++p) kind[p] >>= 2 * (voxel[p] & 15);
  for (std::size_t p = 0; p < kPoints; ++p) {
    kinds.surface |= (kind[p] & 1U) != 0 ? kBit[p] : 0U;
    kinds.interior |= (kind[p] & 2U) != 0 ? kBit[p] : 0U;
  }
  return kinds;
}

/// What doubles say, for the bits of `unsure`.
void decide(const QueryData& data, const QueryFrame& f, const Block& block, Kinds& kinds) noexcept {
  const HitSource& s = f.source;
  kinds.surface &= ~kinds.unsure, kinds.interior &= ~kinds.unsure;
  for (std::uint32_t bits = kinds.unsure; bits != 0; bits &= bits - 1) {
    const auto slot = static_cast<std::size_t>(std::countr_zero(bits));
    const std::size_t p = kRun * block.leaf[slot / kRun] + slot % kRun;
    Vec3 u;
    for (Eigen::Index row = 0; row < 3; ++row)
      u[row] = (s.r[row][0] * s.place[0][p] + s.r[row][1] * s.place[1][p] + s.r[row][2] * s.place[2][p] + s.t[row]) / s.edge;
    const voxmap::VoxelKind kind = data.voxmap->at(voxmap::Grid::voxel_of(u));
    if (kind == voxmap::VoxelKind::kSurface) kinds.surface |= kBit[slot];
    if (kind == voxmap::VoxelKind::kInterior) kinds.interior |= kBit[slot];
  }
}

VOXTOUCH_INLINE void append(std::uint32_t bits, const Block& block, std::uint32_t* points, std::size_t& count) noexcept {
  for (; bits != 0; bits &= bits - 1) {
    const auto slot = static_cast<std::size_t>(std::countr_zero(bits));
    points[count++] = static_cast<std::uint32_t>(kRun * block.leaf[slot / kRun] + slot % kRun);
  }
}

}  // namespace

bool make_query_frame(const voxmap::Voxmap& voxmap, const HitSource& source, double reach_m, QueryFrame& f) noexcept {
  const double edge = source.edge, reach = reach_m / edge;
  const std::array<std::int32_t, 3> base = {voxmap.base().i, voxmap.base().j, voxmap.base().k};
  f.source = source;
  const double before_first = std::ceil(reach) + 2.0;  // voxels from `first` to that of the tool's origin
  double far = 0.0, beyond = 0.0, largest = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t column = 0; column < 3; ++column) f.a[axis][column] = static_cast<float>(source.r[axis][column] / edge);
    const double origin = source.t[axis] / edge, size = static_cast<double>(voxmap.cells()[axis]) * voxmap::Voxmap::kBrickEdge;
    const double from_corner = origin - base[axis], voxel = std::floor(origin);
    far = std::max(far, std::abs(origin));
    largest = std::max({largest, std::abs(from_corner), size});
    beyond = std::max({beyond, -from_corner, from_corner - size});
    f.shift[axis] = static_cast<float>(origin - voxel + before_first);
    f.corner_shift[axis] = static_cast<float>(from_corner);
    f.size[axis] = static_cast<float>(size - 0.5);  // in the last voxel still
    const double first = voxel - before_first - base[axis];
    f.low[axis] = static_cast<float>(0.5 - first);
    f.high[axis] = static_cast<float>(size - 0.5 - first);
    f.first[axis] = static_cast<std::int32_t>(std::clamp(first, -1e9, 1e9));
  }
  constexpr double kFloat = 0x1p-24, kDouble = 0x1p-53;
  const double of_doubles = 16.0 * kDouble * (far + reach);
  // A point: 3 roundings of each product, 2 inner sums, the last one and that of the shift come to 2^-24 (8 reach + 6).
  const double band = 16.0 * kFloat * (reach + 4.0) + of_doubles;
  constexpr double kMaxReach = 0x1p20;  // beyond that the single numbers of voxels are not whole any more
  const bool small = reach < kMaxReach && largest < kMaxReach && voxmap.arrays().brick_count < std::size_t{1} << 26;
  f.certain = small ? static_cast<float>(0.5 - 2.0 * kFloat - band) : -1.0F;
  f.per_metre = static_cast<float>(1.0 / edge * (1.0 + 8.0 * kFloat));
  f.margin = static_cast<float>(limits::kCullSafetyVoxels + 16.0 * kFloat * (reach + largest) + of_doubles);
  return beyond <= reach + f.margin;
}

VOXTOUCH_CLONES
std::uint32_t search(const QueryData& data, const QueryFrame& f, std::uint32_t* surface, std::size_t& surface_count,
                     std::uint32_t* interior, std::size_t& interior_count) noexcept {
  surface_count = interior_count = 0;
  const std::vector<SphereTree::Level>& levels = data.tree->levels();
  if (levels.empty()) return 0;
  const voxmap::Voxmap::Arrays map = data.voxmap->arrays();
  const std::array<std::int64_t, 3>& cells = data.voxmap->cells();
  const std::size_t points = data.points;
  std::uint32_t tested = 0;

  Block block;
  const auto test_block = [&]() __attribute__((always_inline)) {
    std::uint32_t real = block.leaves < kRuns ? (1U << (kRun * block.leaves)) - 1U : ~0U;
    for (std::size_t run = block.leaves; run < kRuns; ++run) block.leaf[run] = block.leaf[0];
    const std::size_t end = kRun * (block.leaf[block.leaves - 1] + std::size_t{1});
    if (end > points) real &= ~0U >> (kPoints - kRun * block.leaves + (end - points));
    tested += static_cast<std::uint32_t>(std::popcount(real));
    Kinds kinds;
    if (f.certain > 0.0F)
      kinds = classify(data, f, map, cells, block);
    else
      kinds.unsure = ~0U;
    kinds.surface &= real, kinds.interior &= real, kinds.unsure &= real;
    if (kinds.unsure != 0) decide(data, f, block, kinds);
    append(kinds.surface, block, surface, surface_count);
    append(kinds.interior, block, interior, interior_count);
    block.leaves = 0;
  };

  // Depth first, one group of spheres a level: `left` are those of it still to go through.
  std::uint32_t left[SphereTree::kMaxLevels] = {};
  std::size_t base[SphereTree::kMaxLevels] = {};
  const auto enter = [&](std::size_t level, std::size_t first) __attribute__((always_inline)) {
    const std::size_t count = levels[level].count - first;
    const std::uint32_t real = count < kNodes ? (1U << count) - 1U : (1U << kNodes) - 1U;
    base[level] = first;
    left[level] = real & (map.free != nullptr ? near_spheres(f, map, cells, levels[level], first) : real);
  };
  const std::size_t top = levels.size() - 1;
  std::size_t level = top;
  enter(top, 0);
  for (;;) {
    if (left[level] == 0) {
      if (level == top) break;
      ++level;
      continue;
    }
    const std::size_t node = base[level] + static_cast<std::size_t>(std::countr_zero(left[level]));
    left[level] &= left[level] - 1;
    if (level > 0) {
      enter(--level, kNodes * node);
      continue;
    }
    block.leaf[block.leaves] = static_cast<std::uint32_t>(node);
    if (++block.leaves == kRuns) test_block();
  }
  if (block.leaves > 0) test_block();
  return tested;
}

}  // namespace voxtouch::contact
