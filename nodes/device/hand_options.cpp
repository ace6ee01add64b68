#include "nodes/device/hand_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "devices/operator/hand.hpp"
#include "devices/registry.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::device_node {

void add_hand_options(CLI::App& app, HandChoice& choice) {
  app.add_option("--hand", choice.grip,
                 fmt::format("Grip of the simulated hand: {}; default: the device's",
                             fmt::join(hand::grip_names(), ", ")));
  app.add_option_function<std::string>(
         "--hand-from", [&choice](const std::string& from) { choice.from_page = from == "page"; },
         "Source of the simulated hand's motion: `motion` (see --motion) or `page` (mouse, touch, "
         "keys or gamepad on the page of `up --view`)")
      ->check(CLI::IsMember({"motion", "page"}))
      ->default_str("motion");
  app.add_option("--release-time", choice.release_time_s,
                 "Device time at which the simulated hand releases the device [s]")
      ->check(runtime::require_positive);
  app.add_option("--grip-change-time", choice.grip_change_time_s,
                 "Device time at which the grip stiffness changes [s]")
      ->check(runtime::require_positive);
  app.add_option("--grip-factor", choice.grip_factor,
                 "Ratio of the new grip stiffness to the first")
      ->capture_default_str()
      ->check(runtime::require_positive)  // also refuses nan
      ->check(CLI::Range(1e-3, 1e3));
}

std::optional<sim::OperatorConfig> choose_hand(const std::string& device, const HandChoice& choice,
                                               const devices::DeviceOptions& options) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (choice.grip.empty() && choice.release_time_s == kNever && choice.grip_change_time_s == kNever)
    return std::nullopt;
  sim::OperatorConfig hand = devices::usual_hand(device, options);
  if (!choice.grip.empty()) {
    const std::optional<sim::OperatorConfig> named = hand::grip(choice.grip);
    if (!named)
      throw devices::DeviceOpenError(fmt::format("Unknown hand '{}'. --hand accepts {}",
                                                 choice.grip, fmt::join(hand::grip_names(), ", ")));
    const bool carries = hand.carries_tool;
    hand = *named;
    hand.carries_tool = carries;
  }
  hand.release_time_s = choice.release_time_s;
  hand.grip_change_time_s = choice.grip_change_time_s;
  hand.grip_factor = choice.grip_change_time_s < kNever ? choice.grip_factor : 1.0;
  return hand;
}

void append_arguments(const HandChoice& choice, std::vector<std::string>& arguments) {
  const HandChoice usual;
  const auto number = [&](const char* name, double value, double default_value) {
    if (value != default_value)
      arguments.insert(arguments.end(), {name, fmt::format("{}", value)});
  };
  if (!choice.grip.empty())
    arguments.insert(arguments.end(), {"--hand", choice.grip});
  if (choice.from_page)
    arguments.insert(arguments.end(), {"--hand-from", "page"});
  number("--release-time", choice.release_time_s, usual.release_time_s);
  number("--grip-change-time", choice.grip_change_time_s, usual.grip_change_time_s);
  number("--grip-factor", choice.grip_factor, usual.grip_factor);
}

void check_hand_from(const std::string& device, const HandChoice& choice, bool lockstep) {
  if (!choice.from_page)
    return;
  devices::require_led(device);
  if (lockstep)
    throw devices::DeviceOpenError(
        "--hand-from page runs in wall time and is not repeatable. Start without --lockstep, or "
        "with --motion");
}

std::string to_text(const HandChoice& choice) {
  return fmt::format("{}/{}/{}/{}", choice.grip, choice.release_time_s, choice.grip_change_time_s,
                     choice.grip_factor);
}

}  // namespace voxtouch::device_node
