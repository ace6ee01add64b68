#pragma once
/// What a look-up that may not test all points is told, what it works with, and what it tells.
#include <cstdint>
#include <vector>

namespace voxtouch::contact {

class TouchedPoints;

/// How many points a look-up may test.
struct PointLimit {
  std::uint32_t most = 0xffffffff;
  const TouchedPoints* before =
      nullptr;  ///< of the frame before: contacts that must not get lost; null: none
};

/// What a look-up left out. All zero where it left out nothing.
struct LeftOut {
  std::uint32_t points = 0;  ///< of the shell, near something or not: that nothing was asked about
  /// No point that was left out is deeper by more than this than the one that stands for it, which
  /// was asked about [m].
  double depth_m = 0.0;
};

/// Memory of such look-ups, apart from all that lasts. Taken once.
struct LevelWork {
  std::vector<std::uint32_t>
      leaves;  ///< to be tested, ascending; those of levels first, then those that are kept
  std::vector<double> weights;  ///< of the points of these leaves; others hold what was
  std::vector<std::uint32_t> leaf_marks,
      cell_marks;                     ///< `now`: the leaf is kept; something is kept for the point
  std::vector<std::uint32_t> raised;  ///< leaves that are kept and among the others already
  std::uint32_t now = 0;

  bool ready() const noexcept { return !weights.empty(); }
  /// For a shell of so many points. Allocates.
  void reserve(std::size_t points) {
    const std::size_t count = points / 8 + 1;
    leaves.resize(2 * count), raised.resize(count), weights.resize(8 * count),
        leaf_marks.assign(count, 0), cell_marks.assign(points, 0);
    now = 0;
  }
};

}  // namespace voxtouch::contact
