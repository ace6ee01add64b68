#include "core/accuracy/advice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

namespace voxtouch::accuracy {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The largest ratio of a row's errors to their limits: at most 1 if it meets all of them.
double excess(const AccuracyRow& row, const AccuracyGoal& goal) {
  double largest = 0.0;
  const auto limit = [&largest](const std::optional<double>& most, double value) {
    if (most)
      largest = std::max(largest, std::isfinite(value) ? value / *most : kInfinity);
  };
  limit(goal.direction_deg, row.direction_mean_deg);
  limit(goal.noise, row.magnitude_noise);
  limit(goal.torque_m, row.torque_error_m);
  limit(goal.onset_m, std::abs(row.onset_error_m));
  return largest;
}

/// The evaluated row with the smallest `key` (a tuple); the first of equals.
template <class Key>
std::size_t least(const std::vector<AccuracyRow>& rows, Key&& key) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (is_judged(rows[i]) && (!best || key(rows[i]) < key(rows[*best])))
      best = i;
  return *best;
}

void choose_for_error(const std::vector<AccuracyRow>& rows, const AccuracyGoal& goal,
                      AccuracyAdvice& out) {
  // Settings that meet the goal have the key 1 in common and are distinguished by their cost; the
  // others by how far they are off.
  const std::size_t row = least(rows, [&](const AccuracyRow& r) {
    return std::tuple(std::max(1.0, excess(r, goal)), r.median_us, r.bytes);
  });
  const double off = excess(rows[row], goal);
  out.met = off <= 1.0;
  if (off < kInfinity)
    out.row = row;  // else every row lacks one of the figures
}

void choose_for_time(const std::vector<AccuracyRow>& rows, double within_us, AccuracyAdvice& out) {
  out.row = least(rows, [&](const AccuracyRow& r) {
    const bool within = r.median_us <= within_us;
    return std::tuple(within ? 0.0 : r.median_us, std::max(r.direction_mean_deg, kMinDirectionDeg),
                      r.median_us, r.bytes);
  });
  out.met = rows[*out.row].median_us <= within_us;
}

/// The refused row of a virtual tool, if no other row of it was evaluated.
std::optional<std::size_t> tool_not_judged(const std::vector<AccuracyRow>& rows) {
  std::optional<std::size_t> refused;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].setting.virtual_tool)
      continue;
    if (is_judged(rows[i]))
      return std::nullopt;
    if (!rows[i].refused.empty())
      refused = i;
  }
  return refused;
}

}  // namespace

void AccuracyGoal::validate() const {
  const auto check = [](const char* name, const std::optional<double>& value) {
    if (value && !(std::isfinite(*value) && *value > 0.0))
      throw std::invalid_argument(
          fmt::format("the requested {} is {}; it must be finite and > 0", name, *value));
  };
  check("direction error [deg]", direction_deg);
  check("magnitude noise", noise);
  check("torque error [m]", torque_m);
  check("onset error [m]", onset_m);
  check("time per frame [us]", within_us);
  if (requests_error() && within_us)
    throw std::invalid_argument("both error and time are limited; limit only one");
}

bool is_judged(const AccuracyRow& row) noexcept {
  return row.refused.empty() && row.contacts > 0 && std::isfinite(row.median_us) &&
         std::isfinite(row.direction_mean_deg);
}

AccuracyAdvice advise(const std::vector<AccuracyRow>& rows, const AccuracyGoal& goal,
                      bool renders_tool) {
  std::vector<CostError> points;
  for (const AccuracyRow& row : rows)
    points.push_back(is_judged(row) ? CostError{row.median_us,
                                                std::max(row.direction_mean_deg, kMinDirectionDeg)}
                                    : CostError{kInfinity, kInfinity});
  AccuracyAdvice out;
  out.front = pareto_front(points);
  out.knee = knee(points, out.front, kMinDirectionDeg);
  if (out.front.empty()) {
    if (goal.requests_error() || goal.within_us)
      out.met = false;
  } else if (goal.requests_error()) {
    choose_for_error(rows, goal, out);
  } else if (goal.within_us) {
    choose_for_time(rows, *goal.within_us, out);
  } else {
    out.row = out.front.size() == 1 ? out.front.front() : out.knee;
  }
  if (renders_tool)
    out.refused_tool = tool_not_judged(rows);
  if (out.refused_tool)
    out.row.reset(), out.knee.reset();
  return out;
}

}  // namespace voxtouch::accuracy
