#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "nodes/cli/accuracy_report.hpp"

namespace voxtouch::cli {
namespace {

constexpr double kLeastNoisePercent = 1e-2;  ///< lowest that the lower panel shows; no hand feels a tenth of it
constexpr const char* kFrontColour = "#222";

using Value = std::function<double(const AccuracyRow&)>;

double direction(const AccuracyRow& row) { return std::max(row.direction_median_deg, kLeastDirectionDeg); }
double noise(const AccuracyRow& row) { return std::max(row.magnitude_noise * 100.0, kLeastNoisePercent); }
double time(const AccuracyRow& row) { return row.median_us; }

/// Colours that stay apart for colour-blind eyes too (Okabe and Ito), and a mark each, for print.
void style(Series& s, ContactModelKind model) {
  switch (model) {
    case ContactModelKind::kOriginal: s.colour = "#6b6b6b", s.mark = Mark::kSquare; return;
    case ContactModelKind::kAdapted: s.colour = "#0072b2", s.mark = Mark::kCircle; return;
    case ContactModelKind::kClustered: s.colour = "#c44e00", s.mark = Mark::kTriangle; return;
    case ContactModelKind::kField: s.colour = "#00805f", s.mark = Mark::kDiamond; return;
  }
}

bool same_series(const AccuracySetting& a, const AccuracySetting& b) {
  return a.model == b.model && a.weights == b.weights;
}

double density(const AccuracySetting& s) { return s.voxel_m / s.shell_voxel_m; }

std::string size_label(const AccuracySetting& s) {
  return s.shell_voxel_m == s.voxel_m ? fmt::format("{:.4g}", s.voxel_m * 1e3)
                                      : fmt::format("{:.4g}/{:.4g}", s.voxel_m * 1e3, s.shell_voxel_m * 1e3);
}

/// One series per model and weights in the legend; a line joins only settings whose shells are alike.
std::vector<Series> series_of(const AccuracyReport& report, const Value& value, bool labelled) {
  std::vector<Series> out;
  std::vector<AccuracySetting> firsts;
  for (const AccuracyRow& row : report.rows) {
    const AccuracySetting& s = row.setting;
    if (!is_judged(row)) continue;
    std::size_t at = 0;
    while (at < firsts.size() && !(same_series(firsts[at], s) && std::abs(density(firsts[at]) - density(s)) < 1e-9))
      ++at;
    if (at == firsts.size()) {
      const bool known = std::any_of(firsts.begin(), firsts.end(), [&](const auto& f) { return same_series(f, s); });
      firsts.push_back(s);
      Series& fresh = out.emplace_back();
      style(fresh, s.model);
      fresh.hollow = s.weights == PointWeights::kOne;
      fresh.joined = true;
      if (!known)
        fresh.label = fmt::format("{}, {}", name_of(s.model),
                                  fresh.hollow ? "every point weighs one" : "points weigh their area");
    }
    out[at].x.push_back(time(row));
    out[at].y.push_back(value(row));
    if (labelled) out[at].labels.push_back(size_label(s));
  }
  return out;
}

/// A logarithmic axis round what is shown, a decade wide at least.
Axis axis_round(std::string label, const AccuracyReport& report, const Value& value, std::optional<double> wished) {
  double low = 0.0, high = 0.0;
  const auto take = [&](double v) {
    if (!(std::isfinite(v) && v > 0.0)) return;
    low = low > 0.0 ? std::min(low, v) : v;
    high = std::max(high, v);
  };
  for (const AccuracyRow& row : report.rows)
    if (is_judged(row)) take(value(row));
  if (wished) take(*wished);
  if (!(low > 0.0)) low = high = 1.0;
  const double spread = std::max(1.35, std::sqrt(10.0 * low / high));
  return {std::move(label), low / spread, high * spread, true};
}

Curve line(std::string label, std::vector<double> x, std::vector<double> y, const char* colour) {
  Curve out;
  out.label = std::move(label), out.x = std::move(x), out.y = std::move(y), out.colour = colour;
  out.width = 1.5, out.dashed = true;
  return out;
}

/// From the top down to the fastest, then along what can be had for each time, to the right edge.
Curve front_line(const AccuracyReport& report, const Chart& chart) {
  Curve out = line("Pareto front: the least error within each time", {}, {}, kFrontColour);
  out.dashed = false, out.steps = true;
  out.x.push_back(time(report.rows[report.advice.front.front()]));
  out.y.push_back(chart.y.high);
  for (const std::size_t i : report.advice.front) {
    out.x.push_back(time(report.rows[i]));
    out.y.push_back(direction(report.rows[i]));
  }
  out.x.push_back(chart.x.high);
  out.y.push_back(out.y.back());
  return out;
}

Series ring_round(const AccuracyReport& report) {
  const AccuracyRow& row = report.rows[*report.advice.row];
  const bool wished = report.advice.met.has_value();
  const char* word = wished ? (*report.advice.met ? "advised" : "nearest") : report.advice.knee ? "knee" : "best";
  Series out;
  out.label = fmt::format("{}: {}/{}, {} mm", word, name_of(row.setting.model), weights_word(row.setting.weights),
                          size_label(row.setting));
  out.x = {time(row)}, out.y = {direction(row)};
  out.colour = "#b3261e", out.mark = Mark::kRing;
  return out;
}

bool any_below(const AccuracyReport& report, const Value& value, double least) {
  return std::any_of(report.rows.begin(), report.rows.end(),
                     [&](const AccuracyRow& row) { return is_judged(row) && value(row) <= least; });
}

Chart direction_panel(const AccuracyReport& report, const Axis& across) {
  Chart out;
  out.x = across;
  std::string label = "direction error of the force, median [deg]";
  if (any_below(report, direction, kLeastDirectionDeg)) label += fmt::format("; {} or less", kLeastDirectionDeg);
  out.y = axis_round(label, report, direction, report.wish.direction_deg);
  out.height = 430;
  out.series = series_of(report, direction, true);
  if (report.advice.row) out.series.push_back(ring_round(report));
  if (!report.advice.front.empty()) out.curves.push_back(front_line(report, out));
  if (report.wish.direction_deg)
    out.curves.push_back(line(fmt::format("wanted: {:.4g} deg", *report.wish.direction_deg), {out.x.low, out.x.high},
                              {*report.wish.direction_deg, *report.wish.direction_deg}, "#b3261e"));
  if (report.wish.within_us)
    out.curves.push_back(line(fmt::format("wanted: within {:.4g} us", *report.wish.within_us),
                              {*report.wish.within_us, *report.wish.within_us}, {out.y.low, out.y.high}, "#b3261e"));
  return out;
}

Chart noise_panel(const AccuracyReport& report, const Axis& across) {
  Chart out;
  out.title = "Magnitude noise of the same settings: scatter of |F| / |F reference|";
  out.x = across;
  const std::optional<double> wished =
      report.wish.noise ? std::optional(*report.wish.noise * 100.0) : std::optional<double>();
  const char* least = any_below(report, noise, kLeastNoisePercent) ? "; 0.01 or less" : "";
  out.y = axis_round(fmt::format("noise, std / mean [%]{}", least), report, noise, wished);
  out.height = 190;
  out.series = series_of(report, noise, false);  // each stands below its mark of the upper panel
  if (wished) out.curves.push_back(line("", {out.x.low, out.x.high}, {*wished, *wished}, "#b3261e"));
  return out;
}

/// At most `most` bytes, so that a line of the title stays on the page.
std::string cut(const std::string& text, std::size_t most) {
  return text.size() <= most ? text : text.substr(0, most - 3) + "...";
}

/// "Intel(R) Xeon(R) Gold 6230 CPU @ 2.10GHz" as "Intel Xeon Gold 6230".
std::string short_name(std::string processor) {
  for (const std::string noise_word : {"(R)", "(TM)"})
    for (std::size_t at; (at = processor.find(noise_word)) != std::string::npos;)
      processor.erase(at, noise_word.size());
  return cut(processor.substr(0, processor.find(" CPU @")), 34);
}

std::string conditions(const AccuracyReport& report) {
  const auto other = [](const AccuracyRow& row) { return row.setting.voxel_m != row.setting.shell_voxel_m; };
  const bool shells = std::any_of(report.rows.begin(), report.rows.end(), other);
  std::string text = fmt::format("At the marks: voxel edge e{} [mm]. CPU time on {}", shells ? " / the shell's" : "",
                                 short_name(report.machine.processor));
  if (report.load_after >= 0.0) text += fmt::format(", load {:.1f}", report.load_after);
  return text;
}

}  // namespace

Figure accuracy_figure(const AccuracyReport& report) {
  const auto missing =
      std::count_if(report.rows.begin(), report.rows.end(), [](const auto& r) { return !is_judged(r); });
  Figure out;
  out.title = "What accuracy costs: direction error against time per frame";
  out.subtitles = {fmt::format("Scene {}: {} contacts, {:.4g} e deep; lower left is better{}", cut(report.scene, 30),
                               report.contacts, report.depth_edges,
                               missing > 0 ? fmt::format("; not measured: {}", missing) : std::string()),
                   conditions(report)};
  const Axis across = axis_round("CPU time of one frame, median [us]", report, time, report.wish.within_us);
  out.panels = {direction_panel(report, across), noise_panel(report, across)};
  return out;
}

}  // namespace voxtouch::cli
