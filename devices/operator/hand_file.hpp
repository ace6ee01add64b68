#pragma once
/// An operator as a file: what one process sends to a simulated device in another about the hand
/// that holds it.
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
  std::vector<double>
      posture_rad;  ///< joints of the arm to start near; empty: the device's own choice
  std::uint64_t seed = 0;
};

/// YAML, one map; what is left out keeps its default, but there has to be a way point. Numbers do
/// not depend on the locale and read back bit-identically.
/// ```yaml
/// path_m: [[0, 0, 0.1], [0, 0, 0.05]]   # way points of Motion; the other keys are its fields and
/// OperatorConfig's: # speed_m_per_s, hold_s, repeat_from, circle_centre_m, circle_axis,
/// orientation_wxyz, turn_axis, turn_rad, turn_from_s, turn_to_s; released, release_time_s,
/// grip_change_time_s, # grip_factor, mass_kg, damping_ns_per_m, stiffness_n_per_m, inertia_kg_m2,
/// damping_nms_per_rad, stiffness_nm_per_rad, # carries_tool, tremor_n, tremor_bandwidth_hz
/// posture_rad: [0, 0, 0, -1.5, 0, 0, 0]
/// seed: 1
/// ```
std::string to_text(const HandFile& file);
/// Throws std::runtime_error: `name`, line, column, what is wrong. Unknown and doubled keys are
/// errors. Checks form and OperatorConfig's ranges; motions are checked by what follows them.
HandFile parse_hand(std::string_view text, std::string_view name);

/// Throws std::runtime_error where the file cannot be read, and as parse_hand does.
HandFile read_hand(const std::filesystem::path& path);

}  // namespace voxtouch::hand
