#pragma once
/// The shortest vector that satisfies linear inequalities.
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// The inequality `normal` . x >= `bound`.
struct Inequality {
  Vec6 normal = Vec6::Zero();
  double bound = 0.0;
};

struct LeastDistance {
  Vec6 x = Vec6::Zero();
  std::vector<double> multipliers;  ///< of each inequality, at least 0; x = sum of them * normals
  bool solved = false;              ///< false: the inequalities contradict each other
};

/// min |x|^2 / 2 subject to the inequalities, by non-negative least squares on the dual problem
/// (Lawson and Hanson 1974, chapter 23). Exact up to rounding for |x| near 1. Allocates.
LeastDistance least_distance(const std::vector<Inequality>& inequalities);

}  // namespace voxtouch::reference
