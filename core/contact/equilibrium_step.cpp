#include "core/contact/equilibrium_step.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/contact/limits.hpp"
#include "core/types/clones.hpp"

namespace voxtouch::contact {
namespace {

constexpr double kRho = limits::kRowStiffness;
using OfRows = std::array<double, limits::kMaxRows>;
constexpr std::size_t kWide = 8;  ///< rows or columns processed together
static_assert(limits::kMaxRows % (2 * kWide) == 0);

/// The active rows, ascending.
struct Active {
  std::array<std::uint8_t, limits::kMaxRows> row;
  std::size_t count = 0;
  bool operator==(const Active& other) const noexcept {
    return std::equal(row.begin(), row.begin() + count, other.row.begin(),
                      other.row.begin() + other.count);
  }
};
static_assert(limits::kMaxRows <= 256);

/// Gaps of all rows at one position, and their change along the search direction. The padding rows
/// are never active.
struct Gaps {
  alignas(64) OfRows gap, slope, at_end;  ///< the last: at the end of the whole step
  std::size_t count = 0;
};

/// Without branches, since the active rows are unpredictable.
void find_active(const OfRows& gap, std::size_t rows, Active& active) noexcept {
  std::size_t count = 0;
  for (std::size_t n = 0; n < rows; ++n) {
    active.row[count] = static_cast<std::uint8_t>(n);
    count += gap[n] < 0.0;
  }
  active.count = count;
}

using WideRow = double[kWide];

/// Jacobians of the rows: as structure of arrays for all rows at once, and row by row, padded with
/// zeros, for sums over few rows.
struct Jacobians {
  alignas(64) std::array<OfRows, 6> column;
  alignas(64) WideRow row[limits::kMaxRows];
  alignas(64) OfRows gap;  ///< at the start
};

/// Sums of the active rows: the identity plus rho sum J'J, and `start` minus rho sum gap J; row by
/// row. Columns beyond the sixth are zero.
struct Sums {
  alignas(64) WideRow square[6], pull;
};
VOXTOUCH_CLONES void sum_up(const Jacobians& __restrict rows, const Active& __restrict active,
                            const Gaps& __restrict gaps, const WideRow& __restrict start,
                            Sums& __restrict sums) noexcept {
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < kWide; ++j)
      sums.square[i][j] = i == j ? 1.0 : 0.0;
  for (std::size_t j = 0; j < kWide; ++j)
    sums.pull[j] = start[j];
  for (std::size_t k = 0; k < active.count; ++k) {
    const std::size_t n = active.row[k];
    const WideRow& row = rows.row[n];
    const double pull = kRho * gaps.gap[n];
    for (std::size_t i = 0; i < 6; ++i) {
      const double along = kRho * row[i];
      for (std::size_t j = 0; j < kWide; ++j)
        sums.square[i][j] += along * row[j];
    }
    for (std::size_t j = 0; j < kWide; ++j)
      sums.pull[j] -= pull * row[j];
  }
}

/// Product of all rows with one step, summed as in a dot product of six numbers.
VOXTOUCH_INLINE double product(const std::array<OfRows, 6>& j, std::size_t n,
                               const std::array<double, 6>& v) noexcept {
  return (j[0][n] * v[0] + (j[2][n] * v[2] + j[4][n] * v[4])) +
         (j[1][n] * v[1] + (j[3][n] * v[3] + j[5][n] * v[5]));
}
VOXTOUCH_CLONES void find_slopes(const Jacobians& __restrict rows,
                                 const std::array<double, 6>& __restrict displacement,
                                 Gaps& __restrict gaps) noexcept {
  for (std::size_t n = 0; n < gaps.count; ++n) {
    const double slope = product(rows.column, n, displacement);
    gaps.slope[n] = slope, gaps.at_end[n] = gaps.gap[n] + slope;
  }
}
VOXTOUCH_CLONES void find_gaps(const Jacobians& __restrict rows,
                               const std::array<double, 6>& __restrict delta,
                               Gaps& __restrict gaps) noexcept {
  for (std::size_t n = 0; n < gaps.count; ++n)
    gaps.gap[n] = rows.gap[n] + product(rows.column, n, delta);
}

std::array<double, 6> numbers_of(const Vec6& v) noexcept {
  return {v[0], v[1], v[2], v[3], v[4], v[5]};
}

double added(const WideRow& of) noexcept {
  return ((of[0] + of[1]) + (of[2] + of[3])) + ((of[4] + of[5]) + (of[6] + of[7]));
}

/// Contribution of the rows to slope and curvature of the energy at `s` along the direction: every
/// eighth row has its own sum.
struct LineSums {
  alignas(64) WideRow slope, curvature;
};
/// Over `kGroups` times eight rows. Unrolled, so that all eight sums stay in registers.
template <std::size_t kGroups>
VOXTOUCH_INLINE void sum_groups(const Gaps& __restrict gaps, double s,
                                LineSums& __restrict sums) noexcept {
  for (std::size_t j = 0; j < kWide; ++j) {
    double slopes = 0.0, curvatures = 0.0;
#pragma GCC unroll 16
    for (std::size_t g = 0; g < kGroups; ++g) {
      const double slope = gaps.slope[kWide * g + j], at = gaps.gap[kWide * g + j] + s * slope,
                   steep = at < 0.0 ? kRho * slope : 0.0;
      slopes += steep * at, curvatures += steep * slope;
    }
    sums.slope[j] = slopes, sums.curvature[j] = curvatures;
  }
}
VOXTOUCH_CLONES void sum_line(const Gaps& __restrict gaps, double s,
                              LineSums& __restrict sums) noexcept {
  constexpr std::size_t kGroups = limits::kMaxRows / kWide;
  if (gaps.count > limits::kMaxRows / 2)
    return sum_groups<kGroups>(gaps, s, sums);
  sum_groups<kGroups / 2>(gaps, s, sums);
}

/// Root of the energy's slope along the direction, with the spring's part `linear` + s `square`.
/// The slope increases with s and is linear between the points where rows become active or
/// inactive: Newton's method, kept within the bounds.
double line_minimum(const Gaps& gaps, double linear, double square) noexcept {
  LineSums sums;
  double low = 0.0, high = -1.0, s = 1.0;
  for (int n = 0; n < limits::kMaxLineEvaluations; ++n) {
    sum_line(gaps, s, sums);
    const double slope = (linear + s * square) + added(sums.slope),
                 curvature = square + added(sums.curvature);
    if (slope == 0.0)
      return s;
    (slope < 0.0 ? low : high) = s;
    double next = s - slope / curvature;
    if (!(next > low) || (high > 0.0 && !(next < high)))
      next = high > 0.0 ? 0.5 * (low + high) : 2.0 * s;
    if (next == s)
      return s;
    s = next;
  }
  return low > 0.0 ? low : s;
}

/// Displacement to the minimum among the allowed steps.
Vec6 allowed_displacement(const Mat6& hessian, const Vec6& down,
                          const Restriction& allowed) noexcept {
  const Mat6 system = allowed.free * (hessian - Mat6::Identity()) * allowed.free + Mat6::Identity();
  return system.llt().solve(allowed.free * down);
}

}  // namespace

