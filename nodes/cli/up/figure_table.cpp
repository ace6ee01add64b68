#include "nodes/cli/up/figure_table.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

struct Row {
  std::string name;
  std::string value;
  std::string unit;
  std::string limit;
};

std::string value_text(double value) { return fmt::format("{:.4g}", value); }

/// ">= 0.95", "<= 0"; empty for a limit without a bound.
std::string limit_text(const CheckedLimit& one) {
  return std::isinf(one.bound)
             ? ""
             : fmt::format("{} {}", one.limit->at_least ? ">=" : "<=", value_text(one.bound));
}

class Rows {
 public:
  Rows(const RunRecord& run, const RunVerdict& verdict) : run_(run), verdict_(verdict) {}

  void add_count(const char* name, const char* node, const char* figure, const char* unit) {
    add(name, fmt::format("{:.0f}", number(run_.reports, node, figure)), unit);
  }
  void add_number(const char* name, const char* node, const char* figure, const char* unit,
                  double factor = 1.0) {
    add(name, value_text(factor * number(run_.reports, node, figure)), unit);
  }
  /// The figure of a limit; "-" if this run does not measure it.
  void add_limit(const char* name, std::string_view limit) {
    const auto found = std::ranges::find_if(
        verdict_.limits, [&](const CheckedLimit& one) { return one.limit->name == limit; });
    if (found == verdict_.limits.end())
      return;
    add(name, found->measured ? value_text(*found->measured) : "-",
        std::string(found->limit->unit == "1" || !found->measured ? "" : found->limit->unit),
        limit_text(*found));
  }
  void add(std::string name, std::string value, std::string unit, std::string limit = "") {
    rows_.push_back({std::move(name), std::move(value), std::move(unit), std::move(limit)});
  }
  const std::vector<Row>& all() const { return rows_; }

 private:
  const RunRecord& run_;
  const RunVerdict& verdict_;
  std::vector<Row> rows_;
};

/// "-" if nothing was measured.
void add_latency(Rows& rows, const RunRecord& run) {
  const bool is_measured = measures_latency(run) && number(run.reports, "device", "answered") > 0.0;
  for (const char* quantile : {"p50", "p99", "max"}) {
    const double us = number(run.reports, "device", fmt::format("latency_{}_us", quantile));
    rows.add(fmt::format("latency {}", quantile), is_measured ? fmt::format("{:.0f}", us) : "-",
             is_measured ? "us" : "");
  }
}

std::vector<Row> rows_of(const RunRecord& run, const RunVerdict& verdict) {
  Rows rows(run, verdict);
  rows.add_count("samples", "device", "samples", "");
  rows.add_number("rate", "device", "rate_hz", "Hz");
  rows.add_limit("answered ratio", "answered_ratio");
  rows.add_limit("overrun ratio", "overrun_ratio");
  rows.add_limit("deadline miss ratio", "deadline_miss_ratio");
  add_latency(rows, run);
  rows.add_limit("losses of force", "force_losses");
  rows.add_number("largest force", "device", "max_force_n", "N");
  rows.add_limit("clamped ratio", "clamped_ratio");
  rows.add_number("certified stiffness", "coupling", "design_displayed_n_per_m", "N/m");
  rows.add_number("gain margin", "coupling", "design_gain_margin", "");
  rows.add_limit("oscillation", "swing_s");
  rows.add_count("samples with force", "rendering", "contact_samples", "");
  rows.add_limit("tool passed through", "passed_through_samples");
  if (has_virtual_tool(run)) {
    rows.add_number("virtual tool residual", "rendering", "most_residual_m", "mm", 1e3);
    rows.add_count("not converged", "rendering", "not_converged_samples", "samples");
  } else {
    rows.add_limit("tunnelling suspected", "tunnelling_suspected_samples");
    rows.add_count("latched depths", "rendering", "latched_samples", "samples");
  }
  rows.add_limit("validated ratio", "validated_ratio");
  rows.add_limit("compared ratio", "compared_ratio");
  rows.add_count("validator disagrees", "validator", "disagree", "samples");
  rows.add_limit("recorded ratio", "recorded_ratio");
  return rows.all();
}

std::string line(const Row& left, const Row* right) {
  const auto cell = [](const Row& row) {
    return fmt::format("{:<21} {:>10} {:<7} {:<8}", row.name, row.value, row.unit, row.limit);
  };
  std::string text = "  " + cell(left) + (right ? " " + cell(*right) : "");
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

}  // namespace

std::string figure_table(const RunRecord& run, const RunVerdict& verdict) {
  const std::vector<Row> rows = rows_of(run, verdict);
  const std::size_t half = (rows.size() + 1) / 2;
  const Row head{"figure", "value", "unit", "limit"};
  std::string text = line(head, &head);
  for (std::size_t i = 0; i < half; ++i)
    text += line(rows[i], half + i < rows.size() ? &rows[half + i] : nullptr);
  return text;
}

}  // namespace voxtouch::cli
