#include "nodes/cli/accuracy/accuracy_choice.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

constexpr std::string_view kVirtualTool = "virtual_tool";

template <class T>
void add_once(std::vector<T>& list, const T& value) {
  if (std::find(list.begin(), list.end(), value) == list.end())
    list.push_back(value);
}

std::vector<contact::ContactModelKind> models_of(const AccuracyChoice& choice) {
  std::vector<contact::ContactModelKind> out;
  for (const std::string& word : choice.models) {
    if (word == kVirtualTool)
      continue;
    contact::ContactModelKind kind{};
    contact::parse_contact_model(word, kind);
    add_once(out, kind);
  }
  if (choice.models.empty())
    out = {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted,
           contact::ContactModelKind::kField};
  return out;
}

std::vector<contact::PointWeights> weights_of(const AccuracyChoice& choice) {
  std::vector<contact::PointWeights> out;
  for (const std::string& word : choice.weights)
    add_once(out, word == "one" ? contact::PointWeights::kOne : contact::PointWeights::kArea);
  if (out.empty())
    out = {contact::PointWeights::kOne, contact::PointWeights::kArea};
  return out;
}

std::vector<double> each_once(const std::vector<double>& values,
                              const std::vector<double>& otherwise) {
  std::vector<double> out;
  for (const double value : values.empty() ? otherwise : values)
    add_once(out, value);
  return out;
}

bool needs_area_weights(contact::ContactModelKind model) {
  return model == contact::ContactModelKind::kField;
}

}  // namespace

std::vector<accuracy::AccuracySetting> settings_of(const AccuracyChoice& choice,
                                                   double scene_voxel_m) {
  const std::vector<contact::PointWeights> weights = weights_of(choice);
  const std::vector<double> voxels =
      each_once(choice.voxel_sizes_m, {2.0 * scene_voxel_m, scene_voxel_m, 0.5 * scene_voxel_m});
  const std::vector<double> densities = each_once(choice.shell_densities, {1.0});
  const bool area =
      std::find(weights.begin(), weights.end(), contact::PointWeights::kArea) != weights.end();
  std::vector<accuracy::AccuracySetting> out;
  for (const contact::ContactModelKind model : models_of(choice)) {
    if (needs_area_weights(model) && !area && !choice.models.empty())
      throw std::invalid_argument(
          fmt::format("--weights one: model '{}' has area weights only. Add area to --weights, or "
                      "remove the model from --models",
                      contact::name_of(model)));
    for (const contact::PointWeights weight : weights) {
      if (needs_area_weights(model) && weight != contact::PointWeights::kArea)
        continue;
      for (const double voxel : voxels)
        for (const double density : densities)
          out.push_back({.model = model,
                         .weights = weight,
                         .voxel_m = voxel,
                         .shell_voxel_m = voxel / density});
    }
  }
  // By default one row, at the scene's voxel size.
  const bool tool =
      std::find(choice.models.begin(), choice.models.end(), kVirtualTool) != choice.models.end();
  if (tool || (choice.models.empty() && area))
    for (const double voxel :
         tool || !choice.voxel_sizes_m.empty() ? voxels : std::vector{scene_voxel_m})
      for (const double density : densities)
        out.push_back({contact::ContactModelKind::kField, contact::PointWeights::kArea, voxel,
                       voxel / density, true});
  if (out.size() > kMaxSettings)
    throw std::invalid_argument(fmt::format(
        "{} settings requested, limit {} a run. Select fewer models, voxel sizes or densities",
        out.size(), kMaxSettings));
  return out;
}

std::string_view weights_word(contact::PointWeights weights) noexcept {
  return weights == contact::PointWeights::kArea ? "area" : "one";
}

std::string describe(const accuracy::AccuracySetting& s) {
  std::string text = s.virtual_tool ? fmt::format("virtual tool, e = {:.4g} mm", s.voxel_m * 1e3)
                                    : fmt::format("{}/{}, e = {:.4g} mm", contact::name_of(s.model),
                                                  weights_word(s.weights), s.voxel_m * 1e3);
  if (s.shell_voxel_m != s.voxel_m)
    text += fmt::format(", shell {:.4g} mm", s.shell_voxel_m * 1e3);
  return text;
}

}  // namespace voxtouch::cli
