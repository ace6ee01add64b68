#pragma once
/// The loops of the query that run over many points or spheres at once, one set of them for each
/// kind of processor.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/contact/instructions.hpp"
#include "core/contact/query_kernel.hpp"

namespace voxtouch::contact {

/// What is looked up: the shell, the pose, the ground.
struct Lookup {
  const QueryData& data;
  const QueryFrame& frame;
  voxmap::Voxmap::Arrays map;
};

/// Leaves that are looked at together, ascending, and what was found in them.
struct Leaves {
  static constexpr std::size_t kMax = 64;
  std::size_t count = 0;
  alignas(64) std::uint32_t leaf[kMax];
  /// One bit for each point of the leaf. The first two are good where `unsure` is not set.
  alignas(64) std::uint8_t surface[kMax], interior[kMax], unsure[kMax];
};

/// Places of the bits that are set in a byte, and how many they are.
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

/// Points of the leaves, one bit each, and which leaves have any: a branch at each leaf instead
/// would often be guessed wrong.
struct Chosen {
  const std::uint8_t* bits;  ///< of each of the leaves
  std::size_t count = 0;
  std::uint8_t leaf[Leaves::kMax];  ///< `count` of them, by their places in `Leaves`
  Chosen(const Leaves& leaves, const std::uint8_t* of_each) noexcept : bits(of_each) {
    for (std::size_t n = 0; n < leaves.count; ++n)
      leaf[count] = static_cast<std::uint8_t>(n), count += of_each[n] != 0;
  }
};

/// Weight times normal and weight, frame T: point p is added to lane p mod 8, in the points' order.
struct NormalLanes {
  alignas(64) double sum[4][SphereTree::kLeafPoints] = {};
};

/// Bricks are read in halves of their words, the lower first, so that a look is one of 32 bits for
/// each point.
using HalfWord = std::uint32_t __attribute__((may_alias));
inline constexpr std::int32_t kHalfWords = sizeof(voxmap::Voxmap::Brick) / sizeof(HalfWord);
/// A page likewise: the codes of four cells along x at a time; (y, z) of a block at y + 4 z.
using CodeWord = std::uint32_t __attribute__((may_alias));
inline constexpr std::int32_t kCodeWords = sizeof(voxmap::Voxmap::Page) / sizeof(CodeWord);
static_assert(kCodeWords == 16 && voxmap::Voxmap::kSharedCode == 64 &&
              voxmap::Voxmap::kFreeBrick == 0 && sizeof(voxmap::Voxmap::Block) == 8);
static_assert(std::endian::native == std::endian::little);

/// All are real-time safe.
struct LeafKernel {
  /// Which of the sixteen spheres from `first` on may touch something, as bits. No distance falls
  /// faster than the distance from where it was measured, the middle of a cell of free distances;
  /// outside the table there is nothing nearer than the table.
  std::uint32_t (*near_spheres)(const Lookup& lookup, const SphereTree::Level& level,
                                std::size_t first) noexcept;
  /// Puts the points of the leaves into voxels. \returns the bits of `surface`, `interior` and
  /// `unsure` of all leaves together.
  std::array<std::uint8_t, 3> (*classify)(const Lookup& lookup, Leaves& leaves) noexcept;
  /// Adds the chosen points of the leaves to the hits found. Eight places are written each time,
  /// which costs less than to ask how many.
  void (*append)(const Leaves& leaves, const Chosen& chosen, FoundHits& found) noexcept;
  /// Adds the chosen points of the leaves.
  void (*add_normals)(const HitSource& source, const Leaves& leaves, const Chosen& chosen,
                      NormalLanes& lanes) noexcept;
};

const LeafKernel& leaf_kernel(Instructions instructions) noexcept;

}  // namespace voxtouch::contact
