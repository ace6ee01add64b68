#include "nodes/cli/identify/device_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <iterator>

#include <fmt/format.h>

#include "core/identification/hand_check.hpp"
#include "devices/command_gate.hpp"
#include "devices/force_guard.hpp"

namespace voxtouch::cli {
namespace {

using namespace std::chrono_literals;
namespace id = identification;

constexpr std::uint64_t kSession = 1, kWriter = 1;
constexpr int kMostReadErrors = 20;
constexpr double kSecondsPerAxis = 21.0;
constexpr std::array<char, 3> kAxisLetters{'x', 'y', 'z'};

/// Zero force whatever happens.
class ForceOff {
 public:
  explicit ForceOff(devices::Driver& driver) : driver_(driver) {}
  ~ForceOff() { driver_.stop(); }
  ForceOff(const ForceOff&) = delete;
  ForceOff& operator=(const ForceOff&) = delete;

 private:
  devices::Driver& driver_;
};

/// The path of every command: gate, guard, driver.
class GuardedDriver {
 public:
  explicit GuardedDriver(devices::Driver& driver)
      : driver_(driver),
        guard_(devices::guard_config(driver.description())),
        gate_(kSession),
        hold_ns_(std::llround(3e9 / driver.description().rate_hz)) {}

  devices::DeviceResult<devices::DeviceSample> read() noexcept {
    auto sample = driver_.read(100ms);
    if (sample)
      ++sequence_;
    return sample;
  }
  /// Returns the force that reached the device.
  Vec3 write(const Vec3& force, std::int64_t time_ns) noexcept {
    const auto verdict = gate_.accept(kWriter, kSession, sequence_, sequence_);
    guard_.count(verdict);
    std::optional<devices::GuardInput> command;
    if (verdict == devices::GateVerdict::kAccepted)
      command = devices::GuardInput{{force, Vec3::Zero()}, time_ns + hold_ns_};
    const Wrench passed = guard_.pass(command, time_ns);
    return driver_.write(passed) ? passed.force : Vec3::Zero();
  }
  /// No fade: zero from this period on.
  void stop() noexcept {
    guard_.stop();
    driver_.stop();
  }
  const devices::GuardCounts& counts() const noexcept { return guard_.counts(); }

