/// The Pareto front and its knee: ties, ignored points, one point, none.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/accuracy/pareto.hpp"

namespace voxtouch::accuracy {
namespace {

using Indices = std::vector<std::size_t>;
const double kNan = std::numeric_limits<double>::quiet_NaN(),
             kInf = std::numeric_limits<double>::infinity();

TEST(ParetoFront, HoldsUndominatedPointsByCost) {
  EXPECT_EQ(pareto_front({{4, 1}, {1, 4}, {3, 3}, {2, 3}, {5, 2}}), (Indices{1, 3, 0}));
}

TEST(ParetoFront, OfNoneIsEmptyAndOfOneIsThatPoint) {
  EXPECT_EQ(pareto_front({}), Indices{});
  EXPECT_EQ(pareto_front({{3, 7}}), Indices{0});
}

TEST(ParetoFront, KeepsEqualsAndDropsWeaklyDominated) {
  EXPECT_EQ(pareto_front({{1, 2}, {1, 2}}), (Indices{0, 1}));
  EXPECT_EQ(pareto_front({{1, 2}, {1, 3}, {2, 2}}), Indices{0});
  EXPECT_EQ(pareto_front({{1, 3}, {2, 2}, {1, 3}, {2, 2}}), (Indices{0, 2, 1, 3}));
}

TEST(ParetoFront, LeavesOutNonFinitePoints) {
  EXPECT_EQ(pareto_front({{kNan, 0}, {0, kNan}, {-kInf, 0}, {0, -kInf}, {kInf, 1}, {2, 2}}),
            Indices{5});
  EXPECT_EQ(pareto_front({{kNan, kNan}}), Indices{});
}

TEST(ParetoFront, EqualsBruteForce) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    std::mt19937 random(seed);
    std::vector<CostError> points(1 + seed % 17);
    for (CostError& p : points)
      p = {double(random() % 6), double(random() % 6)};  // coarse: many ties
    const Indices front = pareto_front(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      bool beaten = false;
      for (const CostError& p : points)
        beaten |= p.cost <= points[i].cost && p.error <= points[i].error &&
                  (p.cost < points[i].cost || p.error < points[i].error);
      EXPECT_EQ(std::count(front.begin(), front.end(), i), beaten ? 0 : 1)
          << "seed " << seed << ", point " << i;
    }
  }
}

TEST(Knee, IsAtTheLargestBendOfTheFront) {
  const std::vector<CostError> points{{1, 100}, {2, 1}, {50, 0.5}, {10, 0.9}};
  EXPECT_EQ(knee(points, pareto_front(points), 1e-3), 1u);
}

TEST(Knee, IsAbsentOnStraightBulgingOrShortFronts) {
  const auto of = [](const std::vector<CostError>& points) {
    return knee(points, pareto_front(points), 1e-3);
  };
  EXPECT_FALSE(of({}));
  EXPECT_FALSE(of({{1, 10}}));
  EXPECT_FALSE(of({{1, 10}, {10, 1}}));
  EXPECT_FALSE(of({{1, 100}, {10, 10}, {100, 1}}));
  EXPECT_FALSE(of({{1, 100}, {50, 90}, {100, 1}}));
}

TEST(Knee, TakesErrorsAndCostsOfZero) {
  const std::vector<CostError> exact{{1, 100}, {2, 0.01}, {100, 0}};
  EXPECT_EQ(knee(exact, pareto_front(exact), 1e-3), 1u);
  const std::vector<CostError> untimed{{0, 3}, {1, 2}, {2, 1}};
  EXPECT_FALSE(knee(untimed, pareto_front(untimed), 1e-3));
}

}  // namespace
}  // namespace voxtouch::accuracy
