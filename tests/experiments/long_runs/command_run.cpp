#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "core/types/clamp.hpp"
#include "devices/command_gate.hpp"
#include "devices/force_guard.hpp"
#include "devices/limits.hpp"
#include "devices/phantom/phantom_models.hpp"
#include "devices/registry.hpp"
#include "devices/sim/simulated_device.hpp"
#include "tests/experiments/long_runs/long_runs.hpp"

namespace voxtouch::long_runs {
namespace {

constexpr double kSlack = 1.0 + 1e-9;
constexpr std::int64_t kForever = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kHour = 3'600'000'000'000;

/// Numbers with random bits, including special values, and enough plausible ones that the device
/// gets a force.
class Any {
 public:
  explicit Any(std::uint64_t seed) : random_(seed) {}
  std::uint64_t bits() { return random_(); }
  bool one_in(std::uint64_t n) { return random_() % n == 0; }
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
  }
  double number() {
    constexpr double kMax = std::numeric_limits<double>::max(),
                     kInf = std::numeric_limits<double>::infinity();
    static constexpr std::array kOdd{0.0,
                                     -0.0,
                                     5e-324,
                                     -5e-324,
                                     2.2250738585072014e-308,
                                     kMax,
                                     -kMax,
                                     kInf,
                                     -kInf,
                                     1e154,
                                     -1e200,
                                     1e-200,
                                     std::numeric_limits<double>::quiet_NaN()};
    return one_in(2) ? std::bit_cast<double>(bits()) : kOdd[bits() % kOdd.size()];
  }
  Vec3 vector(double limit) {
    const std::uint64_t kind = bits() % 8;
    if (kind < 5)
      return Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) *
             limit;  // within it and somewhat over it
    if (kind < 6)
      return Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * std::exp(uniform(-700, 700));
    return {number(), number(), number()};
  }
  /// `usual` mostly; else near it, or any bits.
  std::uint64_t stamp(std::uint64_t usual) {
    const std::uint64_t kind = bits() % 32;
    return kind < 28 ? usual : kind < 30 ? usual + bits() % 7 - 3 : bits();
  }

 private:
  std::mt19937_64 random_;
};

/// Checks a driver's input independently of the guard: the limits, the slew between two writes,
/// zero once the last valid command is older than hold and fade, and a ramped start.
class Judge {
 public:
  Judge(const DeviceDescription& device, const devices::GuardConfig& guard)
      : device_(device),
        guard_(guard) {}

  /// A period of the device's clock, and the guard's permitted counts.
  void clock(std::int64_t now_ns) {
    const auto period = static_cast<std::int64_t>(std::llround(guard_.period_s * 1e9));
    step_ns_ = last_ns_ && now_ns > *last_ns_ ? gap(*last_ns_, now_ns) : period;
    age_ns_ = std::min(age_ns_ + step_ns_, kHour);
    live_ns_ = std::min(live_ns_ + step_ns_, kHour);
    last_ns_ = now_ns;
  }
  void good_command(std::int64_t valid_until_ns) {
    if (!pushing_)
      live_ns_ = 0, pushing_ = true;
    age_ns_ = 0, valid_until_ns_ = valid_until_ns;
  }
  /// After stop or a device error the device may be at zero at once.
  void zeroed() { last_ = {}, pushing_ = false, last_ns_.reset(), age_ns_ = kHour; }

