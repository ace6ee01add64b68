#pragma once
/// From the words of `voxtouch accuracy` to the settings that are measured.
#include <string>
#include <string_view>
#include <vector>

#include "core/accuracy/accuracy.hpp"

namespace voxtouch::cli {

/// As given on the command line, which has checked words and numbers; empty: the default.
struct AccuracyChoice {
  std::vector<std::string> models = {};    ///< default: all
  std::vector<std::string> weights = {};   ///< one, area; default: all that the model supports
  std::vector<double> voxel_sizes_m = {};  ///< e; default: 2, 1 and 1/2 times that of the scene
  std::vector<double> shell_densities =
      {};  ///< e / voxel edge that the shell is made with; default 1
};

/// Most settings of one run: more is a slip of the pen, and would take hours.
inline constexpr std::size_t kMaxSettings = 500;

/// Grouped by model and weights, in the requested order, without repetitions. `field` weighs by
/// area only. With both weights it occurs once. With `one` only it is skipped if no model was
/// named, and refused if it was. `virtual_tool` among the models, or no model: rows of a virtual
/// tool at the end, one row at the scene's voxel size by default. Throws std::invalid_argument with
/// the name of the option.
std::vector<accuracy::AccuracySetting> settings_of(const AccuracyChoice& choice,
                                                   double scene_voxel_m);

/// "one", "area".
std::string_view weights_word(contact::PointWeights weights) noexcept;
/// "adapted/area, e = 1 mm, shell 0.5 mm": the name of a setting in tables.
std::string describe(const accuracy::AccuracySetting& setting);

}  // namespace voxtouch::cli
