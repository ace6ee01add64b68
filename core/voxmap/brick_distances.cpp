#include "core/voxmap/brick_distances.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "core/types/clones.hpp"

// Skips a triangle if a lower bound of its distance exceeds an upper bound of the result for a
// node. Let q be the point of the triangle nearest to a centre c. The triangle is convex, so all of
// it is behind the plane through q across the line from q to c. Its distance from p is therefore at
// most |p - q| and at least
//     |c - q| + (p - c) . (c - q) / |c - q|
// The lower bound takes a few operations, for many p at once; only the remaining triangles are
// compared with the nodes in full. The bounds decide what is computed and do not change the result.
namespace voxtouch::voxmap {
namespace {

constexpr std::size_t kBlocks = kOwnNodes / kOfBlock, kLanes = kOfBlock;
static_assert(kBlocks == 16);
/// From the centre of a brick's nodes, or of a block's, to the farthest of them, with a margin for
/// rounding.
constexpr double kBrickReach = 3.5 * 1.7320509, kBlockReach = 2.1794496;
/// With more triangles near a brick than this, its blocks query the tree individually; with more
/// near a block, its nodes do.
constexpr std::size_t kMaxNear = 1024;
/// Added to every bound [voxels]: far more than the rounding. Below `kTooShort` the direction of a
/// difference is not significant.
constexpr double kSlack = 1e-3, kTooShort = 0.05;

using Points = DistanceTree::Points;
using Lanes = DistanceTree::Squares;

/// Calls f(own, x, y, z) for each own node.
template <class F>
constexpr void for_each_own(F&& f) {
  for (int z = 0; z < DistanceField::kBrickEdge; ++z)
    for (int y = 0; y < DistanceField::kBrickEdge; ++y)
      for (int x = 0; x < DistanceField::kBrickEdge; ++x)
        f(own_node(x, y, z), x, y, z);
}

/// Index of the brick's nodes.
constexpr std::array<std::uint16_t, kOwnNodes> kNodeOf = [] {
  std::array<std::uint16_t, kOwnNodes> out{};
  for_each_own([&](std::size_t own, int x, int y, int z) {
    out[own] = static_cast<std::uint16_t>(node_of_brick(x, y, z));
  });
  return out;
}();

/// From the centre of a brick to those of its blocks, and from there to their nodes.
constexpr Points kToBlocks = [] {
  Points out;
  for (std::size_t n = 0; n < kBlocks; ++n)
    out.x[n] = 4.0 * static_cast<double>(n & 1) - 2.0,
    out.y[n] = 4.0 * static_cast<double>(n >> 1 & 1) - 2.0,
    out.z[n] = 2.0 * static_cast<double>(n >> 2) - 3.0;
  return out;
}();
constexpr Points kToNodes = [] {
  Points out;
  for (std::size_t n = 0; n < kLanes; ++n)
    out.x[n] = static_cast<double>(n & 3) - 1.5, out.y[n] = static_cast<double>(n >> 2 & 3) - 1.5,
    out.z[n] = static_cast<double>(n >> 4) - 0.5;
  return out;
}();

constexpr std::array<std::int64_t, kLanes> kBitOf = [] {
  std::array<std::int64_t, kLanes> out{};
  for (std::size_t n = 0; n < kLanes; ++n)
    out[n] = std::int64_t{1} << n;
  return out;
}();

/// A triangle relative to a centre.
struct Seen {
  Vec3 direction;        ///< unit, from its nearest point; zero if that is too near
  double length, bound;  ///< of that difference; start of the lower bounds
  std::uint32_t place;
};

Seen seen_so(const Vec3& delta, std::uint32_t place) noexcept {
  const double length = delta.norm();
  if (length < kTooShort)
    return {Vec3::Zero(), length, -1.0, place};
  return {1.0 / length * delta, length, length - kSlack, place};
}

/// square[n] = |delta + step n|^2 if that is smaller; `place` is then that of the triangle.
VOXTOUCH_CLONES void keep_nearer(const double* x, const double* y, const double* z, double wx,
                                 double wy, double wz, std::int64_t place, double* square,
                                 std::int64_t* whose) noexcept {
  for (std::size_t n = 0; n < kBlocks; ++n) {
    const double dx = wx + x[n], dy = wy + y[n], dz = wz + z[n], here = dx * dx + dy * dy + dz * dz;
    whose[n] = here < square[n] ? place : whose[n];
    square[n] = here < square[n] ? here : square[n];
  }
}

/// One bit for each of `count` whose squared lower bound is at most `square`.
VOXTOUCH_CLONES std::int64_t may_be_near(const double* x, const double* y, const double* z,
                                         double nx, double ny, double nz, double bound,
                                         const double* square, std::size_t count) noexcept {
  std::int64_t bits = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const double least = bound + (nx * x[n] + ny * y[n] + nz * z[n]),
                 above = least > 0.0 ? least : 0.0;
    bits |= above * above <= square[n] ? kBitOf[n] : 0;
  }
  return bits;
}

std::uint32_t may_be_near(const Points& steps, const Seen& seen, const Lanes& square,
                          std::size_t count) noexcept {
  const Vec3& d = seen.direction;
  return static_cast<std::uint32_t>(may_be_near(steps.x.data(), steps.y.data(), steps.z.data(),
                                                d.x(), d.y(), d.z(), seen.bound, square.data(),
                                                count));
}

VOXTOUCH_CLONES void put_nodes(double x, double y, double z, double* px, double* py,
                               double* pz) noexcept {
  for (std::size_t n = 0; n < kLanes; ++n)
    px[n] = x + kToNodes.x[n], py[n] = y + kToNodes.y[n], pz[n] = z + kToNodes.z[n];
}

VOXTOUCH_CLONES void keep_least(const double* square, double* best) noexcept {
  for (std::size_t n = 0; n < kLanes; ++n)
    best[n] = square[n] < best[n] ? square[n] : best[n];
}

VOXTOUCH_CLONES void square_all(const double* limit, double* out) noexcept {
  for (std::size_t n = 0; n < kLanes; ++n)
    out[n] = limit[n] * limit[n];
}

/// The distance, at most the limit, with the sign of the limit.
VOXTOUCH_CLONES void signed_roots(const double* best, const double* limit, float* out) noexcept {
  for (std::size_t n = 0; n < kLanes; ++n) {
    const double most = limit[n] < 0.0 ? -limit[n] : limit[n], root = std::sqrt(best[n]),
                 distance = root < most ? root : most;
    out[n] = static_cast<float>(limit[n] < 0.0 ? -distance : distance);
  }
}

/// State of one brick.
class BrickFill {
 public:
  BrickFill(const DistanceTree& tree, const Vec3& first, const BrickLimits& limit,
            DistanceField::Brick& brick)
      : tree_(tree),
        middle_(first + Vec3::Constant(3.5)),
        limit_(limit),
        brick_(brick) {
    for (std::size_t own = 0; own < kOwnNodes; ++own) {
      double& farthest = farthest_[own / kOfBlock];
      farthest = std::max(farthest, std::abs(limit[own]));
    }
  }

