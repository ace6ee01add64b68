#include "core/contact/equilibrium_step.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "core/contact/limits.hpp"
#include "core/types/clones.hpp"

namespace voxtouch::contact {
namespace {

constexpr double kRho = limits::kRowStiffness;
using OfRows = std::array<double, limits::kMaxRows>;

/// 1 for each row that pushes, else 0.
struct Active {
  alignas(64) OfRows pushes;
  std::size_t count = 0;
  bool any() const noexcept { return std::find(pushes.begin(), pushes.begin() + count, 1.0) != pushes.begin() + count; }
  bool operator==(const Active& other) const noexcept { return std::equal(pushes.begin(), pushes.begin() + count, other.pushes.begin()); }
};

/// Gaps of all rows at one place, and how they change along the direction of search.
struct Gaps {
  alignas(64) OfRows gap, slope;
  std::size_t count = 0;
};

VOXTOUCH_CLONES void find_active(const Gaps& __restrict gaps, double s, Active& __restrict active) noexcept {
  active.count = gaps.count;
  for (std::size_t n = 0; n < gaps.count; ++n) active.pushes[n] = gaps.gap[n] + s * gaps.slope[n] < 0.0 ? 1.0 : 0.0;
}

/// The rows' jacobians as structure of arrays.
struct Jacobians {
  alignas(64) std::array<OfRows, 6> column;
  std::size_t count = 0;
};

/// All rows times one step, added as in a dot product of six numbers.
VOXTOUCH_CLONES void multiply(const Jacobians& __restrict rows, const std::array<double, 6>& __restrict v, OfRows& __restrict out) noexcept {
  const auto& j = rows.column;
  for (std::size_t n = 0; n < rows.count; ++n)
    out[n] = (j[0][n] * v[0] + (j[2][n] * v[2] + j[4][n] * v[4])) + (j[1][n] * v[1] + (j[3][n] * v[3] + j[5][n] * v[5]));
}

std::array<double, 6> numbers_of(const Vec6& v) noexcept { return {v[0], v[1], v[2], v[3], v[4], v[5]}; }

/// The root of the energy's slope along the direction: `linear` + s `square` are the spring's part. The slope rises with s and is straight
/// between the places where rows begin or cease to push: Newton's method, kept between the bounds.
double line_minimum(const Gaps& all, double linear, double square) noexcept {
  Gaps gaps;  // a row without depth that gets none on the way never pushes
  for (std::size_t k = 0; k < all.count; ++k) {
    gaps.gap[gaps.count] = all.gap[k], gaps.slope[gaps.count] = all.slope[k];
    gaps.count += static_cast<std::size_t>((all.gap[k] < 0.0) | (all.slope[k] < 0.0));
  }
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
  Jacobians jacobians;
  jacobians.count = gaps.count;
  for (std::size_t n = 0; n < gaps.count; ++n)
    for (std::size_t k = 0; k < 6; ++k) jacobians.column[k][n] = rows[n].jacobian[static_cast<Eigen::Index>(k)];
  const auto move_to = [&](const Vec6& delta) noexcept {
    step.delta = delta;
    multiply(jacobians, numbers_of(delta), gaps.gap);
    for (std::size_t n = 0; n < gaps.count; ++n) gaps.gap[n] = rows[n].gap_m + gaps.gap[n];
  };
  const auto assemble = [&](const Active& set) noexcept {
    step.hessian.setIdentity();
    for (std::size_t n = 0; n < gaps.count; ++n)
      if (set.pushes[n] > 0.0) step.hessian.noalias() += (kRho * rows[n].jacobian) * rows[n].jacobian.transpose();
  };
  gaps.slope.fill(0.0);
  move_to(step.delta);
  Active active, at_end;
  find_active(gaps, 0.0, active);
  for (; step.iterations < limits::kMaxIterations && !step.converged; ++step.iterations) {
    assemble(active);
    Vec6 down = spring - step.delta;
    for (std::size_t n = 0; n < gaps.count; ++n)
      if (active.pushes[n] > 0.0) down -= (kRho * gaps.gap[n]) * rows[n].jacobian;
    Mat6 system = step.hessian;
    if (allowed != nullptr) {
      down = allowed->free * down;
      system = allowed->free * (step.hessian - Mat6::Identity()) * allowed->free + Mat6::Identity();
    }
    const Vec6 way = system.llt().solve(down);
    multiply(jacobians, numbers_of(way), gaps.slope);
    find_active(gaps, 1.0, at_end);
    step.converged = at_end == active;
    const double share = step.converged ? 1.0 : line_minimum(gaps, way.dot(step.delta - spring), way.squaredNorm());
    move_to(step.delta + share * way);
    find_active(gaps, 0.0, active);
  }
  step.pushed = active.any();
  if (!step.pushed && step.converged && allowed == nullptr) step.delta = spring;
  assemble(active);
  return step;
}

}  // namespace voxtouch::contact
