// voxtouch_fci_robot: a simulated Franka arm with an operator, behind the real protocol on TCP and
// UDP.
#include "devices/arm/simulated/program.hpp"
#include "devices/fr3/simulated/fci_server.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::fr3_sim;

struct Options : arm_sim::ProgramOptions {
  ServerConfig server;
  RobotConfig robot;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("--server-version", o.robot.version, "FCI version of the server: 3 to 10")
      ->capture_default_str();
  arm_sim::declare(app, o, o.server, o.server.virtual_time, kFaults);
}

void print_counts(const FciServer& server, const FciRobot& robot) {
  const RobotCounts& r = robot.counts();
  const arm_sim::NetworkCounts& s = server.counts();
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
  hand::Hand hand = arm_sim::make_hand(o, fr3::Fr3Arm(o.tool()), o.robot);
  FciRobot robot(o.robot, std::move(hand), schedule);
  FciServer server(o.server, robot, Line(schedule, kTick, o.robot.seed));
  fmt::print(stderr, "simulated controller: TCP {}:{}, version {}, {} time\n", o.server.address,
             server.port(), o.robot.version, o.server.virtual_time ? "virtual" : "real");
  const Ending ending = server.run(stop);
  print_counts(server, robot);
  arm_sim::require_good(ending, o.server.patience_s);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulated Franka arm: control interface on TCP and UDP, arm, and operator");
  Options options;
  declare(app, options);
  return arm_sim::program_main(app, argc, argv, "voxtouch_fci_robot",
                               [&](const std::atomic<bool>& stop) { run(options, stop); });
}
