#include "core/contact/query_kernel.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/contact/leaf_kernel.hpp"
#include "core/contact/limits.hpp"
#include "core/contact/penalty_sums.hpp"

namespace voxtouch::contact {
namespace {

constexpr std::size_t kNodes = SphereTree::kFanOut;
constexpr std::size_t kRun = SphereTree::kLeafPoints;
static_assert(kRun == 8 && kLanes == kRun);

/// Decides the `unsure` points in double precision.
void decide(const QueryData& data, const HitSource& s, Leaves& leaves) noexcept {
  for (std::size_t n = 0; n < leaves.count; ++n) {
    const unsigned unsure = leaves.unsure[n];
    if (unsure == 0)
      continue;
    unsigned surface = leaves.surface[n] & ~unsure, interior = leaves.interior[n] & ~unsure;
    for (unsigned bits = unsure; bits != 0; bits &= bits - 1) {
      const auto slot = static_cast<unsigned>(std::countr_zero(bits));
      const std::size_t p = kRun * leaves.leaf[n] + slot;
      Vec3 u;
      for (Eigen::Index row = 0; row < 3; ++row)
        u[row] = (s.r[row][0] * s.place[0][p] + s.r[row][1] * s.place[1][p] +
                  s.r[row][2] * s.place[2][p] + s.t[row]) /
                 s.edge;
      const voxmap::VoxelKind kind = data.voxmap->at(voxmap::Grid::voxel_of(u));
      if (kind == voxmap::VoxelKind::kSurface)
        surface |= 1U << slot;
      if (kind == voxmap::VoxelKind::kInterior)
        interior |= 1U << slot;
    }
    leaves.surface[n] = static_cast<std::uint8_t>(surface),
    leaves.interior[n] = static_cast<std::uint8_t>(interior);
  }
}

void set_sums(const HitSource& s, const NormalLanes& lanes, FoundHits& found) noexcept {
  const double x = combined(lanes.sum[0]), y = combined(lanes.sum[1]), z = combined(lanes.sum[2]);
  for (std::size_t row = 0; row < 3; ++row)
    found.normals[static_cast<Eigen::Index>(row)] =
        row_sum(row, s.r[row][0] * x, s.r[row][1] * y, s.r[row][2] * z);
  found.weights = combined(lanes.sum[3]);
}

/// Traverses the tree depth first, one group of spheres per level; `left` are the remaining ones.
/// Calls `leaf(n)` for each leaf that may touch.
template <class Leaf>
void walk(const Lookup& lookup, const LeafKernel& kernel, const SphereTree& tree,
          Leaf&& leaf) noexcept {
  const std::vector<SphereTree::Level>& levels = tree.levels();
  if (levels.empty())
    return;
  std::uint32_t left[SphereTree::kMaxLevels] = {};
  std::size_t base[SphereTree::kMaxLevels] = {};
  const auto enter = [&](std::size_t level, std::size_t first) {
    const std::size_t count = levels[level].count - first;
    const std::uint32_t real = count < kNodes ? (1U << count) - 1U : (1U << kNodes) - 1U;
    base[level] = first;
    left[level] =
        real &
        (lookup.map.free != nullptr ? kernel.near_spheres(lookup, levels[level], first) : real);
  };
  const std::size_t top = levels.size() - 1;
  std::size_t level = top;
  enter(top, 0);
  for (;;) {
    if (left[level] == 0) {
      if (level == top)
        break;
      ++level;
      continue;
    }
    const std::size_t node = base[level] + static_cast<std::size_t>(std::countr_zero(left[level]));
    left[level] &= left[level] - 1;
    if (level > 0)
      enter(--level, kNodes * node);
    else
      leaf(static_cast<std::uint32_t>(node));
  }
}

/// State of one query.
class Search {
 public:
  Search(const QueryData& data, const QueryFrame& frame, FoundHits& surface,
         FoundHits& interior) noexcept
      : lookup_{data, frame, data.voxmap->arrays()},
        kernel_(leaf_kernel(instructions())),
        surface_(surface),
        interior_(interior) {}

  std::uint32_t run() noexcept {
    walk(lookup_, kernel_, *lookup_.data.tree, [this](std::uint32_t leaf) noexcept { add(leaf); });
    if (leaves_.count > 0)
      test();
    set_sums(lookup_.frame.source, surface_lanes_, surface_);
    set_sums(lookup_.frame.source, interior_lanes_, interior_);
    return tested_;
  }

 private:
  void add(std::uint32_t leaf) noexcept {
    leaves_.leaf[leaves_.count] = leaf;
    if (++leaves_.count == Leaves::kMax)
      test();
  }