  void fill(std::uint32_t place) {
    const double most = *std::max_element(farthest_.begin(), farthest_.end()) + kBrickReach;
    // The triangle nearest to any node is within the distance of the centre plus twice the distance
    // to that node.
    const double reach =
        std::min(tree_.nearest(middle_, most, place) + 2.0 * kBrickReach, most) + kSlack;
    if (!tree_.within(middle_, reach, kMaxNear, near_))
      return search_from_blocks(place);
    search_from_centre(reach);
    distribute();
    for (std::size_t block = 0; block < kBlocks; ++block)
      fill_block(block,
                 std::span(shared_).subspan(first_[block], first_[block + 1] - first_[block]));
  }

 private:
  Vec3 middle_of(std::size_t block) const noexcept {
    return middle_ + Vec3(kToBlocks.x[block], kToBlocks.y[block], kToBlocks.z[block]);
  }
  /// Largest distance of a relevant triangle from the centre of a block, if one is at `least`.
  double reach_of(std::size_t block, double least) const noexcept {
    return std::min(least + 2.0 * kBlockReach, farthest_[block] + kBlockReach) + kSlack;
  }

  /// All of `near_` within reach of the brick's centre, and for each block the squared reach.
  void search_from_centre(double reach_of_brick) {
    Lanes least;
    least.fill(HUGE_VAL);
    std::array<std::int64_t, kLanes> whose{};
    seen_.clear();
    for (const std::uint32_t place : near_) {
      const Vec3 delta = tree_.displacement(place, middle_);
      const Seen seen = seen_so(delta, place);
      if (seen.length > reach_of_brick)
        continue;
      seen_.push_back(seen);
      keep_nearer(kToBlocks.x.data(), kToBlocks.y.data(), kToBlocks.z.data(), delta.x(), delta.y(),
                  delta.z(), place, least.data(), whose.data());
    }
    for (std::size_t block = 0; block < kBlocks && !seen_.empty(); ++block) {
      const double reach = reach_of(
          block,
          tree_.displacement(static_cast<std::uint32_t>(whose[block]), middle_of(block)).norm());
      square_of_block_[block] = reach * reach;
    }
  }

