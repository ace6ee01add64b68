#pragma once
/// A pointshell in levels: nested subsets of its points, each spread over the whole surface, for a
/// query that may not look at all of them.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/pointshell/pointshell.hpp"

namespace voxtouch::pointshell {

/// Level k is the points [0, ends[k]) of a shell that `arrange_in_levels` has put in order; the
/// last level is all of them. What level k has beyond the one before is in Morton order.
struct ShellLevels {
  /// Every level but the last has a multiple of this many points, so that no run of so many
  /// neighbours is of two levels.
  static constexpr std::size_t kRun = 8;

  std::vector<std::uint32_t> ends;
  /// For a point beyond the coarsest level: the point of the next coarser level that stands for it
  /// where it is left out. It lies near, and its normal points to the same side of the six; of
  /// points of the coarsest level: the point itself.
  std::vector<std::uint32_t> stands_in;
  /// Of each level [m]: no point of the shell is farther from the one that stands for it, over all
  /// steps. 0 for the last.
  std::vector<double> covering_m;

  bool empty() const noexcept { return ends.empty(); }
  std::size_t count() const noexcept { return ends.size(); }
  /// Bytes that it takes, points' weights of every level included.
  std::size_t bytes() const noexcept;
};

/// Puts the points of `shell` into the order of its levels, the coarsest of at most `coarsest`
/// points (at least kRun). Levels are made by cells: each keeps the point nearest to the middle of
/// each of its cells, one for each of the six sides that normals point to; cells grow by half of
/// their volume at a time until a level has at most two thirds of the points of the one before it.
/// Of the same shell always the same levels. Allocates. Throws std::invalid_argument where
/// `coarsest` is below kRun; none are made, and the shell stays as it is, where it has no more
/// points than that.
ShellLevels arrange_in_levels(Pointshell& shell, std::size_t coarsest);

/// What each point weighs at level k, for k from the coarsest: its own `weight` and that of all for
/// which it stands. Every level sums to the same, but for rounding.
std::vector<std::vector<double>> level_weights(const ShellLevels& levels,
                                               const std::vector<double>& weight);

}  // namespace voxtouch::pointshell
