#pragma once
/// The loops of the query over many points or spheres, with one set for each instruction set.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/contact/instructions.hpp"
#include "core/contact/query_kernel.hpp"

namespace voxtouch::contact {

/// Input of a query: the shell, the pose and the static voxels.
struct Lookup {
  const QueryData& data;
  const QueryFrame& frame;
  voxmap::Voxmap::Arrays map;
};

/// A batch of leaves, ascending, and its results.
struct Leaves {
  static constexpr std::size_t kMax = 64;
  std::size_t count = 0;
  alignas(64) std::uint32_t leaf[kMax];
  /// One bit for each point of the leaf. The first two are valid where `unsure` is not set.
  alignas(64) std::uint8_t surface[kMax], interior[kMax], unsure[kMax];
};

/// Positions and number of the bits set in a byte.
struct BitsOf {
  alignas(8) std::uint8_t places[256][SphereTree::kLeafPoints] = {};
  std::uint8_t count[256] = {};
};
inline constexpr BitsOf kBitsOf = [] {
  BitsOf out;
  for (std::size_t byte = 0; byte < 256; ++byte)
    for (std::uint8_t bit = 0; bit < SphereTree::kLeafPoints; ++bit)
      if ((byte >> bit & 1U) != 0)
        out.places[byte][out.count[byte]++] = bit;
  return out;
}();
static_assert(Hits::kSpareRoom >= SphereTree::kLeafPoints);

/// Points of the leaves, one bit each, and the leaves that contain any. A branch at each leaf
/// instead would often be mispredicted.
struct Chosen {
  const std::uint8_t* bits;  ///< one byte for each leaf
  std::size_t count = 0;
  std::uint8_t leaf[Leaves::kMax];  ///< `count` indices into `Leaves`
  Chosen(const Leaves& leaves, const std::uint8_t* of_each) noexcept : bits(of_each) {
    for (std::size_t n = 0; n < leaves.count; ++n)
      leaf[count] = static_cast<std::uint8_t>(n), count += of_each[n] != 0;
  }
};

/// Weight times normal, and weight, in frame T: point p is added to lane p mod 8, in the order of
/// the points.
struct NormalLanes {
  alignas(64) double sum[4][SphereTree::kLeafPoints] = {};
};

/// Bricks are read in halves of their words, the lower first, so that a lookup reads 32 bits for
/// each point.
using HalfWord = std::uint32_t __attribute__((may_alias));
inline constexpr std::int32_t kHalfWords = sizeof(voxmap::Voxmap::Brick) / sizeof(HalfWord);
/// Pages are read in the same way: the codes of four cells along x at a time; (y, z) of a block is
/// at y + 4 z.
using CodeWord = std::uint32_t __attribute__((may_alias));
inline constexpr std::int32_t kCodeWords = sizeof(voxmap::Voxmap::Page) / sizeof(CodeWord);
static_assert(kCodeWords == 16 && voxmap::Voxmap::kSharedCode == 64 &&
              voxmap::Voxmap::kFreeBrick == 0 && sizeof(voxmap::Voxmap::Block) == 8);
static_assert(std::endian::native == std::endian::little);

/// The loops of one instruction set. All are real-time safe.
struct LeafKernel {
  /// Bits of the sixteen spheres from `first` on that may touch a voxel. A distance decreases no
  /// faster than the displacement from the centre of its cell, where it was measured. Outside the
  /// table, the table itself is the nearest obstacle.
  std::uint32_t (*near_spheres)(const Lookup& lookup, const SphereTree::Level& level,
                                std::size_t first) noexcept;
  /// Assigns the points of the leaves to voxels. \returns the bits of `surface`, `interior` and
  /// `unsure`, combined over all leaves.
  std::array<std::uint8_t, 3> (*classify)(const Lookup& lookup, Leaves& leaves) noexcept;
  /// Appends the chosen points of the leaves to the hits. It always writes eight numbers, which is
  /// cheaper than a count.
  void (*append)(const Leaves& leaves, const Chosen& chosen, FoundHits& found) noexcept;
  /// Adds the normals of the chosen points.
  void (*add_normals)(const HitSource& source, const Leaves& leaves, const Chosen& chosen,
                      NormalLanes& lanes) noexcept;
};

const LeafKernel& leaf_kernel(Instructions instructions) noexcept;

}  // namespace voxtouch::contact
