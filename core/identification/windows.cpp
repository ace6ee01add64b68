#include "core/identification/windows.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::identification {
namespace {

using Entries = std::vector<RecordEntry>;

/// How far apart two samples are compared [s]: three encoder steps at the mean speed, at least 8
/// ms.
double comparison_s(const Entries& e, std::size_t begin, std::size_t end, double step) {
  const double path = std::abs(e[end - 1].position_m - e[begin].position_m);
  const double time = e[end - 1].time_s - e[begin].time_s;
  const double by_steps = path > 0.0 ? 3.0 * step * time / path : time;
  return std::max(8e-3, by_steps);
}

void cut(const Entries& e, std::size_t begin, std::size_t end, int direction,
         const WindowRules& rules, std::vector<Window>& out) {
  if (end < begin + 12)
    return;
  const double apart = comparison_s(e, begin, end, rules.encoder_step_m);
  if (apart > 0.3 * rules.longest_s)
    return;
  const double least = std::max(1e-9, 0.5 * rules.encoder_step_m);
  std::size_t first = begin, ahead = begin;
  const auto emit = [&](std::size_t until) {
    const double length = e[until - 1].time_s - e[first].time_s;
    if (length < rules.shortest_s)
      return;
    const auto pieces = static_cast<std::size_t>(std::ceil(length / rules.longest_s));
    for (std::size_t p = 0; p < pieces; ++p)
      out.push_back({first + (until - first) * p / pieces,
                     first + (until - first) * (p + 1) / pieces, direction});
  };
  for (std::size_t i = begin; i < end; ++i) {
    while (ahead < end && e[ahead].time_s < e[i].time_s + apart)
      ++ahead;
    if (ahead >= end)
      break;
    if (direction * (e[ahead].position_m - e[i].position_m) >= least)
      continue;
    emit(i + 1);
    first = ahead;
    i = ahead;
  }
  if (first + 12 < end)
    emit(end);
}

}  // namespace

std::vector<Window> stroke_windows(const AxisRecord& record, Part first, const WindowRules& rules) {
  const Entries& e = record.entries();
  std::vector<Window> out;
  for (std::size_t begin = 0; begin < e.size();) {
    std::size_t end = begin;
    while (end < e.size() && e[end].segment == e[begin].segment && e[end].part == e[begin].part)
      ++end;
    if (e[begin].part >= std::max(first, Part::kProbeStroke) && e[begin].direction != 0) {
      const auto count = static_cast<double>(end - begin);
      cut(e, begin + static_cast<std::size_t>(rules.skip_start * count),
          end - static_cast<std::size_t>(rules.skip_end * count), e[begin].direction, rules, out);
    }
    begin = end;
  }
  return out;
}

std::vector<Window> pulse_windows(const AxisRecord& record, double step) {
  // Each segment of a pulse has one direction of force. The motion lags it, so windows run from one
  // extremum of the position to the next.
  const Entries& e = record.entries();
  std::vector<Window> out;
  std::size_t begin = 0;
  while (begin < e.size() && e[begin].part != Part::kPulse)
    ++begin;
  std::size_t end = begin;
  while (end < e.size() && e[end].part == Part::kPulse)
    ++end;
  const double least = std::max(3.0 * step, 60e-6);
  std::size_t from = begin, extreme = begin;
  int direction = 0;
  const auto emit = [&](std::size_t first, std::size_t last) {
    // Without the first steps (presliding) and the last ones.
    const double path = e[last].position_m - e[first].position_m;
    while (first < last &&
           std::abs(e[first].position_m - e[last].position_m) > std::abs(path) - 0.5 * least)
      ++first;
    const double rest = e[last].position_m;
    while (last > first &&
           std::abs(e[last].position_m - rest) < std::max(step, 0.04 * std::abs(path)))
      --last;
    if (last > first + 12)
      out.push_back({first, last, path > 0.0 ? 1 : -1});
  };
  for (std::size_t i = begin; i < end; ++i) {
    const double x = e[i].position_m;
    if (direction == 0) {
      if (std::abs(x - e[from].position_m) < least)
        continue;
      direction = x > e[from].position_m ? 1 : -1;
      while (from + 1 < i &&
             std::abs(e[from + 1].position_m - e[begin].position_m) < 0.5 * step + 1e-9)
        ++from;
      extreme = i;
      continue;
    }
    if (direction * (x - e[extreme].position_m) >= 0.0) {
      if (direction * (x - e[extreme].position_m) > 0.0)
        extreme = i;
      continue;
    }
    if (direction * (e[extreme].position_m - x) < least)
      continue;
    if (std::abs(e[extreme].position_m - e[from].position_m) > 3.0 * least)
      emit(from, extreme);
    from = extreme;
    direction = -direction;
    extreme = i;
  }
  if (direction != 0 && std::abs(e[extreme].position_m - e[from].position_m) > 3.0 * least)
    emit(from, extreme);
  return out;
}

double encoder_step(const AxisRecord& record) {
  // Euclid's algorithm on the increments. Sums of steps carry rounding, so a remainder counts as
  // zero below a thousandth of the smallest increment.
  constexpr double kLeastM = 1e-10;
  double step = 0.0;
  const Entries& e = record.entries();
  for (std::size_t i = 1; i < e.size(); ++i) {
    double a = std::abs(e[i].position_m - e[i - 1].position_m);
    if (a < kLeastM)
      continue;
    double b = step;
    while (b > std::max(kLeastM, 1e-3 * std::max(a, step))) {
      const double remainder = std::abs(a - b * std::round(a / b));
      a = b;
      b = remainder;
    }
    step = a;
    if (step <= 2.0 * kLeastM)
      return 0.0;
  }
  return step;
}

}  // namespace voxtouch::identification
