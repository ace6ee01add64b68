#pragma once
/// An operator as a file: one process passes the hand to a simulated device in another.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/motion.hpp"
#include "devices/sim/operator.hpp"

namespace voxtouch::hand {

/// Motion and poses in the device's frame D.
struct HandFile {
  Motion motion;
  sim::OperatorConfig hand;
  std::vector<double> posture_rad;  ///< initial joint posture; empty: the device's default
  std::uint64_t seed = 0;
};

/// YAML, one map. `path_m`, the way points, is required; the other keys are optional: the fields of
/// Motion and OperatorConfig, `posture_rad` and `seed`. Numbers do not depend on the locale and
/// read back bit-identically.
///
///     path_m: [[0, 0, 0.1], [0, 0, 0.05]]
///
///     speed_m_per_s: 0.05
///
///     seed: 1
std::string to_text(const HandFile& file);
/// Throws std::runtime_error with `name`, line, column and the error. Unknown and duplicate keys
/// are errors. Checks form and the ranges of OperatorConfig; the devices check motions.
HandFile parse_hand(std::string_view text, std::string_view name);

/// Throws std::runtime_error if the file cannot be read, and as parse_hand does.
HandFile read_hand(const std::filesystem::path& path);

}  // namespace voxtouch::hand
