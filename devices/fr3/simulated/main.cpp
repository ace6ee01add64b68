// voxtouch_fci_robot: a Franka arm and an operator, simulated, behind the real protocol on TCP and
// UDP.
#include "devices/arm/simulated/program.hpp"
#include "devices/arm/simulated/start_posture.hpp"
#include "devices/fr3/simulated/fci_server.hpp"
#include "devices/operator/hand_file.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::fr3_sim;

struct Options : arm_sim::ProgramOptions {
  ServerConfig server;
  RobotConfig robot;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("--address", o.server.address, "Own address")->capture_default_str();
  app.add_option("--port", o.server.port, "TCP port to listen on; 0: any free one")
      ->capture_default_str();
  app.add_option("--server-version", o.robot.version,
                 "Version that the server speaks: 10, 9, 6 or 5")
      ->capture_default_str();
  arm_sim::declare(app, o, o.server.virtual_time, o.server.patience_s, kFaults);
}

hand::Hand make_hand(Options& o) {
  if (o.hand_file.empty())
    return arm_sim::nobody(fr3::Fr3Arm().at(o.robot.start_rad).pose_BT.position, kSubstep);
  const hand::HandFile file = hand::read_hand(o.hand_file);
  o.robot.seed = file.seed;
  hand::Hand hand(file.hand, file.motion, kSubstep, file.seed, arm_sim::kDrag);
  const fr3::Fr3Arm arm(o.tool());
  const auto reach = [&arm](const arm::Joints& q) {
    const fr3::Fr3Arm::State state = arm.at(q);
    return arm_sim::Reach{state.pose_BT, state.jacobian};
  };
  o.robot.start_rad = arm_sim::start_posture(
      reach, {file.motion.path.front(), file.motion.orientation.normalized()},
      fr3::fr3_rest_posture(), o.robot.plant.lowest_rad, o.robot.plant.highest_rad);
  return hand;
}

void tell_counts(const FciServer& server, const FciRobot& robot) {
  const RobotCounts& r = robot.counts();
  const ServerCounts& s = server.counts();
  fmt::print(stderr,
             "{:.3f} s simulated: {} states sent, {} commands received, {} taken in time, {} "
             "missed; {} motions, {} reflexes, {} "
             "overruns\n"
             "refused: {} length, {} stale, {} not finite, {} without a motion, {} foreign\n"
             "{}\n",
             robot.time_s(), s.sent, s.received, r.commands, r.missed, r.motions, r.reflexes,
             s.overruns, r.length, r.stale, r.not_finite, r.idle, s.foreign,
             arm_sim::line_text(server.line().counts(), s.send_errors));
}

void run(Options& o, const std::atomic<bool>& stop) {
  o.robot.plant = fr3_plant(o.tool());
  const FaultSchedule schedule = o.schedule(kFaults);
  hand::Hand hand = make_hand(o);
  FciRobot robot(o.robot, std::move(hand), schedule);
  FciServer server(o.server, robot, Line(schedule, kTick, o.robot.seed));
  fmt::print(stderr, "simulated controller: TCP {}:{}, version {}, {} time\n", o.server.address,
             server.port(), o.robot.version, o.server.virtual_time ? "virtual" : "real");
  const Ending ending = server.run(stop);
  tell_counts(server, robot);
  if (ending == Ending::kNoAnswer)
    throw std::runtime_error(fmt::format(
        "no command came within {} s: is the device's program running?", o.server.patience_s));
  if (ending == Ending::kDiverged)
    throw std::runtime_error(arm_sim::kDivergedSentence);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulated Franka arm: control interface on TCP and UDP, arm, and operator");
  Options options;
  declare(app, options);
  return arm_sim::program_main(app, argc, argv, "voxtouch_fci_robot",
                               [&](const std::atomic<bool>& stop) { run(options, stop); });
}