  /// The triangles that each block must compare, block by block.
  void distribute() {
    near_.resize(seen_.size());  // now a bit for each block
    first_ = {};
    for (std::size_t n = 0; n < seen_.size(); ++n) {
      near_[n] = may_be_near(kToBlocks, seen_[n], square_of_block_, kBlocks);
      for (std::uint32_t bits = near_[n]; bits != 0; bits &= bits - 1)
        ++first_[static_cast<std::size_t>(std::countr_zero(bits)) + 1];
    }
    for (std::size_t block = 0; block < kBlocks; ++block)
      first_[block + 1] += first_[block];
    shared_.resize(first_[kBlocks]);
    std::array<std::uint32_t, kBlocks + 1> next = first_;
    for (std::size_t n = 0; n < seen_.size(); ++n)
      for (std::uint32_t bits = near_[n]; bits != 0; bits &= bits - 1)
        shared_[next[static_cast<std::size_t>(std::countr_zero(bits))]++] = seen_[n].place;
  }

  /// Fills a block from a superset of the relevant triangles.
  void fill_block(std::size_t block, std::span<const std::uint32_t> places) {
    const double* const limit = limit_.data() + kOfBlock * block;
    const std::uint16_t* const node = kNodeOf.data() + kOfBlock * block;
    if (places.empty()) {
      for (std::size_t n = 0; n < kOfBlock; ++n)
        brick_[node[n]] = static_cast<float>(limit[n]);
      return;
    }
    Lanes best;
    square_all(limit, best.data());
    lower(block, places, best);
    std::array<float, kOfBlock> out;
    signed_roots(best.data(), limit, out.data());
    for (std::size_t n = 0; n < kOfBlock; ++n)
      brick_[node[n]] = out[n];
  }

  /// The nearest first: few others can then be nearer to any node.
  void lower(std::size_t block, std::span<const std::uint32_t> places, Lanes& best) {
    const Vec3 middle = middle_of(block);
    seen_of_block_.clear();
    std::size_t nearest = 0;
    for (const std::uint32_t place : places) {
      seen_of_block_.push_back(seen_so(tree_.displacement(place, middle), place));
      if (seen_of_block_.back().length < seen_of_block_[nearest].length)
        nearest = seen_of_block_.size() - 1;
    }
    std::swap(seen_of_block_.front(), seen_of_block_[nearest]);
    const double most = reach_of(block, seen_of_block_.front().length);
    Points nodes;
    put_nodes(middle.x(), middle.y(), middle.z(), nodes.x.data(), nodes.y.data(), nodes.z.data());
    Lanes square;
    for (const Seen& seen : seen_of_block_) {
      if (seen.length > most || may_be_near(kToNodes, seen, best, kLanes) == 0)
        continue;
      tree_.squares(seen.place, nodes, square);
      keep_least(square.data(), best.data());
    }
  }

  void search_from_blocks(std::uint32_t place) {
    for (std::size_t block = 0; block < kBlocks; ++block) {
      const double nearest = tree_.nearest(middle_of(block), farthest_[block] + kBlockReach, place);
      if (tree_.within(middle_of(block), reach_of(block, nearest), kMaxNear, near_))
        fill_block(block, near_);
      else
        search_from_nodes(block, place);
    }
  }

  void search_from_nodes(std::size_t block, std::uint32_t& place) {
    for (std::size_t n = 0; n < kOfBlock; ++n) {
      const double limit = limit_[kOfBlock * block + n];
      const double distance =
          tree_.nearest(middle_of(block) + Vec3(kToNodes.x[n], kToNodes.y[n], kToNodes.z[n]),
                        std::abs(limit), place);
      brick_[kNodeOf[kOfBlock * block + n]] =
          static_cast<float>(limit < 0.0 ? -distance : distance);
    }
  }

  const DistanceTree& tree_;
  Vec3 middle_;
  const BrickLimits& limit_;
  DistanceField::Brick& brick_;
  std::array<double, kBlocks> farthest_{};  ///< limit of each block's nodes
  Lanes square_of_block_{};
  std::vector<std::uint32_t> near_, shared_;        ///< places of triangles
  std::array<std::uint32_t, kBlocks + 1> first_{};  ///< of each block in `shared_`
  std::vector<Seen> seen_, seen_of_block_;
};

}  // namespace

void signed_distances(const DistanceTree& tree, const Vec3& first, const BrickLimits& limit,
                      std::uint32_t place, DistanceField::Brick& brick) {
  BrickFill(tree, first, limit, brick).fill(place);
}

}  // namespace voxtouch::voxmap
