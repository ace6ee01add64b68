#include "core/accuracy/contact_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::accuracy {
namespace {

double at_share(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  const std::size_t n = std::min(wanted, values.size() - 1);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n), values.end());
  return values[n];
}

/// Standard deviation over mean.
double noise_of(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  double mean = 0.0, variance = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (const double v : values) variance += (v - mean) * (v - mean) / static_cast<double>(values.size());
  return std::sqrt(variance) / mean;
}

}  // namespace

double angle_deg(const Vec3& a, const Vec3& b) noexcept {
  if (a.isZero(0.0) || b.isZero(0.0)) return 180.0;
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

double median_of(std::vector<double> values) { return at_share(std::move(values), 0.5); }
double p95_of(std::vector<double> values) { return at_share(std::move(values), 0.95); }

void judge_wrenches(const std::vector<WrenchPair>& pairs, AccuracyRow& row) {
  std::vector<double> directions, ratios, levers;
  row.contacts = row.missed = 0;
  for (const auto& [given, truth] : pairs) {
    const double size = given.force.norm(), wanted = truth.force.norm();
    if (!(wanted > 0.0)) continue;
    if (!(size > 0.0)) {
      ++row.missed;
      continue;
    }
    ++row.contacts;
    directions.push_back(angle_deg(given.force, truth.force));
    ratios.push_back(size / wanted);
    levers.push_back((given.torque / size - truth.torque / wanted).norm());
  }
  row.direction_median_deg = median_of(directions);
  row.direction_p95_deg = p95_of(directions);
  row.magnitude_noise = noise_of(ratios);
  row.torque_error_m = median_of(levers);
}

void judge_onsets(const std::vector<double>& gaps_m, AccuracyRow& row) {
  row.onset_error_m = median_of(gaps_m);
  row.onset_worst_m = 0.0;
  for (const double gap : gaps_m)
    if (std::abs(gap) > std::abs(row.onset_worst_m)) row.onset_worst_m = gap;
}

}  // namespace voxtouch::accuracy
