#pragma once
/// The step that brings the virtual tool to equilibrium between a spring and constraint rows.
#include <span>

#include "core/contact/constraint_rows.hpp"

namespace voxtouch::contact {

/// Result of a step.
struct EquilibriumStep {
  Vec6 delta = Vec6::Zero();        ///< [shift; lever * turn] [m]
  Mat6 hessian = Mat6::Identity();  ///< I + rho sum J'J over the rows active at `delta`
  Mat6 loose = Mat6::Identity();    ///< projector on the directions that friction does not hold
  bool pushed = false;     ///< some row is active; otherwise `delta` is bit-identical to `spring`
  bool converged = false;  ///< the set of active rows has converged
  int iterations = 0;
};

/// Depth of a row after the step [m]; 0 if it is inactive.
inline double depth_after(const ConstraintRow& row, const Vec6& delta) noexcept {
  const double depth = -(row.gap_m + row.jacobian.dot(delta));
  return depth > 0.0 ? depth : 0.0;
}

/// The allowed steps: `from` plus the range of the orthogonal projector `free`.
struct Restriction {
  Vec6 from = Vec6::Zero();
  Mat6 free = Mat6::Identity();
};

/// Minimises over delta, among the steps of `allowed` if it is given:
///     |delta - spring|^2 / 2 + rho/2 sum max(0, -gap - J delta)^2
/// A convex problem in six variables, solved by a semi-smooth Newton method with line search. At
/// most kMaxIterations iterations of kMaxLineEvaluations evaluations. Real-time safe.
EquilibriumStep equilibrium_step(std::span<const ConstraintRow> rows, const Vec6& spring,
                                 const Restriction* allowed = nullptr) noexcept;

}  // namespace voxtouch::contact
