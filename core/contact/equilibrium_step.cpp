#include "core/contact/equilibrium_step.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <bitset>

#include "core/contact/limits.hpp"

namespace voxtouch::contact {
namespace {

constexpr double kRho = limits::kRowStiffness;
using Active = std::bitset<limits::kMaxRows>;

/// Gaps of all rows at one place, and how they change along the direction of search.
struct Gaps {
  std::array<double, limits::kMaxRows> gap, slope;
  std::size_t count = 0;
  Active active(double s) const noexcept {
    Active set;
    for (std::size_t n = 0; n < count; ++n) set[n] = gap[n] + s * slope[n] < 0.0;
    return set;
  }
};

/// The root of the energy's slope along the direction: `linear` + s `square` are the spring's part. The slope rises with s and is straight
/// between the places where rows begin or cease to push: Newton's method, kept between the bounds.
double line_minimum(const Gaps& gaps, double linear, double square) noexcept {
  double low = 0.0, high = -1.0, s = 1.0;
  for (int n = 0; n < limits::kMaxLineEvaluations; ++n) {
    double slope = linear + s * square, curvature = square;
    for (std::size_t k = 0; k < gaps.count; ++k)
      if (const double at = gaps.gap[k] + s * gaps.slope[k]; at < 0.0) {
        slope += kRho * at * gaps.slope[k];
        curvature += kRho * gaps.slope[k] * gaps.slope[k];
      }
    if (slope == 0.0) return s;
    (slope < 0.0 ? low : high) = s;
    double next = s - slope / curvature;
    if (!(next > low) || (high > 0.0 && !(next < high))) next = high > 0.0 ? 0.5 * (low + high) : 2.0 * s;
    if (next == s) return s;
    s = next;
  }
  return low > 0.0 ? low : s;
}

}  // namespace

EquilibriumStep equilibrium_step(std::span<const ConstraintRow> rows, const Vec6& spring, const Restriction* allowed) noexcept {
  EquilibriumStep step;
  if (allowed != nullptr) step.delta = allowed->from;
  Gaps gaps;
  gaps.count = std::min(rows.size(), limits::kMaxRows);
  const auto move_to = [&](const Vec6& delta) noexcept {
    step.delta = delta;
    for (std::size_t n = 0; n < gaps.count; ++n) gaps.gap[n] = rows[n].gap_m + rows[n].jacobian.dot(delta);
  };
  const auto assemble = [&](const Active& set) noexcept {
    step.hessian.setIdentity();
    for (std::size_t n = 0; n < gaps.count; ++n)
      if (set[n]) step.hessian.noalias() += (kRho * rows[n].jacobian) * rows[n].jacobian.transpose();
  };
  gaps.slope.fill(0.0);
  move_to(step.delta);
  Active active = gaps.active(0.0);
  for (; step.iterations < limits::kMaxIterations && !step.converged; ++step.iterations) {
    assemble(active);
    Vec6 down = spring - step.delta;
    for (std::size_t n = 0; n < gaps.count; ++n)
      if (active[n]) down -= (kRho * gaps.gap[n]) * rows[n].jacobian;
    Mat6 system = step.hessian;
    if (allowed != nullptr) {
      down = allowed->free * down;
      system = allowed->free * (step.hessian - Mat6::Identity()) * allowed->free + Mat6::Identity();
    }
    const Vec6 way = system.llt().solve(down);
    for (std::size_t n = 0; n < gaps.count; ++n) gaps.slope[n] = rows[n].jacobian.dot(way);
    step.converged = gaps.active(1.0) == active;
    const double share = step.converged ? 1.0 : line_minimum(gaps, way.dot(step.delta - spring), way.squaredNorm());
    move_to(step.delta + share * way);
    active = gaps.active(0.0);
  }
  step.pushed = active.any();
  if (!step.pushed && step.converged && allowed == nullptr) step.delta = spring;
  assemble(active);
  return step;
}

}  // namespace voxtouch::contact