EquilibriumStep equilibrium_step(std::span<const ConstraintRow> rows, const Vec6& spring,
                                 const Restriction* allowed) noexcept {
  EquilibriumStep step;
  if (allowed != nullptr)
    step.delta = allowed->from;
  Gaps gaps;
  Jacobians jacobians;
  gaps.count = std::min(rows.size(), limits::kMaxRows);
  for (std::size_t n = 0; n < gaps.count; ++n) {
    for (std::size_t k = 0; k < 6; ++k)
      jacobians.column[k][n] = jacobians.row[n][k] = rows[n].jacobian[static_cast<Eigen::Index>(k)];
    jacobians.row[n][6] = jacobians.row[n][7] = 0.0;
    jacobians.gap[n] = rows[n].gap_m;
  }
  std::fill(gaps.gap.begin() + static_cast<std::ptrdiff_t>(gaps.count), gaps.gap.end(), 1.0);
  std::fill(gaps.slope.begin() + static_cast<std::ptrdiff_t>(gaps.count), gaps.slope.end(), 0.0);
  Sums sums;
  Active active, at_end, summed;  // the last one: the rows in `sums`
  const auto move_to = [&](const Vec6& delta) noexcept {
    step.delta = delta;
    find_gaps(jacobians, numbers_of(delta), gaps);
    find_active(gaps.gap, gaps.count, active);
  };
  const auto sum_up_active = [&]() noexcept {
    const Vec6 stretched = spring - step.delta;
    alignas(64) const WideRow start = {stretched[0], stretched[1], stretched[2], stretched[3],
                                       stretched[4], stretched[5], 0.0,          0.0};
    sum_up(jacobians, active, gaps, start, sums);
    summed = active;
  };
  using Square = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>, Eigen::Aligned64,
                            Eigen::OuterStride<kWide>>;
  const Square square(sums.square[0]);
  move_to(step.delta);
  for (; step.iterations < limits::kMaxIterations && !step.converged; ++step.iterations) {
    sum_up_active();
    const Vec6 down(sums.pull);
    const Vec6 displacement = allowed == nullptr ? Vec6(Eigen::LLT<Mat6>(square).solve(down))
                                                 : allowed_displacement(square, down, *allowed);
    find_slopes(jacobians, numbers_of(displacement), gaps);
    find_active(gaps.at_end, gaps.count, at_end);
    step.converged = at_end == active;
    const double fraction =
        step.converged
            ? 1.0
            : line_minimum(gaps, displacement.dot(step.delta - spring), displacement.squaredNorm());
    move_to(step.delta + fraction * displacement);
  }
  step.pushed = active.count > 0;
  if (!step.pushed && step.converged && allowed == nullptr)
    step.delta = spring;
  if (!(active == summed))
    sum_up_active();
  step.hessian = square;
  return step;
}

}  // namespace voxtouch::contact
