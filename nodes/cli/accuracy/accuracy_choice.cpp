#include "nodes/cli/accuracy/accuracy_choice.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

constexpr std::string_view kVirtualTool = "virtual_tool";

template <class T>
void add_once(std::vector<T>& list, const T& value) {
  if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
}

std::vector<contact::ContactModelKind> models_of(const AccuracyChoice& ask) {
  std::vector<contact::ContactModelKind> out;
  for (const std::string& word : ask.models) {
    if (word == kVirtualTool) continue;
    contact::ContactModelKind kind{};
    if (!contact::parse_contact_model(word, kind))
      throw std::invalid_argument(fmt::format(
          "--models: there is no contact model '{}'; known are original, adapted, clustered and field, and virtual_tool", word));
    add_once(out, kind);
  }
  if (ask.models.empty())
    out = {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted, contact::ContactModelKind::kClustered,
           contact::ContactModelKind::kField};
  return out;
}

std::vector<contact::PointWeights> weights_of(const AccuracyChoice& ask) {
  std::vector<contact::PointWeights> out;
  for (const std::string& word : ask.weights) {
    if (word != "one" && word != "area")
      throw std::invalid_argument(fmt::format(
          "--weights: points cannot weigh '{}'; known are one (each the same) and area (its share of the tool's "
          "surface)",
          word));
    add_once(out, word == "one" ? contact::PointWeights::kOne : contact::PointWeights::kArea);
  }
  if (out.empty()) out = {contact::PointWeights::kOne, contact::PointWeights::kArea};
  return out;
}

std::vector<double> positive(const char* option, const std::vector<double>& values, std::vector<double> otherwise) {
  std::vector<double> out;
  for (const double value : values) {
    if (!(std::isfinite(value) && value > 0.0))
      throw std::invalid_argument(
          fmt::format("{}: {} will not do; it must be finite and greater than 0", option, value));
    add_once(out, value);
  }
  return out.empty() ? otherwise : out;
}

bool knows_area_only(contact::ContactModelKind model) {
  return model == contact::ContactModelKind::kClustered || model == contact::ContactModelKind::kField;
}

}  // namespace

std::vector<accuracy::AccuracySetting> settings_of(const AccuracyChoice& ask, double scene_voxel_m) {
  const std::vector<contact::PointWeights> weights = weights_of(ask);
  const std::vector<double> voxels =
      positive("--voxel-sizes", ask.voxel_sizes_m, {2.0 * scene_voxel_m, scene_voxel_m, 0.5 * scene_voxel_m});
  const std::vector<double> densities = positive("--shell-densities", ask.shell_densities, {1.0});
  const bool area = std::find(weights.begin(), weights.end(), contact::PointWeights::kArea) != weights.end();
  std::vector<accuracy::AccuracySetting> out;
  for (const contact::ContactModelKind model : models_of(ask)) {
    if (knows_area_only(model) && !area && !ask.models.empty())
      throw std::invalid_argument(
          fmt::format("--weights one: the model '{}' weighs points by their area only; add area to --weights, or leave "
                      "the model out of --models",
                      contact::name_of(model)));
    for (const contact::PointWeights weight : weights) {
      if (knows_area_only(model) && weight != contact::PointWeights::kArea) continue;
      for (const double voxel : voxels)
        for (const double density : densities) out.push_back({model, weight, voxel, voxel / density});
    }
  }
  // One row of it where nothing is said: at the scene's own voxels.
  const bool tool = std::find(ask.models.begin(), ask.models.end(), kVirtualTool) != ask.models.end();
  if (tool || (ask.models.empty() && area))
    for (const double voxel : tool || !ask.voxel_sizes_m.empty() ? voxels : std::vector{scene_voxel_m})
      for (const double density : densities)
        out.push_back({contact::ContactModelKind::kField, contact::PointWeights::kArea, voxel, voxel / density, true});
  if (out.size() > kMaxSettings)
    throw std::invalid_argument(fmt::format(
        "{} settings are asked for, {} at most can be measured in one run; name fewer models, voxel sizes or densities",
        out.size(), kMaxSettings));
  return out;
}

}  // namespace voxtouch::cli
