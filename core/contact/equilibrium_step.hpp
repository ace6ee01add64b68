#pragma once
/// The step that brings the virtual tool to rest between a spring and constraint rows.
#include <span>

#include "core/contact/constraint_rows.hpp"

namespace voxtouch::contact {

/// What a step came to.
struct EquilibriumStep {
  Vec6 delta = Vec6::Zero();        ///< [shift; lever * turn] [m]
  Mat6 hessian = Mat6::Identity();  ///< I + rho sum J'J over the rows that push at `delta`
  Mat6 loose = Mat6::Identity();    ///< projector on what friction does not hold
  bool pushed = false;     ///< some row pushes; without any `delta` is bit-identical to `spring`
  bool converged = false;  ///< the set of rows that push changes no more
  int iterations = 0;
};

/// How deep the step leaves a row [m]; 0 where it does not push.
inline double depth_after(const ConstraintRow& row, const Vec6& delta) noexcept {
  const double depth = -(row.gap_m + row.jacobian.dot(delta));
  return depth > 0.0 ? depth : 0.0;
}

/// The steps that are allowed: `from` and what the orthogonal projector `free` adds to it.
struct Restriction {
  Vec6 from = Vec6::Zero();
  Mat6 free = Mat6::Identity();
};

/// Minimises |delta - spring|^2 / 2 + rho/2 sum max(0, -gap - J delta)^2 over delta, of the steps
/// that `allowed` has if it is given: convex, six numbers. Semi-smooth Newton with a line search,
/// at most kMaxIterations of kMaxLineEvaluations. Real-time safe.
EquilibriumStep equilibrium_step(std::span<const ConstraintRow> rows, const Vec6& spring,
                                 const Restriction* allowed = nullptr) noexcept;

}  // namespace voxtouch::contact
