#pragma once
/// Common parts of the programs of the simulated controllers: options, faults, the hand, signals,
/// the end.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/types/version.hpp"
#include "devices/arm/simulated/network_loop.hpp"
#include "devices/arm/simulated/simulated_arm.hpp"
#include "devices/arm/simulated/start_posture.hpp"
#include "devices/operator/hand_file.hpp"

namespace voxtouch::arm_sim {

struct ProgramOptions {
  std::vector<double> tool_m;
  std::vector<std::string> faults;
  std::string hand_file;
  std::vector<double> posture_deg;
  std::optional<std::uint64_t> seed;

  /// The tool's frame in that of the flange, with parallel axes.
  Pose tool() const {
    Pose pose;
    if (!tool_m.empty())
      pose.position = Eigen::Map<const Vec3>(tool_m.data());
    return pose;
  }
  /// Throws std::runtime_error that names the invalid fault.
  FaultSchedule schedule(const ControllerFaults& known) const {
    std::vector<Fault> all;
    for (const std::string& text : faults)
      all.push_back(parse_fault(text, known));
    return FaultSchedule(std::move(all));
  }
};

/// Declares the options of every controller.
inline void declare(CLI::App& app, ProgramOptions& o, NetworkConfig& network, bool& virtual_time,
                    const ControllerFaults& known) {
  app.add_option("--address", network.address, "Own address")->capture_default_str();
  app.add_option("--port", network.port, "Own port; 0: any free one")->capture_default_str();
  app.add_flag("--virtual-time", virtual_time,
               "Time advances with each reply of the remote side, not with the clock");
  app.add_option("--patience", network.patience_s, "Virtual time: timeout of a reply [s]")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--duration", network.duration_s,
                 "Duration in the controller's time [s]; default: until SIGTERM")
      ->check(CLI::PositiveNumber);
  app.add_option("--hand", o.hand_file,
                 "YAML file with motion and grip of the operator (keys: "
                 "devices/operator/hand_file.hpp); default: released");
  app.add_option("--tool", o.tool_m, "Tool's origin in the flange's frame, x y z [m]")->expected(3);
  app.add_option("--posture-deg", o.posture_deg,
                 "Start posture, joints from the base on; with --hand only an initial guess")
      ->expected(7);
  app.add_option("--seed", o.seed, "Seed of noise and faults; default: the hand file's, else 0");
  app.add_option(
      "--fault", o.faults,
      "KIND@START[:DURATION[:VALUE]] [s]; repeatable. Kinds: " + std::string(known.kinds));
}

/// Drag of an arm at the tool, for a hand that compensates it: residual friction over the lever of
/// a forearm; assumed.
inline constexpr hand::ToolDrag kDrag{1.0, 0.5};

/// The operator of the hand file, and in `config` the posture of the arm for it and the seed;
/// without a file the tool is released. Throws std::runtime_error if the file is unreadable or the
/// start of the motion is out of reach.
template <class Arm>
hand::Hand make_hand(const ProgramOptions& o, const Arm& arm, ArmConfig& config) {
  hand::HandFile file;
  if (!o.hand_file.empty())
    file = hand::read_hand(o.hand_file);
  if (!file.posture_rad.empty() && file.posture_rad.size() != 7)
    throw std::runtime_error(
        fmt::format("{}: posture_rad needs 7 numbers for this arm", o.hand_file));
  if (!file.posture_rad.empty())
    config.start_rad = Eigen::Map<const arm::Joints>(file.posture_rad.data());
  if (!o.posture_deg.empty())
    config.start_rad =
        Eigen::Map<const arm::Joints>(o.posture_deg.data()) * (std::numbers::pi / 180.0);
  config.seed = o.seed.value_or(file.seed);
  if (o.hand_file.empty()) {
    file.hand.released = true;
    file.motion.path = {arm.at(config.start_rad).pose_BT.position};
    return hand::Hand(file.hand, file.motion, kSubstep);
  }
  hand::Hand hand(file.hand, file.motion, kSubstep, config.seed, kDrag);
  const auto reach = [&arm](const arm::Joints& q) {
    const auto state = arm.at(q);
    return Reach{state.pose_BT, state.jacobian};
  };
  config.start_rad =
      start_posture(reach, {file.motion.path.front(), file.motion.orientation.normalized()},
                    config.start_rad, config.plant.lowest_rad, config.plant.highest_rad);
  return hand;
}

/// Text for the counts that a program prints at its end.
template <class LineCounts>
std::string line_text(const LineCounts& l, std::uint64_t send_errors) {
  return fmt::format(
      "faults: {} lost, {} delayed, {} reordered, {} duplicated, {} replies lost; {} not sent",
      l.lost, l.delayed, l.reordered, l.duplicated, l.answers_lost, send_errors);
}

/// Throws std::runtime_error if a run did not end as requested.
inline void require_good(Ending ending, double patience_s) {
  if (ending == Ending::kNoAnswer)
    throw std::runtime_error(fmt::format(
        "no reply within {} s. Check that the device's program runs and replies", patience_s));
  if (ending == Ending::kDiverged)
    throw std::runtime_error(
        "the simulation of the arm diverged: reduce the hand's stiffness or the gains");
}

/// Parses the command line, sets the flag on SIGINT, SIGTERM and SIGHUP, and calls `run(stop)`;
/// returns the exit status. Exceptions of `run` are printed on stderr.
template <class Run>
int program_main(CLI::App& app, int argc, char** argv, const char* name, Run&& run) {
  static constinit std::atomic<bool> stop_asked{false};
  app.set_version_flag("--version", std::string(version()));
  CLI11_PARSE(app, argc, argv);
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked.store(true, std::memory_order_relaxed); };
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    sigaction(number, &action, nullptr);
  try {
    run(stop_asked);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return 1;
  }
}

}  // namespace voxtouch::arm_sim