 private:
  devices::Driver& driver_;
  devices::ForceGuard guard_;
  devices::CommandGate gate_;
  std::int64_t hold_ns_;
  std::uint64_t sequence_ = 0;
};

/// Empty: passed.
std::string check_by_hand(GuardedDriver& device, const DeviceRunOptions& o,
                          const std::atomic<bool>& stop,
                          const std::function<void(const std::string&)>& report) {
  id::HandCheck check(o.session.limits.box_m);
  std::size_t reported = 9;
  auto reported_state = id::HandCheck::State::kPassed;
  auto until = std::chrono::steady_clock::now();
  while (check.state() != id::HandCheck::State::kPassed) {
    if (stop.load())
      return "stopped on request";
    if (reported != check.axis() || reported_state != check.state()) {
      reported = check.axis();
      reported_state = check.state();
      until = std::chrono::steady_clock::now() +
              std::chrono::milliseconds(std::lround(1e3 * o.hand_check_s));
      report(fmt::format("Hand check (no force): move the tool along {}{} by {:.0f} mm",
                         reported_state == id::HandCheck::State::kForward ? '+' : '-',
                         kAxisLetters[reported],
                         1e3 * o.session.limits.box_m *
                             (reported_state == id::HandCheck::State::kForward ? 1 : 2)));
    }
    const auto sample = device.read();
    if (sample) {
      if (sample->pose_valid)
        check.sample(sample->pose.position);
      device.write(Vec3::Zero(), sample->time_ns);
    }
    if (check.state() == id::HandCheck::State::kWrongDirection)
      return fmt::format(
          "The encoder of axis {} counts opposite to the axis of frame D. No force was commanded; "
          "correct its sign",
          kAxisLetters[check.axis()]);
    if (std::chrono::steady_clock::now() > until)
      return fmt::format(
          "Hand check of axis {}: {:.1f} mm measured within {:.0f} s, required {:.0f} mm. No force "
          "was commanded. Check the encoder's connection and scale",
          kAxisLetters[check.axis()], 1e3 * check.farthest_m(), o.hand_check_s,
          1e3 * o.session.limits.box_m);
  }
  return {};
}

std::string step_text(const id::DeviceSession& session, double elapsed_s) {
  std::size_t left = 0;
  for (std::size_t a = session.axis() + 1; a < 3; ++a)
    ++left;
  const double remaining =
      std::max(0.0, kSecondsPerAxis - elapsed_s) + kSecondsPerAxis * static_cast<double>(left);
  return fmt::format("axis {}: {:.0f} s remain", kAxisLetters[session.axis()], remaining);
}

}  // namespace

DeviceRunResult run_identification(devices::Driver& driver, const DeviceRunOptions& o,
                                   const std::atomic<bool>& stop,
                                   const std::function<void(const std::string&)>& report) {
  const ForceOff force_off(driver);
  DeviceRunResult out;
  GuardedDriver device(driver);
  if (o.hand_check) {
    out.problem = check_by_hand(device, o, stop, report);
    if (!out.problem.empty())
      return out;
    for (int n = 3; n > 0 && !stop.load(); --n) {
      report(fmt::format("Release the tool; force begins in {} s", n));
      const auto until = std::chrono::steady_clock::now() + 1s;
      while (std::chrono::steady_clock::now() < until)
        if (const auto sample = device.read())
          device.write(Vec3::Zero(), sample->time_ns);
    }
  }
  id::DeviceSession session;
  session.start(o.session);
  std::future<id::FitResult> fit;
  int errors = 0;
  std::int64_t first_ns = -1;
  double axis_start_s = 0.0, next_report_s = 0.0;
  std::size_t axis = session.axis();
  while (!session.finished()) {
    if (stop.load()) {
      device.stop();
      out.problem = "stopped on request; the device is at zero force";
      break;
    }
    const auto sample = device.read();
    if (!sample) {
      const bool gone = sample.error() == devices::DeviceError::kDisconnected ||
                        sample.error() == devices::DeviceError::kFault;
      if (!gone && ++errors < kMostReadErrors)
        continue;
      device.stop();
      out.problem = fmt::format("The driver reported '{}'. {}", devices::name_of(sample.error()),
                                driver.last_error());
      break;
    }
    errors = 0;
    if (first_ns < 0)
      first_ns = sample->time_ns;
    const double time_s = 1e-9 * static_cast<double>(sample->time_ns - first_ns);
    const Vec3 position = sample->pose_valid ? sample->pose.position : Vec3::Constant(std::nan(""));
    const Vec3 force = session.step(time_s, position);
    if (session.finished()) {
      device.stop();
      break;
    }
    session.applied(device.write(force, sample->time_ns));
    if (session.axis() != axis) {
      axis = session.axis();
      axis_start_s = time_s;
    }
    if (!o.virtual_time && time_s >= next_report_s) {
      report(step_text(session, time_s - axis_start_s));
      next_report_s = time_s + 2.0;
    }
    if (!session.waiting())
      continue;
    if (o.virtual_time) {
      session.resume(id::fit(session.fit_input()));
    } else if (!fit.valid()) {
      fit =
          std::async(std::launch::async, [input = session.fit_input()] { return id::fit(input); });
    } else if (fit.wait_for(0s) == std::future_status::ready) {
      session.resume(fit.get());
    }
  }
  device.stop();
  if (fit.valid())
    fit.wait();
  out.outcome = session.outcome();
  for (std::size_t a = 0; a < 3; ++a) {
    if (!o.session.axes[a])
      continue;
    out.axes[a] = session.figures(a);
    if (o.with_curves && out.axes[a].outcome == id::Outcome::kMeasured) {
      const id::FitInput input = session.excitation(a).fit_input();
      out.curves[a].strokes = id::fitted_strokes(input);
      std::ranges::copy_if(input.record->entries(), std::back_inserter(out.curves[a].record),
                           [](const id::RecordEntry& e) {
                             return e.part == id::Part::kStroke || e.part == id::Part::kDenseTones;
                           });
    }
    out.encoder_step_m[a] = id::encoder_step(session.excitation(a).record());
    const id::ClockFigures clock =
        id::clock_figures(session.excitation(a).record(), o.session.limits.period_s);
    out.clock.period_s = clock.period_s;
    out.clock.jitter = std::max(out.clock.jitter, clock.jitter);
    out.clock.loss = std::max(out.clock.loss, clock.loss);
    out.clock.consecutive_losses = std::max(out.clock.consecutive_losses, clock.consecutive_losses);
  }
  out.guard_clamped = device.counts().clamped();
  return out;
}

}  // namespace voxtouch::cli
