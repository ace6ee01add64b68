#include "core/first_scene/model_choice.hpp"

#include <fmt/format.h>

#include "core/accuracy/advice.hpp"

namespace voxtouch::first_scene {
namespace {

using accuracy::AccuracyRow;
using contact::ContactModelKind;

constexpr double kMaxOffDeg = 10.0, kMaxUs = 200.0;
constexpr std::size_t kMaxTriangles = 500'000;  ///< half a minute

std::string name_of(const accuracy::AccuracySetting& setting) {
  return setting.virtual_tool ? "the virtual tool"
                              : fmt::format("`{}`", contact::name_of(setting.model));
}

/// Of a virtual tool, by its own row, or by that of `field`: how a penalty force points at a tool's
/// corner says nothing of a tool that is held outside.
bool fails(const AccuracyRow& row) {
  return row.missed > 0 || row.median_us > kMaxUs ||
         (row.setting.virtual_tool && row.direction_mean_deg > kMaxOffDeg);
}

/// "`adapted` 3.1 degrees off, 2.0 us a frame".
std::string figures(const std::vector<AccuracyRow>& rows) {
  std::string text;
  for (const AccuracyRow& row : rows)
    if (accuracy::is_judged(row))
      text += fmt::format("{}{} {:.1f} degrees off{}, {:.1f} us a frame", text.empty() ? "" : "; ",
                          name_of(row.setting), row.direction_mean_deg,
                          row.missed > 0 ? fmt::format(" ({} contacts missed)", row.missed) : "",
                          row.median_us);
  return text;
}

}  // namespace

bool has_inside(const mesh::MeshReport& part) noexcept { return part.closed && !part.inverted; }

bool is_soon_measured(const mesh::MeshReport& part) noexcept {
  return part.triangles <= kMaxTriangles;
}

ModelChoice usual_model(const mesh::MeshReport& part) {
  const std::string held = "by a virtual tool, as stiff as the device allows.";
  if (part.closed)
    return {ContactModelKind::kField, true,
            "The part is closed, so it has an inside: the tool is held outside " + held};
  return {ContactModelKind::kField, true,
          "The part is open, so it has no inside: what there is of it holds the tool from either "
          "side, as a thin wall, " +
              held};
}

std::vector<accuracy::AccuracySetting> models_to_measure(double voxel_m) {
  using contact::PointWeights;
  return {{.model = ContactModelKind::kAdapted,
           .weights = PointWeights::kOne,
           .voxel_m = voxel_m,
           .shell_voxel_m = voxel_m},
          {.model = ContactModelKind::kField,
           .weights = PointWeights::kArea,
           .voxel_m = voxel_m,
           .shell_voxel_m = voxel_m},
          {.model = ContactModelKind::kField,
           .weights = PointWeights::kArea,
           .voxel_m = voxel_m,
           .shell_voxel_m = voxel_m,
           .virtual_tool = true}};
}

ModelChoice measured_model(const std::vector<AccuracyRow>& rows, const ModelChoice& usual) {
  std::vector<AccuracyRow> penalty;
  const AccuracyRow *tool = nullptr, *field = nullptr;
  for (const AccuracyRow& row : rows) {
    if (!row.setting.virtual_tool)
      penalty.push_back(row);
    if (!accuracy::is_judged(row))
      continue;
    if (row.setting.virtual_tool)
      tool = &row;
    if (!row.setting.virtual_tool && row.setting.model == ContactModelKind::kField)
      field = &row;
  }
  const std::string measured = figures(rows);
  if (measured.empty())
    return {usual.model, usual.virtual_tool, usual.reason + " No contact of it could be measured."};
  const std::string begin = fmt::format("Measured at {} places: {}. ", kMeasuredContacts, measured);
  const AccuracyRow* judge = tool ? tool : field;
  if (judge && !fails(*judge))
    return {ContactModelKind::kField, true,
            begin +
                "The tool is held outside by a virtual tool: it alone resists however deep the "
                "hand wants to go, as stiffly as the device allows."};
  accuracy::AccuracyGoal goal;
  goal.within_us = kMaxUs;
  const accuracy::AccuracyAdvice advice = accuracy::advise(penalty, goal);
  if (!advice.row)
    return {usual.model, usual.virtual_tool, usual.reason + " " + begin};
  const accuracy::AccuracySetting& best = penalty[*advice.row].setting;
  return {best.model, false,
          begin + fmt::format("A virtual tool does not do here, so the contact model is {}, which "
                              "a hard push passes.",
                              name_of(best))};
}

}  // namespace voxtouch::first_scene
