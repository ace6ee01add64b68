#pragma once
/// How a simulated device is held, from the command line.
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "devices/device_options.hpp"

namespace CLI {
class App;
}

namespace voxtouch::device_node {

struct HandChoice {
  std::string grip;  ///< a name of grip_names(); empty: as the device is usually held
  double release_time_s = std::numeric_limits<double>::infinity();
  double grip_change_time_s = std::numeric_limits<double>::infinity();
  double grip_factor = 3.0;
  bool from_page = false;  ///< a page leads it, and no motion
};

/// --hand, --hand-from, --release-time, --grip-change-time, --grip-factor.
void add_hand_options(CLI::App& app, HandChoice& choice);

/// The arguments that give the same choice to another process.
void append_arguments(const HandChoice& choice, std::vector<std::string>& arguments);

/// The hand that was chosen for a device that opens with these options; absent where nothing was
/// chosen. Throws DeviceOpenError for an unknown grip.
std::optional<sim::OperatorConfig> choose_hand(const std::string& device, const HandChoice& choice,
                                               const devices::DeviceOptions& options);

/// Throws DeviceOpenError, a sentence, where a page was chosen to lead the hand and cannot: of a
/// device that is not arithmetic alone, or in lockstep.
void check_hand_from(const std::string& device, const HandChoice& choice, bool lockstep);

/// Words that differ where the hands differ, for the identity of a recorded run.
std::string to_text(const HandChoice& choice);

}  // namespace voxtouch::device_node
