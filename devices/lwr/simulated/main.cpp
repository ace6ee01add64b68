// voxtouch_fri_controller: the robot controller with its arm and an operator, simulated, behind the real protocol on UDP.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <numbers>

#include "core/types/number.hpp"
#include "core/types/version.hpp"
#include "devices/arm/simulated/start_posture.hpp"
#include "devices/lwr/simulated/session.hpp"
#include "devices/lwr/simulated/trace.hpp"
#include "devices/operator/hand_file.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::lwr_sim;

constinit std::atomic<bool> stop_asked{false};

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked.store(true, std::memory_order_relaxed); };
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaction(number, &action, nullptr);
}

struct Options {
  std::string remote = "127.0.0.1:" + std::to_string(lwr::fri::kDefaultPort);
  SessionConfig session;
  ControllerConfig controller;
  int period_ms = 1;
  double duration_s = 0.0;
  bool task_frame_base = false, hand_at_once = false;
  double torque_feedback_gain = 4.0;
  std::vector<double> posture_deg, tool_m;
  std::vector<std::string> faults;
  std::string hand_file, trace_file;
  std::optional<std::uint64_t> seed;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("--remote", o.remote, "Where measurements go, ADDRESS:PORT")->capture_default_str();
  app.add_option("--address", o.session.address, "Own address")->capture_default_str();
  app.add_option("--port", o.session.port, "Own port; 0: any free one")->capture_default_str();
  app.add_option("--period-ms", o.period_ms, "Period of measurements, 1 to 100 ms")->capture_default_str();
  app.add_flag("--virtual-time", o.controller.virtual_time, "Time moves on with each answer, not with the clock");
  app.add_option("--patience", o.session.patience_s, "Virtual time: seconds to wait for an answer")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--duration", o.duration_s, "Seconds of the controller's time, then end; 0: until SIGTERM");
  app.add_option("--hand", o.hand_file,
                 "YAML file with motion and grip of the operator (keys: devices/operator/hand_file.hpp)");
  app.add_flag("--hand-at-once", o.hand_at_once, "The hand moves from the start, not from the first command mode");
  app.add_option("--posture-deg", o.posture_deg, "Joints A1 A2 E1 A3 A4 A5 A6 to start at, or near with --hand")
      ->expected(7);
  app.add_option("--tool", o.tool_m, "Tool's origin in the flange's frame, x y z [m]")->expected(3);
  app.add_option("--fault", o.faults,
                 "KIND@START[:DURATION[:VALUE]], seconds; many may be given. Kinds: loss answer_loss late jitter "
                 "reorder duplicate nan drives_off drive_error estop quality silent");
  app.add_option("--seed", o.seed, "Of noise and faults; default: the hand file's, or 0");
  app.add_option("--trace", o.trace_file, "CSV of every period");
  app.add_flag("--task-frame-base", o.task_frame_base, "$STIFFNESS.TASKFRAME is the base, not the tool");
  app.add_flag("--first-start-keeps-strategy", o.controller.first_start_keeps_strategy,
               "As one published KRL program: the first friStart is in position control, whatever is asked for");
  app.add_option("--perfect-after", o.controller.quality.perfect_after, "Answers in time in a row for quality PERFECT")
      ->capture_default_str();
  app.add_option("--misses-in-a-row", o.controller.quality.misses_in_a_row, "Misses in a row that end command mode")
      ->capture_default_str();
  app.add_option("--misses-of-100", o.controller.quality.misses_in_window, "Misses of 100 that command mode bears")
      ->capture_default_str();
  app.add_option("--torque-feedback-gain", o.torque_feedback_gain, "Divides rotors' inertia and friction")
      ->capture_default_str();
  app.add_option("--torque-noise", o.controller.torque_noise_nm, "Of the torque sensors, standard deviation [Nm]")
      ->capture_default_str();
  app.add_option("--overlay-lag", o.controller.overlay_lag_s, "Lag of overlaid torques [s]")->capture_default_str();
}

/// Splits ADDRESS:PORT.
void set_remote(Options& o) {
  const auto colon = o.remote.rfind(':');
  const auto port = parse_number<std::uint16_t>(std::string_view(o.remote).substr(colon + 1));
  if (colon == std::string::npos || port.value_or(0) == 0)
    throw std::runtime_error(fmt::format("--remote '{}' is not ADDRESS:PORT, like 127.0.0.1:49938", o.remote));
  o.session.remote_address = o.remote.substr(0, colon);
  o.session.remote_port = *port;
}

lwr::LwrJoints posture(const Options& o, const std::vector<double>& from_file) {
  lwr::LwrJoints q = lwr::lwr_rest_posture();
  if (!from_file.empty() && from_file.size() != 7)
    throw std::runtime_error(fmt::format("{}: posture_rad needs 7 numbers for this arm", o.hand_file));
  if (!from_file.empty()) q = Eigen::Map<const lwr::LwrJoints>(from_file.data());
  if (!o.posture_deg.empty()) q = Eigen::Map<const lwr::LwrJoints>(o.posture_deg.data()) * (std::numbers::pi / 180.0);
  return q;
}

