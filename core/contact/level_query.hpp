#pragma once
/// The look-up of a shell in levels that may test only so many of its points.
#include <span>
#include <vector>

#include "core/contact/level_work.hpp"
#include "core/contact/query_kernel.hpp"
#include "core/contact/touched_points.hpp"
#include "core/pointshell/shell_levels.hpp"

namespace voxtouch::contact {

/// What a look-up is to test, and what that leaves out.
struct LevelChoice {
  std::span<const std::uint32_t> leaves;  ///< of LevelWork
  const double* weights =
      nullptr;  ///< of the points of these leaves; null: each weighs what it weighs without levels
  LeftOut left_out;
  std::uint32_t asked_end = 0;  ///< all points below this number that are near something are tested
};

/// Levels of a shell with a tree for what each has beyond the one before.
///
/// Levels come in a fixed order, from the coarsest, as long as the points that culling leaves of
/// them fit the limit; the coarsest is always asked. With n_k points of level k and all before it,
/// and L three quarters of the limit, the level's share is that of the level before it times (L /
/// n_k - 1) / 0.25, cut to 0..1: it fades out as its points come from four fifths of L to L. A
/// point weighs what it weighs in the levels that are asked, by their shares (level k counts
/// share_k - share_(k+1)), so that no force steps where a level comes or goes by more than what one
/// leaf of points makes up of the share, and all points together weigh what the whole shell weighs.
///
/// What touched in the frame before and would be lost stays in: of every point that stands for one
/// that touched, and did not touch itself, a leaf of these that touched; the leaf's points weigh
/// what they have of their own level, and whoever stands for them as much less. The last quarter of
/// the limit is for them; where they need more, a level less is asked. With a coarsest level of at
/// most a ninth of the limit there is always room for one leaf each. Further leaves are kept as far
/// as there is room.
class LevelQuery {
 public:
  LevelQuery() = default;
  /// `weight`: of each point without levels; empty: one. Allocates.
  LevelQuery(const pointshell::Pointshell& shell, pointshell::ShellLevels levels,
             const std::vector<double>& weight);

  bool empty() const noexcept { return levels_.empty(); }
  const pointshell::ShellLevels& levels() const noexcept { return levels_; }
  /// Heaviest that each point of the coarsest level, and with it any point, may weigh.
  const std::vector<double>& coarsest_weights() const noexcept { return weights_.front(); }

  /// Which leaves a look-up tests. `data.tree` is not looked at. Real-time safe where `work` was
  /// reserved. The same on every processor.
  LevelChoice choose(const QueryData& data, const QueryFrame& frame, const PointLimit& limit,
                     LevelWork& work) const noexcept;

 private:
  /// The levels that are asked: up to `solid` wholly, and from there to `last` with a share.
  struct Asked {
    static constexpr std::size_t kMax = 64;
    std::size_t solid = 0, last = 0;
    double share[kMax + 1] = {};  ///< of each level; 0 beyond the last
    std::size_t leaves[kMax] = {},
                work[kMax] = {};  ///< of each level and all before it: leaves near something, and
                                  ///< what they cost in points

    /// What the level counts.
    double part(std::size_t level) const noexcept { return share[level] - share[level + 1]; }
    void drop_last() noexcept;
  };
  Asked walk(const QueryData& data, const QueryFrame& frame, double limit,
             LevelWork& work) const noexcept;
  bool keep(const TouchedPoints& before, const Asked& asked, std::size_t room, LevelWork& work,
            std::size_t& kept, std::size_t& raised) const noexcept;
  void weigh(const Asked& asked, std::size_t kept, std::size_t raised,
             LevelWork& work) const noexcept;
  double mixed_weight(const Asked& asked, std::size_t level, std::size_t point) const noexcept;
  void take_from_ancestors(const Asked& asked, std::uint32_t point, double share, double weight,
                           LevelWork& work) const noexcept;
  std::size_t level_of(std::uint32_t point) const noexcept;

  pointshell::ShellLevels levels_;
  std::vector<SphereTree> trees_;
  std::vector<std::vector<double>> weights_;  ///< of each level
};

}  // namespace voxtouch::contact
