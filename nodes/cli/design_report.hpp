#pragma once
/// A designed coupling for a person, for a machine, and as a picture.
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/coupling/design/designer.hpp"
#include "nodes/cli/svg_chart.hpp"

namespace voxtouch::cli {

/// How the paper's literal recipe (5 Hz, damping ratio 1, no margin) would do in the same loop.
struct PaperRecipe {
  double stiffness = 0.0;          ///< that the device is asked to show: the smaller of contact and device limit
  double critical_released = 0.0;  ///< where nobody holds it; NaN where that is not among the cases
  double critical_held = 0.0;      ///< worst of the hands
};
PaperRecipe judge_paper_recipe(const DesignRequest& request);

struct DesignReport {
  DesignRequest request;
  Design design;
  PaperRecipe paper;
  std::string device, hand, contact;  ///< where the numbers come from, for a person
};

std::string to_text(const DesignReport& report);
nlohmann::ordered_json to_json(const DesignReport& report);
/// Stiffness at the hand over the filter's cut-off: where the loop is stable, what is certified, what was chosen.
Chart region_chart(const DesignReport& report);

}  // namespace voxtouch::cli
