#include "core/accuracy/contact_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace voxtouch::accuracy {
namespace {

double quantile(std::vector<double> values, double fraction) {
  if (values.empty())
    return 0.0;
  const auto requested = static_cast<std::size_t>(fraction * static_cast<double>(values.size()));
  const std::size_t n = std::min(requested, values.size() - 1);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n), values.end());
  return values[n];
}

struct Spread {
  double mean = 0.0, over_mean = 0.0;  ///< standard deviation over mean
};

Spread spread_of(const std::vector<double>& values) {
  Spread out;
  double variance = 0.0;
  for (const double v : values)
    out.mean += v / static_cast<double>(values.size());
  for (const double v : values)
    variance += (v - out.mean) * (v - out.mean) / static_cast<double>(values.size());
  if (out.mean > 0.0)
    out.over_mean = std::sqrt(variance) / out.mean;
  return out;
}

/// The largest count l for which at most 2.5 % of all rows of n fair coins have fewer than l heads.
std::size_t lower_rank(std::size_t n) {
  constexpr double kTail = 0.025, kSigmas = 1.959964;
  const auto count = static_cast<double>(n);
  if (n > 1000)
    return static_cast<std::size_t>(std::floor(0.5 * count - 0.5 * kSigmas * std::sqrt(count)));
  double fraction = std::pow(0.5, count), sum = 0.0;  // of rows with `l` heads, and with fewer
  std::size_t l = 0;
  for (; sum + fraction <= kTail; ++l) {
    sum += fraction;
    fraction *= (count - static_cast<double>(l)) / (static_cast<double>(l) + 1.0);
  }
  return l;
}

}  // namespace

double angle_deg(const Vec3& a, const Vec3& b) noexcept {
  if (a.isZero(0.0) || b.isZero(0.0))
    return 180.0;
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

double median_of(std::vector<double> values) { return quantile(std::move(values), 0.5); }
double p95_of(std::vector<double> values) { return quantile(std::move(values), 0.95); }

Interval median_interval(std::vector<double> values) {
  const std::size_t rank = lower_rank(values.size());
  if (rank == 0)
    return {};
  std::sort(values.begin(), values.end());
  return {values[rank - 1], values[values.size() - rank]};
}

void judge_forces(const std::vector<WrenchPair>& pairs, ErrorFigures& figures) {
  std::vector<double> ratios;
  double angle_sum = 0.0;
  figures.contacts = figures.missed = 0;
  for (const auto& [given, truth] : pairs) {
    const double size = given.force.norm(), requested = truth.force.norm();
    if (!(requested > 0.0))
      continue;
    ++(size > 0.0 ? figures.contacts : figures.missed);
    ratios.push_back(size / requested);
    angle_sum += angle_deg(given.force, truth.force);
  }
  const Spread size = spread_of(ratios);
  figures.direction_mean_deg =
      ratios.empty() ? 0.0 : angle_sum / static_cast<double>(ratios.size());
  figures.force_ratio = size.mean;
  figures.magnitude_noise = size.over_mean;
}

void judge_wrenches(const std::vector<WrenchPair>& pairs, AccuracyRow& row) {
  judge_forces(pairs, row);
  std::vector<double> directions, levers;
  for (const auto& [given, truth] : pairs) {
    const double size = given.force.norm(), requested = truth.force.norm();
    if (!(requested > 0.0))
      continue;
    directions.push_back(angle_deg(given.force, truth.force));
    levers.push_back(size > 0.0 ? (given.torque / size - truth.torque / requested).norm()
                                : std::numeric_limits<double>::infinity());
  }
  row.direction_median_deg = median_of(directions);
  row.direction_p95_deg = p95_of(directions);
  row.direction_median_95 = median_interval(std::move(directions));
  row.torque_error_m = median_of(levers);
  row.torque_error_95 = median_interval(std::move(levers));
}

void judge_onsets(const std::vector<double>& gaps_m, AccuracyRow& row) {
  row.onset_error_m = median_of(gaps_m);
  row.onset_error_95 = median_interval(gaps_m);
  row.onset_worst_m = 0.0;
  for (const double gap : gaps_m)
    if (std::abs(gap) > std::abs(row.onset_worst_m))
      row.onset_worst_m = gap;
}

}  // namespace voxtouch::accuracy
