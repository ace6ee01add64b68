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

std::string figure(double value) {
  return std::abs(value) >= 1000.0 ? fmt::format("{:.0f}", value) : fmt::format("{:.3g}", value);
}

std::string degrees(double value) {
  return value < kMinDirectionDeg ? fmt::format("under {} deg", kMinDirectionDeg)
                                  : figure(value) + " deg";
}

std::string time_and_error(const AccuracyRow& row) {
  return fmt::format("{} us, {}", figure(row.median_us), degrees(row.direction_mean_deg));
}

/// One wanted figure and what a row has of it.
struct Wanted {
  const char* name;
  double limit;
  double (*of)(const AccuracyRow&);
  std::string (*text)(double);
};

std::vector<Wanted> wanted_of(const AccuracyGoal& goal) {
  const auto millimetres = [](double v) { return figure(v * 1e3) + " mm"; };
  std::vector<Wanted> out;
  if (goal.direction_deg)
    out.push_back({"direction error", *goal.direction_deg,
                   [](const AccuracyRow& r) { return r.direction_mean_deg; },
                   [](double v) { return figure(v) + " deg"; }});
  if (goal.noise)
    out.push_back({"magnitude noise", *goal.noise,
                   [](const AccuracyRow& r) { return r.magnitude_noise; },
                   [](double v) { return figure(v * 100.0) + " %"; }});
  if (goal.torque_m)
    out.push_back({"torque error", *goal.torque_m,
                   [](const AccuracyRow& r) { return r.torque_error_m; }, millimetres});
  if (goal.onset_m)
    out.push_back({"onset error", *goal.onset_m,
                   [](const AccuracyRow& r) { return std::abs(r.onset_error_m); }, millimetres});
  return out;
}

/// The wanted figure that `row` misses by the largest factor, and that factor; at most 1 where it
/// keeps all.
struct Excess {
  double factor = 0.0;
  const Wanted* of = nullptr;
};

Excess excess(const AccuracyRow& row, const std::vector<Wanted>& wanted) {
  Excess out;
  for (const Wanted& w : wanted) {
    const double value = w.of(row), factor = std::isfinite(value) ? value / w.limit : kInfinity;
    if (!out.of || factor > out.factor)
      out = {factor, &w};
  }
  return out;
}

/// The judged row for which `key` (a tuple, less is better) is least; the first of equals.
template <class Key>
std::optional<std::size_t> least(const std::vector<AccuracyRow>& rows, Key&& key) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (is_judged(rows[i]) && (!best || key(rows[i]) < key(rows[*best])))
      best = i;
  return best;
}

std::string limits_text(const std::vector<Wanted>& wanted) {
  std::string text;
  for (const Wanted& w : wanted)
    text += fmt::format("{}{} of at most {}", text.empty() ? "" : " and ", w.name, w.text(w.limit));
  return text;
}

std::string values_text(const AccuracyRow& row, const std::vector<Wanted>& wanted) {
  std::string text;
  for (const Wanted& w : wanted)
    text += fmt::format(", {} {}", w.name, w.text(w.of(row)));
  return text;
}

void advise_for_error(const std::vector<AccuracyRow>& rows, const AccuracyGoal& goal,
                      AccuracyAdvice& out) {
  const std::vector<Wanted> wanted = wanted_of(goal);
  // Settings that keep the goal share the key 1 and are told apart by their cost; the others by how
  // far they are off.
  out.row = least(rows, [&](const AccuracyRow& r) {
    return std::tuple(std::max(1.0, excess(r, wanted).factor), r.median_us, r.bytes);
  });
  const AccuracyRow& row = rows[*out.row];
  const Excess miss = excess(row, wanted);
  out.met = miss.factor <= 1.0;
  if (*out.met) {
    out.sentence =
        fmt::format("The cheapest setting with a {} is {}: {} us per frame{}.", limits_text(wanted),
                    describe(row.setting), figure(row.median_us), values_text(row, wanted));
    return;
  }
  if (miss.factor == kInfinity) {  // every row lacks one of the figures
    out.row.reset();
    out.sentence = fmt::format("No setting has a {}: the {} could not be measured.",
                               limits_text(wanted), miss.of->name);
    return;
  }
  out.sentence = fmt::format(
      "No setting has a {}; nearest comes {} ({} us per frame{}), whose {} is {} times what is "
      "wanted, {} too much.",
      limits_text(wanted), describe(row.setting), figure(row.median_us), values_text(row, wanted),
      miss.of->name, figure(miss.factor), miss.of->text(miss.of->of(row) - miss.of->limit));
}