/// What this arm's drag is at the tool, for a hand that has learned it: residual friction over a forearm's lever; assumed.
constexpr hand::ToolDrag kDrag{1.0, 0.5};

hand::Hand make_hand(Options& o) {
  ControllerConfig& c = o.controller;
  const lwr::LwrArm arm(c.plant.pose_FT);
  if (o.hand_file.empty()) {
    c.start_rad = posture(o, {});
    c.seed = o.seed.value_or(0);
    sim::OperatorConfig nobody;
    nobody.released = true;
    Motion rest;
    rest.path = {arm.tool(c.start_rad).position};
    return hand::Hand(nobody, rest, kSubstep);
  }
  const hand::HandFile file = hand::read_hand(o.hand_file);
  c.seed = o.seed.value_or(file.seed);
  hand::Hand hand(file.hand, file.motion, kSubstep, c.seed, kDrag);
  const auto reach = [&arm](const lwr::LwrJoints& q) {
    const lwr::LwrArm::State state = arm.at(q);
    return arm_sim::Reach{state.pose_BT, state.jacobian};
  };
  const lwr::LwrJoints limit = lwr::lwr_limits().position_rad;
  c.start_rad = arm_sim::start_posture(reach, {file.motion.path.front(), file.motion.orientation.normalized()},
                                       posture(o, file.posture_rad), -limit, limit);
  return hand;
}

void tell(FriController& controller) {
  while (const auto event = controller.take_event()) {
    const std::string why = event->why ? fmt::format(": {}", sentence_of(event->why.reason)) : "";
    if (event->from == event->to)
      fmt::print(stderr, "t={:.3f} s, {}{}\n", event->time_s, name_of(event->to), why);
    else
      fmt::print(stderr, "t={:.3f} s: {} -> {}{}\n", event->time_s, name_of(event->from), name_of(event->to), why);
  }
}

void tell_counts(const Session& session, const FriController& controller) {
  const AnswerCounts& a = controller.counts();
  const SessionCounts& s = session.counts();
  const Line::Counts& l = session.line().counts();
  fmt::print(stderr,
             "{:.3f} s simulated: {} periods, {} sent, {} received, {} answers in time, {} missed; {} starts, {} "
             "drops, {} overruns\n"
             "{} replaced by a newer answer; refused: {} stale, {} doubled, {} length, {} id, {} size field, {} not "
             "finite, {} foreign\n"
             "faults: {} lost, {} delayed, {} reordered, {} duplicated, {} answers lost; {} could not be sent\n",
             controller.time_s(), controller.periods(), s.sent, s.received, a.accepted,
             controller.link().statistics().miss_counter, controller.starts(), controller.drops(), s.overruns,
             a.replaced, a.stale, a.doubled, a.length, a.id, a.size_field, a.not_finite, s.foreign, l.lost, l.delayed,
             l.reordered, l.duplicated, l.answers_lost, s.send_errors);
}

int run(Options& o) {
  set_remote(o);
  o.controller.period_s = 1e-3 * o.period_ms;
  o.controller.plant = lwr_plant(o.torque_feedback_gain);
  if (!o.tool_m.empty()) o.controller.plant.pose_FT.position = Eigen::Map<const Vec3>(o.tool_m.data());
  o.controller.laws.task_frame_is_tool = !o.task_frame_base;
  o.controller.hand_waits = !o.hand_at_once;
  if (o.duration_s > 0.0) o.session.duration_s = o.duration_s;
  std::vector<Fault> faults;
  for (const std::string& text : o.faults) faults.push_back(parse_fault(text));
  const FaultSchedule schedule(std::move(faults));
  hand::Hand hand = make_hand(o);
  FriController controller(o.controller, std::move(hand), schedule);
  std::unique_ptr<Trace> trace;
  if (!o.trace_file.empty()) trace = std::make_unique<Trace>(o.trace_file);
  Session session(o.session, controller, Line(schedule, o.controller.period_s, o.controller.seed));
  session.after_period = [&](const FriController&) {
    if (trace) trace->write(controller.row());
    tell(controller);
  };
  catch_signals();
  fmt::print(stderr, "simulated controller: {} -> {}, {} ms, {} time\n", arm::text_of(session.local()), o.remote,
             o.period_ms, o.controller.virtual_time ? "virtual" : "real");
  const Ending ending = session.run(stop_asked);
  tell(controller);
  if (trace) trace->finish();
  tell_counts(session, controller);
  if (ending == Ending::kNoAnswer)
    throw std::runtime_error(
        fmt::format("no answer from {} within {} s: is the device's program running, and does it answer?", o.remote,
                    o.session.patience_s));
  if (ending == Ending::kDiverged)
    throw std::runtime_error("the arm's mechanics have left the numbers: soften the hand or the gains");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Simulated controller of a light-weight robot: remote interface 1.0 on UDP, arm, and operator");
  app.set_version_flag("--version", std::string(version()));
  Options options;
  declare(app, options);
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "voxtouch_fri_controller: {}\n", error.what());
    return 1;
  }
}
