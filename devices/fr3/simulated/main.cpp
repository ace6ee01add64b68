// voxtouch_fci_robot: a Franka arm and an operator, simulated, behind the real protocol on TCP and UDP.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdio>
#include <exception>

#include "core/types/version.hpp"
#include "devices/arm/simulated/start_posture.hpp"
#include "devices/fr3/simulated/fci_server.hpp"
#include "devices/operator/hand_file.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::fr3_sim;

constinit std::atomic<bool> stop_asked{false};

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked.store(true, std::memory_order_relaxed); };
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaction(number, &action, nullptr);
}

struct Options {
  ServerConfig server;
  RobotConfig robot;
  std::vector<double> tool_m;
  std::vector<std::string> faults;
  std::string hand_file;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("--address", o.server.address, "Own address")->capture_default_str();
  app.add_option("--port", o.server.port, "TCP port to listen on; 0: any free one")->capture_default_str();
  app.add_option("--server-version", o.robot.version, "Version that the server speaks: 10, 9, 6 or 5")->capture_default_str();
  app.add_flag("--virtual-time", o.server.virtual_time, "Time moves on with each command, not with the clock");
  app.add_option("--patience", o.server.patience_s, "Virtual time: seconds to wait for a command")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--hand", o.hand_file,
                 "YAML file with motion and grip of the operator (keys: devices/operator/hand_file.hpp); else nobody holds the arm");
  app.add_option("--tool", o.tool_m, "Tool's origin in the flange's frame, x y z [m]")->expected(3);
  app.add_option("--fault", o.faults,
                 "KIND@START[:DURATION[:VALUE]], seconds; many may be given. Kinds: loss answer_loss late jitter reorder duplicate "
                 "nan user_stop guiding reflex not_ready silent closed");
}

/// What this arm's drag is at the tool, for a hand that has learned it: residual friction over a forearm's lever; assumed.
constexpr hand::ToolDrag kDrag{1.0, 0.5};

hand::Hand make_hand(Options& o) {
  const fr3::Fr3Arm flange;
  if (o.hand_file.empty()) {
    sim::OperatorConfig nobody;
    nobody.released = true;
    Motion rest;
    rest.path = {flange.at(o.robot.start_rad).pose_BT.position};
    return hand::Hand(nobody, rest, kSubstep);
  }
  const hand::HandFile file = hand::read_hand(o.hand_file);
  o.robot.seed = file.seed;
  hand::Hand hand(file.hand, file.motion, kSubstep, file.seed, kDrag);
  Pose tool;
  if (!o.tool_m.empty()) tool.position = Eigen::Map<const Vec3>(o.tool_m.data());
  const fr3::Fr3Arm arm(tool);
  const auto reach = [&arm](const arm::Joints& q) {
    const fr3::Fr3Arm::State state = arm.at(q);
    return arm_sim::Reach{state.pose_BT, state.jacobian};
  };
  o.robot.start_rad = arm_sim::start_posture(reach, {file.motion.path.front(), file.motion.orientation.normalized()},
                                             fr3::fr3_rest_posture(), o.robot.plant.lowest_rad, o.robot.plant.highest_rad);
  return hand;
}

void tell_counts(const FciServer& server, const FciRobot& robot) {
  const RobotCounts& r = robot.counts();
  const ServerCounts& s = server.counts();
  const Line::Counts& l = server.line().counts();
  fmt::print(stderr,
             "{:.3f} s simulated: {} states sent, {} commands received, {} taken in time, {} missed; {} motions, {} reflexes, {} "
             "overruns\n"
             "refused: {} length, {} stale, {} not finite, {} without a motion, {} foreign\n"
             "faults: {} lost, {} delayed, {} reordered, {} duplicated, {} answers lost; {} could not be sent\n",
             robot.time_s(), s.sent, s.received, r.commands, r.missed, r.motions, r.reflexes, s.overruns, r.length, r.stale,
             r.not_finite, r.idle, s.foreign, l.lost, l.delayed, l.reordered, l.duplicated, l.answers_lost, s.send_errors);
}

int run(Options& o) {
  Pose tool;
  if (!o.tool_m.empty()) tool.position = Eigen::Map<const Vec3>(o.tool_m.data());
  o.robot.plant = fr3_plant(tool);
  std::vector<Fault> faults;
  for (const std::string& text : o.faults) faults.push_back(parse_fault(text));
  const FaultSchedule schedule(std::move(faults));
  hand::Hand hand = make_hand(o);
  FciRobot robot(o.robot, std::move(hand), schedule);
  FciServer server(o.server, robot, Line(schedule, kTick, o.robot.seed));
  catch_signals();
  fmt::print(stderr, "simulated controller: TCP {}:{}, version {}, {} time\n", o.server.address, server.port(), o.robot.version,
             o.server.virtual_time ? "virtual" : "real");
  const Ending ending = server.run(stop_asked);
  tell_counts(server, robot);
  if (ending == Ending::kNoAnswer)
    throw std::runtime_error(fmt::format("no command came within {} s: is the device's program running?", o.server.patience_s));
  if (ending == Ending::kDiverged)
    throw std::runtime_error("the arm's mechanics have left the numbers: soften the hand or the gains");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulated Franka arm: control interface on TCP and UDP, arm, and operator");
  app.set_version_flag("--version", std::string(version()));
  Options options;
  declare(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "voxtouch_fci_robot: {}\n", error.what());
    return 1;
  }
}
