#pragma once
/// Grip of the simulated operator, from the command line.
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
  std::string grip;  ///< a name of grip_names(); empty: the default grip of the device
  double release_time_s = std::numeric_limits<double>::infinity();
  double grip_change_time_s = std::numeric_limits<double>::infinity();
  double grip_factor = 3.0;
  bool from_page = false;  ///< led by a page instead of a motion
};

/// Adds --hand, --hand-from, --release-time, --grip-change-time and --grip-factor.
void add_hand_options(CLI::App& app, HandChoice& choice);

/// Appends the arguments that give another process the same choice.
void append_arguments(const HandChoice& choice, std::vector<std::string>& arguments);

/// The selected operator for a device that opens with these options; absent without a selection.
/// Throws DeviceOpenError for an unknown grip.
std::optional<sim::OperatorConfig> choose_hand(const std::string& device, const HandChoice& choice,
                                               const devices::DeviceOptions& options);

/// Throws DeviceOpenError, with a sentence, if a page cannot lead the operator: for a device with
/// hardware or a network, or in lockstep.
void check_hand_from(const std::string& device, const HandChoice& choice, bool lockstep);

/// A text that is unique to the choice, for the identity of a recorded run.
std::string to_text(const HandChoice& choice);

}  // namespace voxtouch::device_node
