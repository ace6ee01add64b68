#include "core/contact/equilibrium_step.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/contact/limits.hpp"
#include "core/types/clones.hpp"

namespace voxtouch::contact {
namespace {

constexpr double kRho = limits::kRowStiffness;
using OfRows = std::array<double, limits::kMaxRows>;
constexpr std::size_t kWide = 8;  ///< rows or columns that are looked at together
static_assert(limits::kMaxRows % kWide == 0);

/// 1 for each row that pushes, else 0.
struct Active {
  alignas(64) OfRows pushes;
  std::size_t count = 0;
  bool any() const noexcept { return std::find(pushes.begin(), pushes.begin() + count, 1.0) != pushes.begin() + count; }
  bool operator==(const Active& other) const noexcept { return std::equal(pushes.begin(), pushes.begin() + count, other.pushes.begin()); }
};

/// Gaps of all rows at one place, and how they change along the direction of search; beyond the rows there are some that never push.
struct Gaps {
  alignas(64) OfRows gap, slope;
  std::size_t count = 0;
};

VOXTOUCH_CLONES void find_active(const Gaps& __restrict gaps, double s, Active& __restrict active) noexcept {
  active.count = gaps.count;
  for (std::size_t n = 0; n < gaps.count; ++n) active.pushes[n] = gaps.gap[n] + s * gaps.slope[n] < 0.0 ? 1.0 : 0.0;
}

using WideRow = double[kWide];

/// The rows' jacobians as structure of arrays.
struct Jacobians {
  alignas(64) std::array<OfRows, 6> column;
  std::size_t count = 0;
};

/// What the rows that push add: the identity and rho sum J'J, and `start` less rho sum gap J; row after row. Columns beyond the sixth are zeros.
struct Sums {
  alignas(64) WideRow square[6], pull;
};
VOXTOUCH_CLONES void sum_up(const Jacobians& __restrict rows, const Active& __restrict active, const Gaps& __restrict gaps, const WideRow& __restrict start,
                            Sums& __restrict sums) noexcept {
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < kWide; ++j) sums.square[i][j] = i == j ? 1.0 : 0.0;
  for (std::size_t j = 0; j < kWide; ++j) sums.pull[j] = start[j];
  for (std::size_t n = 0; n < gaps.count; ++n) {
    if (!(active.pushes[n] > 0.0)) continue;
    alignas(64) WideRow row = {rows.column[0][n], rows.column[1][n], rows.column[2][n], rows.column[3][n], rows.column[4][n], rows.column[5][n], 0.0, 0.0};
    const double pull = kRho * gaps.gap[n];
    for (std::size_t i = 0; i < 6; ++i) {
      const double along = kRho * row[i];
      for (std::size_t j = 0; j < kWide; ++j) sums.square[i][j] += along * row[j];
    }
    for (std::size_t j = 0; j < kWide; ++j) sums.pull[j] -= pull * row[j];
  }
}

/// All rows times one step, added as in a dot product of six numbers.
VOXTOUCH_CLONES void multiply(const Jacobians& __restrict rows, const std::array<double, 6>& __restrict v, OfRows& __restrict out) noexcept {
  const auto& j = rows.column;
  for (std::size_t n = 0; n < rows.count; ++n)
    out[n] = (j[0][n] * v[0] + (j[2][n] * v[2] + j[4][n] * v[4])) + (j[1][n] * v[1] + (j[3][n] * v[3] + j[5][n] * v[5]));
}

std::array<double, 6> numbers_of(const Vec6& v) noexcept { return {v[0], v[1], v[2], v[3], v[4], v[5]}; }

/// What the rows add to slope and curvature of the energy at `s` of the direction: each eighth row is summed up on its own.
struct LineSums {
  alignas(64) WideRow slope, curvature;
};
VOXTOUCH_CLONES void sum_line(const Gaps& __restrict gaps, double s, LineSums& __restrict sums) noexcept {
  for (std::size_t j = 0; j < kWide; ++j) sums.slope[j] = sums.curvature[j] = 0.0;
  for (std::size_t begin = 0; begin < gaps.count; begin += kWide)
    for (std::size_t j = 0; j < kWide; ++j) {
      const double slope = gaps.slope[begin + j], at = gaps.gap[begin + j] + s * slope, steep = at < 0.0 ? kRho * slope : 0.0;
      sums.slope[j] += steep * at, sums.curvature[j] += steep * slope;
    }
}

double added(const WideRow& of) noexcept { return ((of[0] + of[1]) + (of[2] + of[3])) + ((of[4] + of[5]) + (of[6] + of[7])); }

/// The root of the energy's slope along the direction: `linear` + s `square` are the spring's part. The slope rises with s and is straight
/// between the places where rows begin or cease to push: Newton's method, kept between the bounds.
double line_minimum(const Gaps& gaps, double linear, double square) noexcept {
  LineSums sums;
  double low = 0.0, high = -1.0, s = 1.0;
  for (int n = 0; n < limits::kMaxLineEvaluations; ++n) {
    sum_line(gaps, s, sums);
    const double slope = (linear + s * square) + added(sums.slope), curvature = square + added(sums.curvature);
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
  Sums sums;
  Active summed;  // the rows of `sums`
  const auto sum_up_at = [&](const Active& set) noexcept {
    const Vec6 stretched = spring - step.delta;
    alignas(64) const WideRow start = {stretched[0], stretched[1], stretched[2], stretched[3], stretched[4], stretched[5], 0.0, 0.0};
    sum_up(jacobians, set, gaps, start, sums);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) step.hessian(i, j) = sums.square[i][j];
    summed = set;
  };
  gaps.slope.fill(0.0);
  std::fill(gaps.gap.begin() + static_cast<std::ptrdiff_t>(gaps.count), gaps.gap.end(), 1.0);  // up to a whole number of eights
  move_to(step.delta);
  Active active, at_end;
  find_active(gaps, 0.0, active);
  for (; step.iterations < limits::kMaxIterations && !step.converged; ++step.iterations) {
    sum_up_at(active);
    Vec6 down(sums.pull);
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
  if (!(active == summed)) sum_up_at(active);
  return step;
}

}  // namespace voxtouch::contact