  void test() noexcept {
    const QueryData& data = lookup_.data;
    std::array<std::uint8_t, 3> any = {255, 255, 255};
    if (lookup_.frame.certain > 0.0F) {
      any = kernel_.classify(lookup_, leaves_);
    } else {
      std::fill_n(leaves_.unsure, leaves_.count, std::uint8_t{255});
    }
    tested_ += static_cast<std::uint32_t>(kRun * leaves_.count);
    // The last leaf of the shell may have fewer points.
    const std::size_t last = leaves_.count - 1, end = kRun * (leaves_.leaf[last] + std::size_t{1});
    if (end > data.points) {
      const auto real = static_cast<std::uint8_t>(255U >> (end - data.points));
      leaves_.surface[last] &= real, leaves_.interior[last] &= real, leaves_.unsure[last] &= real;
      tested_ -= static_cast<std::uint32_t>(end - data.points);
    }
    if (any[2] != 0)
      decide(data, lookup_.frame.source, leaves_), any[0] = any[1] = 255;
    if (any[0] != 0)
      take(leaves_.surface, surface_, surface_lanes_);
    if (any[1] != 0)
      take(leaves_.interior, interior_, interior_lanes_);
    leaves_.count = 0;
  }

  void take(const std::uint8_t* bits, FoundHits& found, NormalLanes& lanes) noexcept {
    const Chosen chosen(leaves_, bits);
    kernel_.append(leaves_, chosen, found);
    kernel_.add_normals(lookup_.frame.source, leaves_, chosen, lanes);
  }

  Lookup lookup_;
  const LeafKernel& kernel_;
  FoundHits& surface_;
  FoundHits& interior_;
  NormalLanes surface_lanes_, interior_lanes_;
  Leaves leaves_;
  std::uint32_t tested_ = 0;
};

}  // namespace

bool make_query_frame(const voxmap::Voxmap& voxmap, const HitSource& source, double reach_m,
                      QueryFrame& f) noexcept {
  const double edge = source.edge, reach = reach_m / edge;
  const std::array<std::int32_t, 3> base = {voxmap.base().i, voxmap.base().j, voxmap.base().k};
  f.source = source;
  // Voxels from `first` to that of the tool's origin.
  const double before_first = std::ceil(reach) + 2.0;
  double far = 0.0, beyond = 0.0, largest = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t column = 0; column < 3; ++column)
      f.a[axis][column] = static_cast<float>(source.r[axis][column] / edge);
    const double origin = source.t[axis] / edge,
                 size = static_cast<double>(voxmap.cells()[axis]) * voxmap::Voxmap::kBrickEdge;
    const double from_corner = origin - base[axis], voxel = std::floor(origin);
    far = std::max(far, std::abs(origin));
    largest = std::max({largest, std::abs(from_corner), size});
    beyond = std::max({beyond, -from_corner, from_corner - size});
    f.shift[axis] = static_cast<float>(origin - voxel + before_first);
    f.corner_shift[axis] = static_cast<float>(from_corner);
    f.size[axis] = static_cast<float>(size - 0.5);  // still in the last voxel
    const double first = voxel - before_first - base[axis];
    f.low[axis] = static_cast<float>(0.5 - first);
    f.high[axis] = static_cast<float>(size - 0.5 - first);
    f.first[axis] = static_cast<std::int32_t>(std::clamp(first, -1e9, 1e9));
  }
  constexpr double kFloat = 0x1p-24, kDouble = 0x1p-53;
  const double of_doubles = 16.0 * kDouble * (far + reach);
  // For a point, the roundings of three products, two inner sums, the last sum and the shift add up
  // to 2^-24 (8 reach + 6).
  const double band = 16.0 * kFloat * (reach + 4.0) + of_doubles;
  constexpr double kMaxReach = 0x1p20;  // beyond that, single-precision voxel numbers are not exact
  const bool small = reach < kMaxReach && largest < kMaxReach &&
                     voxmap.arrays().brick_count < std::size_t{1} << 26;
  f.certain = small ? static_cast<float>(0.5 - 2.0 * kFloat - band) : -1.0F;
  f.per_metre = static_cast<float>(1.0 / edge * (1.0 + 8.0 * kFloat));
  f.margin = static_cast<float>(limits::kCullSafetyVoxels + 16.0 * kFloat * (reach + largest) +
                                of_doubles);
  return beyond <= reach + f.margin;
}

std::uint32_t search(const QueryData& data, const QueryFrame& frame, FoundHits& surface,
                     FoundHits& interior) noexcept {
  surface.count = interior.count = 0;
  return data.tree->levels().empty() ? 0 : Search(data, frame, surface, interior).run();
}

}  // namespace voxtouch::contact