  /// Empty if all checks pass.
  std::string judge(const Wrench& out) {
    if (!out.finite())
      return "what reaches the driver is not finite";
    if (!(out.force.stableNorm() <= device_.max_force_n * kSlack) ||
        length_of(out.force) > device_.max_force_n)
      return fmt::format("{} N reach the driver, {} are allowed", length_of(out.force),
                         device_.max_force_n);
    if (!(out.torque.stableNorm() <= device_.max_torque_nm * kSlack) ||
        length_of(out.torque) > device_.max_torque_nm)
      return fmt::format("{} Nm reach the driver, {} are allowed", length_of(out.torque),
                         device_.max_torque_nm);
    // A gap opens the slew by the hold time at most, but for the last step of a fade: that may end
    // at zero.
    const double dt_s = 1e-9 * static_cast<double>(step_ns_) * kSlack;
    const double slew_s = std::min(dt_s, guard_.hold_periods * guard_.period_s * kSlack);
    const double step_n = (out.force - last_.force).norm(),
                 step_nm = (out.torque - last_.torque).norm();
    const bool towards_zero =
        out.force.norm() <= last_.force.norm() && out.torque.norm() <= last_.torque.norm();
    const double most_s = towards_zero ? std::max(slew_s, dt_s) : slew_s;
    if (step_n > device_.max_force_rate_n_per_s * most_s + 1e-9)
      return fmt::format("the force changes by {} N in {} s", step_n, dt_s);
    if (step_nm > device_.max_torque_rate_nm_per_s * most_s + 1e-9)
      return fmt::format("the torque changes by {} Nm in {} s", step_nm, dt_s);
    const double silent_s =
        1e-9 * static_cast<double>(age_ns_) - guard_.hold_periods * guard_.period_s;
    const double stale_s = last_ns_ && *last_ns_ > valid_until_ns_
                               ? 1e-9 * static_cast<double>(gap(valid_until_ns_, *last_ns_))
                               : 0.0;
    if (!out.zero() && (!pushing_ || std::max(silent_s, stale_s) > guard_.fade_s * kSlack + 1e-9))
      return fmt::format(
          "{} N reach the driver {} s after the hold of the last good command, {} s after it was "
          "over",
          out.force.norm(), silent_s, stale_s);
    const double ramp_s = std::min(guard_.start_ramp_s, guard_.return_ramp_s);
    const double risen = (1e-9 * static_cast<double>(live_ns_) + guard_.period_s) / ramp_s * kSlack;
    if (out.force.norm() > device_.max_force_n * risen)
      return fmt::format("{} N reach the driver {} s after it was at zero: no ramp",
                         out.force.norm(), 1e-9 * static_cast<double>(live_ns_));
    if (std::max(silent_s, stale_s) > guard_.fade_s)
      pushing_ = false;  // from zero it ramps anew
    last_ = out;
    return {};
  }

 private:
  static std::int64_t gap(std::int64_t from, std::int64_t to) {
    return static_cast<std::int64_t>(
        std::min<std::uint64_t>(static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from),
                                static_cast<std::uint64_t>(kHour)));
  }
  const DeviceDescription& device_;
  const devices::GuardConfig& guard_;
  Wrench last_;
  std::optional<std::int64_t> last_ns_;
  std::int64_t step_ns_ = 0, age_ns_ = kHour, live_ns_ = 0, valid_until_ns_ = kForever;
  bool pushing_ = false;
};

struct Sums {
  std::uint64_t commands = 0, pushed = 0, near_limit = 0, accepted = 0, errors = 0,
                driver_refused = 0, driver_gave = 0;
  devices::GuardCounts guard;
};

/// One device described, one session after the other, each with its gate and guard.
class Attack {
 public:
  Attack(const DeviceDescription& device, const sim::SimParameters& plant, std::uint64_t seed,
         Findings& out, Sums& sums)
      : device_(device),
        config_(devices::guard_config(device)),
        any_(seed),
        guard_(config_),
        judge_(device_, config_),
        driver_(plant, plant.hand, devices::motion_of({}), seed),
        period_ns_(std::llround(1e9 * config_.period_s)),
        out_(out),
        sums_(sums) {
    begin_session();
  }

