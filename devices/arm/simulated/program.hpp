#pragma once
/// What the programs of the simulated controllers share: options, faults, the hand, signals, the
/// end.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "core/types/version.hpp"
#include "devices/arm/simulated/faults.hpp"
#include "devices/operator/hand.hpp"

namespace voxtouch::arm_sim {

struct ProgramOptions {
  std::vector<double> tool_m;
  std::vector<std::string> faults;
  std::string hand_file;

  /// The tool's frame in the flange's: its axes.
  Pose tool() const {
    Pose pose;
    if (!tool_m.empty())
      pose.position = Eigen::Map<const Vec3>(tool_m.data());
    return pose;
  }
  /// Throws std::runtime_error that names the fault that cannot be read.
  FaultSchedule schedule(const ControllerFaults& known) const {
    std::vector<Fault> all;
    for (const std::string& text : faults)
      all.push_back(parse_fault(text, known));
    return FaultSchedule(std::move(all));
  }
};

/// The options that every controller has.
inline void declare(CLI::App& app, ProgramOptions& o, bool& virtual_time, double& patience_s,
                    const ControllerFaults& known) {
  app.add_flag("--virtual-time", virtual_time,
               "Time moves on with each answer of the remote side, not with the clock");
  app.add_option("--patience", patience_s, "Virtual time: seconds to wait for an answer")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--hand", o.hand_file,
                 "YAML file with motion and grip of the operator (keys: "
                 "devices/operator/hand_file.hpp); else nobody holds the arm");
  app.add_option("--tool", o.tool_m, "Tool's origin in the flange's frame, x y z [m]")->expected(3);
  app.add_option("--fault", o.faults,
                 "KIND@START[:DURATION[:VALUE]], seconds; many may be given. Kinds: " +
                     std::string(known.kinds));
}

/// What an arm's drag is at the tool, for a hand that has learned it: residual friction over a
/// forearm's lever; assumed.
inline constexpr hand::ToolDrag kDrag{1.0, 0.5};

/// No hand: nobody holds the tool that rests at `place_m`.
inline hand::Hand nobody(const Vec3& place_m, double substep_s) {
  sim::OperatorConfig released;
  released.released = true;
  Motion rest;
  rest.path = {place_m};
  return hand::Hand(released, rest, substep_s);
}

/// For the counts that a program says at its end.
template <class LineCounts>
std::string line_text(const LineCounts& l, std::uint64_t send_errors) {
  return fmt::format(
      "faults: {} lost, {} delayed, {} reordered, {} duplicated, {} answers lost; {} could not be "
      "sent",
      l.lost, l.delayed, l.reordered, l.duplicated, l.answers_lost, send_errors);
}

inline constexpr const char* kDivergedSentence =
    "the arm's mechanics have left the numbers: soften the hand or the gains";

/// Parses the command line, sets its flag at SIGINT, SIGTERM and SIGHUP, and runs `run(stop)`; the
/// program's exit status. What `run` throws is said on stderr.
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
