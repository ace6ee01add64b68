#pragma once
/// Results of an accuracy comparison: as text, as JSON (which voxtouch_plot draws), and as CSV.
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/accuracy/advice.hpp"
#include "nodes/cli/machine.hpp"

namespace voxtouch::cli {

struct AccuracyReport {
  std::string scene, scene_hash;
  double scene_voxel_m = 0.0;
  std::uint64_t seed = 0;
  std::uint32_t contacts = 0;  ///< requested
  double depth_edges = 0.0;
  accuracy::AccuracyGoal goal;
  std::vector<accuracy::AccuracyRow> rows;
  accuracy::AccuracyAdvice advice;  ///< of these rows and this goal
  Machine machine;
  double load_before = -1.0, load_after = -1.0;  ///< load average of a minute; negative: not known
};

/// A table grouped by model, the chosen setting in one line, spreads, the conditions.
std::string to_text(const AccuracyReport& report);
/// Figures that are not finite, or of a row that was refused or never in contact, are null.
nlohmann::ordered_json to_json(const AccuracyReport& report);
/// RFC 4180 with a header; SI units but for degrees and microseconds; the same cells empty that are
/// null in the JSON.
std::string to_csv(const AccuracyReport& report);

}  // namespace voxtouch::cli
