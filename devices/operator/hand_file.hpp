#pragma once
/// An operator as a file: what one process tells a simulated device in another about the hand that holds it.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/motion.hpp"
#include "devices/sim/operator.hpp"

namespace voxtouch {

/// Motion and poses in the device's frame D.
struct HandFile {
  Motion motion;
  OperatorConfig hand;
  std::vector<double> posture_rad;  ///< joints of the arm to start near; empty: the device's own choice
  std::uint64_t seed = 0;
};

/// Text, one `key = value` a line, vectors as numbers with blanks between, '#' starts a comment. The first key is
/// `format = voxtouch-hand-1`. `waypoint_m` may come many times, and has to at least once; every other key at most once; what is
/// left out keeps its default. Numbers are written with '.' in every locale, "inf" for infinity, and read back to the same bits.
///   seed; posture_rad; waypoint_m (x y z); speed_m_per_s; hold_s; repeat_from; circle_centre_m; circle_axis;
///   orientation_wxyz; released (0 or 1); let_go_at_s; grip_harder_at_s; grip_factor; mass_kg; damping_ns_per_m;
///   stiffness_n_per_m; inertia_kg_m2; damping_nms_per_rad; stiffness_nm_per_rad; carries_tool (0 or 1); tremor_n;
///   tremor_bandwidth_hz
std::string to_text(const HandFile& file);
/// Throws std::runtime_error: `name`, line, what is wrong, what to do. Checks form and OperatorConfig's ranges; motions are
/// checked by what follows them.
HandFile parse_hand(std::string_view text, std::string_view name);

/// Throw std::runtime_error where the file cannot be written or read.
void write_hand(const std::filesystem::path& path, const HandFile& file);
HandFile read_hand(const std::filesystem::path& path);

}  // namespace voxtouch