void advise_for_time(const std::vector<AccuracyRow>& rows, double within_us, AccuracyAdvice& out) {
  out.row = least(rows, [&](const AccuracyRow& r) {
    const bool within = r.median_us <= within_us;
    return std::tuple(within ? 0.0 : r.median_us, std::max(r.direction_mean_deg, kMinDirectionDeg),
                      r.median_us, r.bytes);
  });
  const AccuracyRow& row = rows[*out.row];
  out.met = row.median_us <= within_us;
  const double over = row.median_us - within_us;
  out.sentence = *out.met
                     ? fmt::format("The most accurate setting within {} us per frame is {}: {}.",
                                   figure(within_us), describe(row.setting), time_and_error(row))
                     : fmt::format(
                           "No setting stays within {} us per frame; nearest comes {} ({}), {} us "
                           "or {} % over.",
                           figure(within_us), describe(row.setting), time_and_error(row),
                           figure(over), figure(100.0 * over / within_us));
}

void name_choices(const std::vector<AccuracyRow>& rows, AccuracyAdvice& out) {
  const auto named = [&](std::size_t i) {
    return fmt::format("{} ({})", describe(rows[i].setting), time_and_error(rows[i]));
  };
  const std::size_t fast = out.front.front(), exact = out.front.back();
  if (out.front.size() == 1) {
    out.row = fast;
    const auto judged = std::count_if(rows.begin(), rows.end(), is_judged);
    out.sentence =
        judged == 1
            ? fmt::format("Only {} could be measured: nothing to compare it with.", named(fast))
            : fmt::format("{} is both the fastest and the most accurate of {}.", named(fast),
                          judged);
    return;
  }
  out.sentence = fmt::format(
      "Worth choosing from are {} settings, from {}, the fastest, to {}, the most accurate",
      out.front.size(), named(fast), named(exact));
  if (out.knee) {
    out.row = out.knee;
    const AccuracyRow &from = rows[*out.knee], &to = rows[exact];
    out.sentence += fmt::format(
        "; the knee is {}: from there to the most accurate the error falls {} times, for {} times "
        "the time",
        named(*out.knee),
        figure(from.direction_mean_deg / std::max(to.direction_mean_deg, kMinDirectionDeg)),
        figure(to.median_us / from.median_us));
  }
  out.sentence += ".";
}

/// The refused row of a virtual tool, where no other one of it was judged.
const AccuracyRow* tool_not_judged(const std::vector<AccuracyRow>& rows) {
  const AccuracyRow* refused = nullptr;
  for (const AccuracyRow& row : rows) {
    if (!row.setting.virtual_tool)
      continue;
    if (is_judged(row))
      return nullptr;
    if (!row.refused.empty())
      refused = &row;
  }
  return refused;
}

}  // namespace

void AccuracyGoal::validate() const {
  const auto check = [](const char* name, const std::optional<double>& value) {
    if (value && !(std::isfinite(*value) && *value > 0.0))
      throw std::invalid_argument(
          fmt::format("the wanted {} is {}; it must be finite and greater than 0", name, *value));
  };
  check("direction error [deg]", direction_deg);
  check("magnitude noise", noise);
  check("torque error [m]", torque_m);
  check("onset error [m]", onset_m);
  check("time per frame [us]", within_us);
  if (wants_error() && within_us)
    throw std::invalid_argument(
        "an error and a time are both wanted; ask for one: the cheapest setting for a wanted "
        "error, or the most "
        "accurate within a wanted time");
}

bool is_judged(const AccuracyRow& row) noexcept {
  return row.refused.empty() && row.contacts > 0 && std::isfinite(row.median_us) &&
         std::isfinite(row.direction_mean_deg);
}

std::string_view weights_word(contact::PointWeights weights) noexcept {
  return weights == contact::PointWeights::kArea ? "area" : "one";
}

std::string describe(const AccuracySetting& s) {
  std::string text = s.virtual_tool ? fmt::format("virtual tool, e = {:.4g} mm", s.voxel_m * 1e3)
                                    : fmt::format("{}/{}, e = {:.4g} mm", contact::name_of(s.model),
                                                  weights_word(s.weights), s.voxel_m * 1e3);
  if (s.budget < 1.0)
    text += fmt::format(", {:.3g} % of the points", 100.0 * s.budget);
  if (s.shell_voxel_m != s.voxel_m)
    text += fmt::format(", shell {:.4g} mm", s.shell_voxel_m * 1e3);
  return text;
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
    if (goal.wants_error() || goal.within_us)
      out.met = false;
    out.sentence = fmt::format(
        "None of the {} settings could be judged: each was refused or never met the wall.",
        rows.size());
  } else if (goal.wants_error()) {
    advise_for_error(rows, goal, out);
  } else if (goal.within_us) {
    advise_for_time(rows, *goal.within_us, out);
  } else {
    name_choices(rows, out);
  }
  if (const AccuracyRow* tool = renders_tool ? tool_not_judged(rows) : nullptr) {
    out.row.reset(), out.knee.reset();
    out.sentence = fmt::format(
        "What the scene renders, a virtual tool, was not judged: {}. So no other setting is "
        "advised in its place; the rows above tell what those give.",
        tool->refused);
  }
  return out;
}

}  // namespace voxtouch::accuracy
