#pragma once
/// A plan as text and as JSON: parts as a table, measured next to expected.
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/rendering/plan.hpp"
#include "nodes/cli/machine.hpp"
#include "nodes/cli/plan/plan_measure.hpp"

namespace voxtouch::cli {

/// How the scene and a device go together. Sentences.
struct DeviceVerdict {
  std::string device;
  std::vector<std::string> errors;  ///< it must not run so
  std::vector<std::string> notes;   ///< forces that are not displayed, or reduced
};

struct PlanReport {
  rendering::Plan plan;            ///< its parts with those of the ring behind them
  std::optional<PlanTimes> times;  ///< none: nothing was measured
  std::optional<DeviceVerdict> device;
  std::string no_coupling_time_reason;  ///< empty: it was measured, or nothing was
  Machine machine;
  double load = -1.0;
};

/// As text, and as JSON.
std::string to_text(const PlanReport& report);
nlohmann::ordered_json to_json(const PlanReport& report);

}  // namespace voxtouch::cli
