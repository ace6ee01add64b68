// A shell in levels: nested, spread over all of the surface, and worth the same at each level.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "core/pointshell/shell_levels.hpp"

namespace voxtouch::pointshell {
namespace {

/// Both faces of a plate that is thinner than the cells of coarse levels, a point every `edge`,
/// areas that differ.
Pointshell plate(int side, double edge, double thick) {
  Pointshell shell;
  shell.edge = edge;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        shell.x.push_back(edge * (i + 0.25 * (j % 3))), shell.y.push_back(edge * j),
            shell.z.push_back(k * thick);
        shell.nx.push_back(0.0), shell.ny.push_back(0.0), shell.nz.push_back(k == 0 ? 1.0 : -1.0);
        shell.area_m2.push_back(edge * edge * (1.0 + 0.1 * ((i + 2 * j) % 5))),
            shell.coherence.push_back(1.0);
        shell.id.push_back(static_cast<std::uint32_t>(shell.id.size()));
      }
  return shell;
}

TEST(ShellLevels, AreNestedAndEndWithAllPoints) {
  const Pointshell before = plate(60, 0.001, 0.0005);
  Pointshell shell = before;
  const ShellLevels levels = arrange_in_levels(shell, 50);
  ASSERT_GT(levels.count(), 5U);
  EXPECT_LE(levels.ends.front(), 50U);
  EXPECT_EQ(levels.ends.back(), shell.size());
  for (std::size_t k = 0; k + 1 < levels.count(); ++k) {
    EXPECT_EQ(levels.ends[k] % ShellLevels::kRun, 0U) << k;
    EXPECT_LT(levels.ends[k], levels.ends[k + 1]);
    if (k > 0) {
      EXPECT_LE(levels.ends[k], 0.67 * levels.ends[k + 1] + 8) << "a level is worth its step";
    }
    for (std::uint32_t p = levels.ends[k]; p < levels.ends[k + 1]; ++p)
      EXPECT_LT(levels.stands_in[p], levels.ends[k]);
  }
  for (std::uint32_t p = 0; p < levels.ends.front(); ++p)
    EXPECT_EQ(levels.stands_in[p], p);
  // The same points, each with what belongs to it.
  std::set<std::uint32_t> ids(shell.id.begin(), shell.id.end());
  EXPECT_EQ(ids.size(), before.size());
  for (std::size_t p = 0; p < shell.size(); ++p) {
    EXPECT_EQ(shell.point(p), before.point(shell.id[p]));
    EXPECT_EQ(shell.normal(p), before.normal(shell.id[p]));
    EXPECT_EQ(shell.area_m2[p], before.area_m2[shell.id[p]]);
  }
}

TEST(ShellLevels, CoverTheSurfaceAsNearAsTheySay) {
  Pointshell shell = plate(60, 0.001, 0.0005);
  const ShellLevels levels = arrange_in_levels(shell, 50);
  for (std::size_t k = 0; k < levels.count(); ++k) {
    double farthest = 0.0;
    for (std::uint32_t p = 0; p < shell.size(); ++p) {
      std::uint32_t whose = p;
      while (whose >= levels.ends[k])
        whose = levels.stands_in[whose];
      farthest = std::max(farthest, (shell.point(p) - shell.point(whose)).norm());
      EXPECT_GT(shell.normal(p).dot(shell.normal(whose)), 0.0)
          << "the two faces stand for themselves";
    }
    EXPECT_EQ(farthest, levels.covering_m[k]) << k;
    // As even as a grid of as many points, within a factor.
    const double even = std::sqrt(2.0 * 3600.0 / levels.ends[k]) * 0.001;
    EXPECT_LE(levels.covering_m[k], 4.0 * even) << levels.ends[k];
  }
  EXPECT_EQ(levels.covering_m.back(), 0.0);
  EXPECT_TRUE(std::is_sorted(levels.covering_m.rbegin(), levels.covering_m.rend()));
}

TEST(ShellLevels, WeighTheSameAtEveryLevel) {
  Pointshell shell = plate(40, 0.001, 0.0005);
  const ShellLevels levels = arrange_in_levels(shell, 16);
  const double all = std::accumulate(shell.area_m2.begin(), shell.area_m2.end(), 0.0);
  const std::vector<std::vector<double>> weights = level_weights(levels, shell.area_m2);
  ASSERT_EQ(weights.size(), levels.count());
  for (std::size_t k = 0; k < weights.size(); ++k) {
    EXPECT_EQ(weights[k].size(), levels.ends[k]);
    EXPECT_NEAR(std::accumulate(weights[k].begin(), weights[k].end(), 0.0), all, 1e-12 * all);
    for (std::size_t p = 0; p < weights[k].size(); ++p)
      EXPECT_GE(weights[k][p], shell.area_m2[p]);
  }
  EXPECT_EQ(weights.back(), shell.area_m2);
}

TEST(ShellLevels, OfTheSameShellAreTheSame) {
  Pointshell one = plate(50, 0.001, 0.002), two = one;
  const ShellLevels a = arrange_in_levels(one, 100), b = arrange_in_levels(two, 100);
  EXPECT_EQ(a.ends, b.ends);
  EXPECT_EQ(a.stands_in, b.stands_in);
  EXPECT_EQ(one.id, two.id);
}

TEST(ShellLevels, AreNoneWhereAllPointsFit) {
  Pointshell shell = plate(5, 0.001, 0.002);
  const std::vector<std::uint32_t> ids = shell.id;
  EXPECT_TRUE(arrange_in_levels(shell, shell.size()).empty());
  EXPECT_EQ(shell.id, ids);
  EXPECT_THROW(arrange_in_levels(shell, 7), std::invalid_argument);
}

TEST(ShellLevels, EndForShellsOfAnyForm) {
  Pointshell same = plate(6, 0.001, 0.001);  // all points at one place: no cell can part them
  std::fill(same.x.begin(), same.x.end(), 0.0), std::fill(same.y.begin(), same.y.end(), 0.0),
      std::fill(same.z.begin(), same.z.end(), 0.0);
  const ShellLevels levels = arrange_in_levels(same, 8);
  EXPECT_EQ(levels.ends.back(), same.size());
  EXPECT_EQ(levels.ends.front(), 8U);
  EXPECT_EQ(levels.covering_m.front(), 0.0);
}

}  // namespace
}  // namespace voxtouch::pointshell
