#include "tests/unit/driver_contract/faults.hpp"

#include <algorithm>
#include <chrono>

#include "devices/phantom/simulated/hdsim.h"
#include "tests/unit/driver_contract/subject.hpp"

namespace voxtouch::contract {
namespace {

using namespace std::chrono_literals;
using enum devices::DeviceError;

constexpr double kWatchdog =
    0.012;  // the simulated amplifier's 10 ms, and the two ticks that it may lie between
constexpr double kMisses =
    0.006;  // the simulated controller's five misses in a row, and the period that they end in
constexpr double kWindow = 0.03;  // its eleven misses of the last 100, which are every other answer
constexpr std::string_view kAmplifier = "nothing gets through: the amplifier's watchdog, 10 ms";
constexpr std::string_view kLateTick = "no tick, no driver: the amplifier's watchdog, 10 ms";
constexpr std::string_view kController =
    "no measurement, no answer: the controller bears five misses";
constexpr std::string_view kHalf =
    "every other answer still comes: the controller bears ten misses of a hundred";

constexpr FaultCase hd(std::string_view name, int code, double amount, double end_amount,
                       After after, devices::DeviceError reported, double bound_s = 0.0,
                       std::string_view why = {}) {
  return {name,  Plant::kPhantom, code,     amount,  end_amount, {},
          false, after,           reported, bound_s, why};
}
constexpr FaultCase opening(std::string_view name, int code, double amount, After after) {
  return {name, Plant::kPhantom, code, amount, -1, {}, false, after, kFault, 0.0, {}, true};
}
constexpr FaultCase fri(std::string_view name, std::string_view text, After after,
                        devices::DeviceError reported, double bound_s = 0.0,
                        std::string_view why = {}, bool short_one = false) {
  return {name, Plant::kLwr, 0, 0.0, 0.0, text, short_one, after, reported, bound_s, why};
}

constexpr double kTwenty =
    0.021;  // the simulated arm's twenty misses in a row, and the period that they end in
constexpr std::string_view kRobot =
    "no state, no answer: the robot bears twenty misses, as the maker says";
constexpr FaultCase fci(std::string_view name, std::string_view text, After after,
                        devices::DeviceError reported, double bound_s = 0.0,
                        std::string_view why = {}, bool short_one = false) {
  return {name, Plant::kFr3, 0, 0.0, 0.0, text, short_one, after, reported, bound_s, why};
}

}  // namespace

std::string_view name_of(After after) noexcept {
  switch (after) {
    case After::kRidesThrough:
      return "rides through";
    case After::kRecovers:
      return "recovers";
    case After::kEnds:
      return "ends";
    case After::kRefused:
      return "refused";
  }
  return "unknown";
}

const std::vector<FaultCase>& fault_cases() {
  static const std::vector<FaultCase> cases = {
      hd("comm_error", HDSIM_COMM_ERROR, -1, 0, After::kEnds, kDisconnected, kWatchdog, kAmplifier),
      hd("device_fault", HDSIM_DEVICE_FAULT, -1, 0, After::kEnds, kFault),
      hd("timer_error", HDSIM_TIMER_ERROR, 0, -1, After::kEnds, kFault),
      hd("warm_motors", HDSIM_WARM_MOTORS, 1.5, 0.2, After::kRecovers, kRecoverable),
      hd("late_tick", HDSIM_LATE_TICK, 0.05, -1, After::kRidesThrough, kTimeout, kWatchdog,
         kLateTick),
      hd("skipped_ticks", HDSIM_SKIPPED_TICKS, 1e6, 0, After::kRecovers, kTimeout),
      hd("nan_position", HDSIM_NAN_POSITION, -1, 0, After::kRecovers, kProtocol),
      opening("init_fails_once", HDSIM_FAIL_INIT, 0x0302,
              After::kRidesThrough),  // the next name is tried
      opening("init_licence", HDSIM_FAIL_INIT, 0x0600, After::kRefused),
      opening("init_in_use", HDSIM_FAIL_INIT, 0x0301, After::kRefused),
      opening("start_fails", HDSIM_FAIL_START, 0, After::kRefused),
      fri("loss", "loss", After::kRecovers, kRecoverable, kMisses, kController),
      fri("one_lost", "loss", After::kRidesThrough, kRecoverable, 0.0, {}, true),
      fri("answer_loss", "answer_loss", After::kRecovers, kRecoverable, kMisses, kController),
      fri("late", "late", After::kRecovers, kRecoverable, kMisses, kController),
      fri("jitter", "jitter", After::kRidesThrough, kRecoverable),
      fri("reorder", "reorder", After::kRecovers, kRecoverable, kWindow, kHalf),
      fri("duplicate", "duplicate", After::kRidesThrough, kRecoverable),
      fri("nan_joint", "nan:3", After::kRecovers, kProtocol),
      fri("nan_stamp", "nan:8", After::kRecovers, kProtocol),
      fri("drives_off", "drives_off", After::kRecovers, kRecoverable),
      fri("one_drive_off", "drives_off:4", After::kRecovers, kRecoverable),
      fri("drive_error", "drive_error:16", After::kRecovers, kFault),
      fri("estop", "estop", After::kRecovers, kRecoverable),
      fri("quality", "quality", After::kRecovers, kRecoverable),
      fri("silent", "silent", After::kRecovers, kTimeout, kMisses, kController),
      fci("loss", "loss", After::kRecovers, kRecoverable, kTwenty, kRobot),
      fci("one_lost", "loss", After::kRidesThrough, kRecoverable, 0.0, {}, true),
      fci("answer_loss", "answer_loss", After::kRecovers, kRecoverable, kTwenty, kRobot),
      fci("late", "late", After::kRecovers, kRecoverable, 0.024, kRobot),
      fci("jitter", "jitter", After::kRidesThrough, kRecoverable),
      fci("reorder", "reorder", After::kRidesThrough, kRecoverable),
      fci("duplicate", "duplicate", After::kRidesThrough, kRecoverable),
      fci("nan_joint", "nan:3", After::kRecovers, kProtocol),
      fci("user_stop", "user_stop", After::kRecovers, kRecoverable),
      fci("guiding", "guiding", After::kRecovers, kRecoverable),
      fci("not_ready", "not_ready", After::kRecovers, kRecoverable),
      fci("reflex", "reflex:7", After::kEnds, kFault),
      fci("silent", "silent", After::kRecovers, kTimeout, kTwenty, kRobot),
      fci("closed", "closed", After::kEnds, kDisconnected),
  };
  return cases;
}

bool FaultOutcome::good() const noexcept {
  if (fault->after == After::kRefused)
    return after == After::kRefused && zero_in_time();
  if (fault->after == After::kRidesThrough)
    return pushed;
  return pushed && zero_in_time();
}

double fault_start_s(const Subject& subject) {
  if (subject.virtual_time())
    return 0.4;
  return subject.name() == "lwr" || subject.name() == "fr3" ? 1.5 : 0.4;
}

double fault_lasts_s(const Subject& subject, const FaultCase& fault) {
  if (fault.short_one)
    return 0.001;
  return subject.virtual_time() ? 0.15 : 0.35;
}

namespace {

void note(FaultOutcome& o, devices::DeviceError error, double after_s,
          const std::string& last_error) {
  if (!o.reported_after_s)
    o.reported_after_s = after_s;
  if (o.sentence.empty())
    o.sentence = last_error;
  if (std::find(o.reported.begin(), o.reported.end(), error) == o.reported.end())
    o.reported.push_back(error);
}

/// Compares the plant's force with the bound.
void judge(FaultOutcome& o, const std::vector<Received>& received, double began_s) {
  const double tick = 1e-3 * o.period_s;
  for (const Received& r : received) {
    const double begin = r.begin_s - began_s;
    // The largest of the last 20 periods: on a busy machine a tick may go by without a command.
    if (r.end_s - began_s < tick && begin > -20.0 * o.period_s)
      o.before_n = std::max(o.before_n, r.wrench.force.norm());
    if (begin < -tick || begin > o.bound_s + kWatched)
      continue;
    if (r.wrench.zero() && !o.zero_after_s)
      o.zero_after_s = std::max(0.0, begin);
    if (!r.wrench.zero())
      o.zero_after_s.reset();
    if (begin < o.bound_s - tick)
      continue;
    o.largest_n = std::max(o.largest_n, r.wrench.force.norm());
    o.largest_nm = std::max(o.largest_nm, r.wrench.torque.norm());
  }
}

bool force_returns(const std::vector<Received>& received, const Wrench& push, double since_s) {
  return !received.empty() && received.back().begin_s > since_s &&
         received.back().wrench.force.norm() > 0.8 * push.force.norm();
}

}  // namespace

FaultOutcome run_fault(Subject& subject, const FaultCase& fault) {
  FaultOutcome o;
  o.fault = &fault;
  o.virtual_time = subject.virtual_time();
  subject.plan(fault);
  try {
    subject.open();
  } catch (const devices::DeviceOpenError& error) {
    o.after = After::kRefused;
    o.sentence = error.what();
    for (const Received& r : subject.received())
      o.largest_n = std::max(o.largest_n, r.wrench.force.norm());
    return o;
  }
  o.period_s = 1.0 / subject.driver().description().rate_hz;
  o.bound_s =
      std::max(o.period_s, fault.bound_s * std::max(1.0, o.period_s / 1e-3)) + subject.slack_s();
  const Wrench push = subject.usual_push();
  const auto give_up = std::chrono::steady_clock::now() + 20s;
  const auto patient = [&] { return std::chrono::steady_clock::now() < give_up; };
  double end_s = 1e9;  // fraction of the time for the force to return
  bool back = false;
  while (patient() && subject.now_s() < end_s && !back) {
    const Subject::Cycle t = subject.cycle(push);
    const auto began = subject.fault_began_s();
    if (!began)
      continue;
    const double over_s = *began + std::max(fault_lasts_s(subject, fault), o.bound_s + kWatched);
    end_s = over_s + (fault.plant == Plant::kPhantom ? 0.5 : 2.0);
    if (!t.sample)
      note(o, t.sample.error(), t.time_s - *began, t.last_error);
    if (t.sample && !t.written)
      note(o, t.written.error(), t.time_s - *began, t.last_error);
    back = subject.now_s() > over_s && force_returns(subject.received(), push, over_s);
  }
  o.after = !back ? After::kEnds : o.reported.empty() ? After::kRidesThrough : After::kRecovers;
  subject.close();
  judge(o, subject.received(), subject.fault_began_s().value_or(0.0));
  o.pushed = o.before_n > 0.8 * push.force.norm();
  return o;
}

}  // namespace voxtouch::contract
