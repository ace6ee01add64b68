#pragma once
/// The step that is nearest to where the hand pulls, of those that keep all rows.
#include <array>
#include <cstdint>
#include <span>

#include "core/exact/work.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::exact {

/// jacobian . delta >= least for a step delta = [shift; lever * rotation vector], all in metres.
struct Halfspace {
  Vec6 jacobian = Vec6::Zero();  ///< its first three numbers have length 1
  double least_m = 0.0;
};

/// At the solution delta = target + sum of forces times the active rows' jacobians; forces are at
/// least 0.
struct Projection {
  Vec6 delta = Vec6::Zero();
  Mat6 held = Mat6::Zero();  ///< orthogonal projector on the space of the active rows' jacobians
  std::array<std::uint32_t, 6> active{};  ///< indices of rows
  std::array<double, 6> forces_m{};
  std::size_t count = 0;  ///< of active rows
  int iterations = 0;     ///< rows that came or went
  bool feasible = true;   ///< false: no step keeps all rows; `delta` then keeps some
  bool converged = true;  ///< false: limits::kMaxIterations or the limit of work ended it
};

/// Minimises |delta - target|^2 / 2 over all rows, by the dual active-set method of Goldfarb and
/// Idnani (1983), here with the unit matrix and six unknowns, so that at most six rows are active.
/// Every iteration looks at all rows and takes the one that is violated most; ties go to the lower
/// index. Real-time safe.
Projection project(std::span<const Halfspace> rows, const Vec6& target, Work& work) noexcept;

}  // namespace voxtouch::exact