  /// False: a fault was found.
  bool step() {
    if (any_.one_in(20'000))
      begin_session();
    pass_time();
    std::optional<devices::GuardInput> newest;
    for (std::uint64_t n = any_.one_in(8) ? any_.bits() % 4 : 1; n > 0; --n)
      receive(newest);
    if (newest && newest->wrench.finite() && newest->valid_until_ns >= now_ns_)
      judge_.good_command(newest->valid_until_ns);
    const Wrench out = guard_.pass(newest, now_ns_);
    if (!require("gate and guard", judge_.judge(out)))
      return false;
    if (!devices::check_command(out, device_))
      return require("gate and guard", "the driver refuses what the guard lets pass");
    sums_.pushed += !out.zero(),
        sums_.near_limit += length_of(out.force) > 0.9 * device_.max_force_n;
    if (any_.one_in(5000))
      fail_device();
    return !any_.one_in(16) || (attack_driver() && attack_clamp());
  }
  void finish() {
    const devices::GuardCounts& c = guard_.counts();
    devices::GuardCounts& s = sums_.guard;
    s.passed += c.passed, s.refused_not_finite += c.refused_not_finite,
        s.refused_stale += c.refused_stale;
    s.refused_writer += c.refused_writer, s.refused_session += c.refused_session,
        s.refused_sequence += c.refused_sequence;
    s.clamped_force += c.clamped_force, s.clamped_torque += c.clamped_torque,
        s.clamped_slew += c.clamped_slew;
    s.faded += c.faded, s.clock_faults += c.clock_faults;
  }

 private:
  bool require(const char* where, const std::string& fault) {
    if (fault.empty())
      return true;
    out_.faults.push_back(fmt::format("{}, {}: {}", device_.model, where, fault));
    return false;
  }
  void begin_session() {
    session_ = any_.bits(), writer_ = any_.bits(), newest_ = 0, calm_ = 0, last_ = std::nullopt,
    followed_ = std::nullopt;
    gate_.emplace(session_);
    guard_.restart();
    judge_.zeroed();
  }
  /// The device's clock: mostly a period; sometimes it stops, steps back, leaps, or has random
  /// bits.
  void pass_time() {
    if (calm_ > 0)
      --calm_;
    else if (any_.one_in(10'000))
      begin_calm();
    const std::uint64_t kind = calm_ ? 4095 : any_.bits() % 4096;
    std::int64_t step = period_ns_;
    if (kind < 8)
      step = 0;
    else if (kind < 16)
      step = -static_cast<std::int64_t>(any_.bits() % 10'000'000'000);
    else if (kind < 64)
      step = static_cast<std::int64_t>(any_.bits() % 100) * period_ns_;
    else if (kind == 64)
      step = static_cast<std::int64_t>(any_.bits());
    // Unsigned: the sum may wrap.
    now_ns_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(now_ns_) +
                                        static_cast<std::uint64_t>(step));
    ++newest_;
    silent_ = calm_               ? 0
              : silent_           ? silent_ - 1
              : any_.one_in(2000) ? any_.bits() % 100
                                  : 0;  // no command for a while
    judge_.clock(now_ns_);
  }
  /// A second and a half of valid commands above the limits: the force reaches its limit and
  /// reverses there.
  void begin_calm() {
    calm_ = 1500;
    target_.force =
        Vec3(any_.uniform(-3, 3), any_.uniform(-3, 3), any_.uniform(-3, 3)) * device_.max_force_n;
    target_.torque =
        Vec3(any_.uniform(-3, 3), any_.uniform(-3, 3), any_.uniform(-3, 3)) * device_.max_torque_nm;
  }
  void receive_calm(std::optional<devices::GuardInput>& newest) {
    ++sums_.commands;
    if (gate_->accept(followed_.value_or(writer_), session_, newest_, newest_) !=
        devices::GateVerdict::kAccepted)
      return;  // answered already
    followed_ = followed_.value_or(writer_), last_ = newest_, ++sums_.accepted;
    if (any_.one_in(50))
      target_.force = -target_.force, target_.torque = -target_.torque;
    newest = devices::GuardInput{target_, any_.one_in(2)               ? kForever
                                          : now_ns_ < kForever - kHour ? now_ns_ + 5 * period_ns_
                                                                       : kForever};
  }
  void receive(std::optional<devices::GuardInput>& newest) {
    if (calm_)
      return receive_calm(newest);
    if (silent_)
      return;
    if (any_.one_in(1000))
      gate_->release_writer(), followed_.reset();
    ++sums_.commands;
    const std::uint64_t writer = any_.stamp(writer_), session = any_.stamp(session_),
                        sequence = any_.stamp(newest_);
    // An acceptance of our own, from the rule and not from the gate.
    const bool good = session == session_ && (!followed_ || *followed_ == writer) &&
                      sequence <= newest_ && (!last_ || sequence > *last_);
    const devices::GateVerdict verdict = gate_->accept(writer, session, sequence, newest_);
    guard_.count(verdict);
    if (good != (verdict == devices::GateVerdict::kAccepted))
      require("gate", fmt::format("verdict {} where it should be {}", static_cast<int>(verdict),
                                  good ? "accepted" : "refused"));
    if (verdict != devices::GateVerdict::kAccepted)
      return;
    followed_ = writer, last_ = sequence, ++sums_.accepted;
    const auto now = static_cast<std::uint64_t>(now_ns_);
    const std::uint64_t until =
        any_.one_in(4) ? any_.bits() : any_.stamp(now + static_cast<std::uint64_t>(3 * period_ns_));
    newest =
        devices::GuardInput{{any_.vector(device_.max_force_n), any_.vector(device_.max_torque_nm)},
                            static_cast<std::int64_t>(until)};
    if (any_.one_in(2) && target_.finite())
      newest->wrench = target_;  // constant for a while, so that the force reaches it
    target_ = newest->wrench;
  }
  /// As the loop does if a device gives no sample or accepts no force.
  void fail_device() {
    ++sums_.errors;
    guard_.restart();
    judge_.zeroed();
  }
  /// The driver's check, for any output of the guard.
  bool attack_driver() {
    const Wrench wrench{any_.vector(1.5 * driver_.description().max_force_n),
                        any_.vector(1.5 * driver_.description().max_torque_nm)};
    const bool within = wrench.finite() &&
                        wrench.force.stableNorm() <= driver_.description().max_force_n &&
                        wrench.torque.stableNorm() <= driver_.description().max_torque_nm;
    const bool accepted = driver_.write(wrench).has_value();
    ++(accepted ? sums_.driver_gave : sums_.driver_refused);
    if (accepted && !within &&
        !(length_of(wrench.force) <= driver_.description().max_force_n &&
          length_of(wrench.torque) <= driver_.description().max_torque_nm))
      return require("driver", fmt::format("{} N and {} Nm are taken", length_of(wrench.force),
                                           length_of(wrench.torque)));
    const Wrench& given = driver_.applied();
    if (!given.finite() || length_of(given.force) > driver_.description().max_force_n * kSlack ||
        length_of(given.torque) > driver_.description().max_torque_nm * kSlack)
      return require("driver", fmt::format("the motors give {} N and {} Nm", length_of(given.force),
                                           length_of(given.torque)));
    return true;
  }
  /// The clamp used by guard, coupling and force path: finite and within any limit for any input.
  bool attack_clamp() {
    Vec3 v = any_.vector(2.0);
    const double limit = any_.one_in(2) ? any_.uniform(0.0, 2.0) : any_.number();
    const bool was_zero = v.isZero(0.0);
    const bool cut = clamp_length(v, limit);
    const bool within_limit = v.isZero(0.0) || (limit >= 0.0 && length_of(v) <= limit);
    if (!v.allFinite() || !within_limit || (was_zero && limit >= 0.0 && cut))
      return require("clamp",
                     fmt::format("({}, {}, {}) under a limit of {}", v.x(), v.y(), v.z(), limit));
    return true;
  }

  DeviceDescription device_;
  devices::GuardConfig config_;
  Any any_;
  devices::ForceGuard guard_;
  std::optional<devices::CommandGate> gate_;
  Judge judge_;
  sim::SimulatedDevice driver_;
  std::int64_t period_ns_, now_ns_ = 0;
  std::uint64_t session_ = 0, writer_ = 0, newest_ = 0, silent_ = 0, calm_ = 0;
  std::optional<std::uint64_t> last_, followed_;
  Wrench target_;
  Findings& out_;
  Sums& sums_;
};

/// All devices that are shipped: the registry's, and every Phantom model with separate figures.
std::vector<DeviceDescription> shipped_descriptions() {
  std::vector<DeviceDescription> all;
  for (const std::string& name : devices::device_names()) {
    all.push_back(devices::describe_device(name));
    all.back().model = name;
  }
  for (const char* model :
       {"PHANTOM Premium 1.0", "PHANTOM Premium 1.5", "PHANTOM Premium 1.5 High Force",
        "PHANTOM Premium 3.0", "PHANTOM Desktop", "PHANTOM Omni", "Touch", "of another kind"}) {
    phantom::PhantomFacts facts;
    facts.model = model;
    all.push_back(phantom::describe_phantom(facts));
    all.back().model = model;
  }
  return all;
}

/// A run that lacks an event has not tested it.
void require_all_happened(const Sums& s, Findings& out) {
  const devices::GuardCounts& g = s.guard;
  const auto some = [&](const char* what, std::uint64_t count) {
    if (count == 0)
      out.faults.push_back(fmt::format("the run shows nothing of this: {}", what));
  };
  some("forces that reach the driver", s.pushed), some("forces near the limit", s.near_limit);
  some("commands that are not finite", g.refused_not_finite),
      some("commands that were over", g.refused_stale);
  some("foreign writers", g.refused_writer), some("foreign sessions", g.refused_session),
      some("old or future answers", g.refused_sequence);
  some("forces over the limit", g.clamped_force), some("torques over the limit", g.clamped_torque),
      some("steps cut by the slew limit", g.clamped_slew);
  some("fades", g.faded), some("clocks that stand or go back", g.clock_faults),
      some("device errors", s.errors);
  some("commands that the driver refuses", s.driver_refused),
      some("commands that the driver takes", s.driver_gave);
}

}  // namespace

Findings run_commands(const CommandRunOptions& ask, const Progress& progress) {
  Findings out;
  Sums sums;
  const std::vector<DeviceDescription> devices = shipped_descriptions();
  std::uint64_t played = 0;
  for (std::size_t n = 0; n < devices.size() && out.faults.empty(); ++n) {
    const sim::SimParameters plant =
        devices[n].max_torque_nm > 0.0 ? sim::sim_lwr() : sim::sim_phantom();
    Attack attack(devices[n], plant, ask.seed + n, out, sums);
    const std::uint64_t steps =
        ask.commands / devices.size() + (n == 0 ? ask.commands % devices.size() : 0);
    for (std::uint64_t step = 0; step < steps; ++step) {
      ++played;
      if (!attack.step() || !out.faults.empty()) {
        out.faults.push_back(
            fmt::format("in step {} of {} with seed {}", step, devices[n].model, ask.seed));
        break;
      }
      if (progress && played % 65'536 == 0)
        progress(played, ask.commands);
    }
    attack.finish();
  }
  const devices::GuardCounts& g = sums.guard;
  out.lines.push_back(fmt::format(
      "figure: {} commands in {} periods of {} device descriptions: {} let in by the gate, {} "
      "periods with force, {} of these over 90 % of the limit",
      sums.commands, played, devices.size(), sums.accepted, sums.pushed, sums.near_limit));
  out.lines.push_back(
      fmt::format("refused: {} not finite, {} over, {} of foreign writers, {} of foreign sessions, "
                  "{} old or future",
                  g.refused_not_finite, g.refused_stale, g.refused_writer, g.refused_session,
                  g.refused_sequence));
  out.lines.push_back(fmt::format(
      "cut: {} forces, {} torques, {} steps; {} fades, {} clock faults, {} device errors",
      g.clamped_force, g.clamped_torque, g.clamped_slew, g.faded, g.clock_faults, sums.errors));
  out.lines.push_back(fmt::format("straight at the driver: {} refused, {} taken",
                                  sums.driver_refused, sums.driver_gave));
  if (out.faults.empty() && ask.commands >= 500'000)
    require_all_happened(sums, out);
  return out;
}

}  // namespace voxtouch::long_runs
