// voxtouch_fri_controller: the simulated robot controller with its arm and an operator, behind the
// real protocol on UDP.
#include <memory>

#include "core/types/number.hpp"
#include "devices/arm/simulated/program.hpp"
#include "devices/lwr/simulated/session.hpp"
#include "devices/lwr/simulated/trace.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::lwr_sim;

struct Options : arm_sim::ProgramOptions {
  std::string remote = "127.0.0.1:" + std::to_string(lwr::fri::kDefaultPort);
  SessionConfig session;
  ControllerConfig controller;
  int period_ms = 1;
  double torque_feedback_gain = 4.0;
  std::string trace_file;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("--remote", o.remote, "Destination of measurements, ADDRESS:PORT")
      ->capture_default_str();
  app.add_option("--period-ms", o.period_ms, "Period of measurements, 1 to 100 ms")
      ->capture_default_str();
  arm_sim::declare(app, o, o.session, o.controller.virtual_time, kFaults);
  app.add_option("--trace", o.trace_file, "Writes a CSV row for every period");
  app.add_option("--torque-feedback-gain", o.torque_feedback_gain,
                 "Divisor of the rotors' inertia and friction")
      ->capture_default_str();
}

/// Splits ADDRESS:PORT.
void set_remote(Options& o) {
  const auto colon = o.remote.rfind(':');
  const auto port = parse_number<std::uint16_t>(std::string_view(o.remote).substr(colon + 1));
  if (colon == std::string::npos || port.value_or(0) == 0)
    throw std::runtime_error(
        fmt::format("--remote '{}' is not ADDRESS:PORT, such as 127.0.0.1:49938", o.remote));
  o.session.remote_address = o.remote.substr(0, colon);
  o.session.remote_port = *port;
}

void print(FriController& controller) {
  while (const auto event = controller.take_event()) {
    const std::string why = event->why ? fmt::format(": {}", sentence_of(event->why.reason)) : "";
    if (event->from == event->to)
      fmt::print(stderr, "t={:.3f} s, {}{}\n", event->time_s, name_of(event->to), why);
    else
      fmt::print(stderr, "t={:.3f} s: {} -> {}{}\n", event->time_s, name_of(event->from),
                 name_of(event->to), why);
  }
}

void print_counts(const Session& session, const FriController& controller) {
  const AnswerCounts& a = controller.counts();
  const arm_sim::NetworkCounts& s = session.counts();
  fmt::print(stderr,
             "{:.3f} s simulated: {} periods, {} sent, {} received, {} replies in time, {} missed; "
             "{} starts, {} drops, {} overruns\n"
             "{} replaced by a newer reply; refused: {} stale, {} doubled, {} length, {} id, {} "
             "size field, {} not finite, {} foreign\n"
             "{}\n",
             controller.time_s(), controller.periods(), s.sent, s.received, a.accepted,
             controller.link().statistics().miss_counter, controller.starts(), controller.drops(),
             s.overruns, a.replaced, a.stale, a.doubled, a.length, a.id, a.size_field, a.not_finite,
             s.foreign, arm_sim::line_text(session.line().counts(), s.send_errors));
}

void run(Options& o, const std::atomic<bool>& stop) {
  set_remote(o);
  o.controller.period_s = 1e-3 * o.period_ms;
  o.controller.plant = lwr_plant(o.torque_feedback_gain);
  o.controller.plant.pose_FT = o.tool();
  const FaultSchedule schedule = o.schedule(kFaults);
  hand::Hand hand = arm_sim::make_hand(o, lwr::LwrArm(o.tool()), o.controller);
  FriController controller(o.controller, std::move(hand), schedule);
  std::unique_ptr<Trace> trace;
  if (!o.trace_file.empty())
    trace = std::make_unique<Trace>(o.trace_file);
  Session session(o.session, controller, Line(schedule, o.controller.period_s, o.controller.seed));
  session.after_period = [&](const FriController&) {
    if (trace)
      trace->write(controller.row());
    print(controller);
  };
  fmt::print(stderr, "simulated controller: {} -> {}, {} ms, {} time\n",
             arm::text_of(session.local()), o.remote, o.period_ms,
             o.controller.virtual_time ? "virtual" : "real");
  const Ending ending = session.run(stop);
  print(controller);
  if (trace)
    trace->finish();
  print_counts(session, controller);
  arm_sim::require_good(ending, o.session.patience_s);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulated controller of a light-weight robot: remote interface 1.0 on UDP, arm, and "
      "operator");
  Options options;
  declare(app, options);
  return arm_sim::program_main(app, argc, argv, "voxtouch_fri_controller",
                               [&](const std::atomic<bool>& stop) { run(options, stop); });
}
