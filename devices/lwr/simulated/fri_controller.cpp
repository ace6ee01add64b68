#include "devices/lwr/simulated/fri_controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace voxtouch::lwr_sim {
namespace {

using arm_sim::require;
using lwr::fri::Control;
using lwr::fri::State;

const ControllerConfig& checked(const ControllerConfig& config) {
  config.validate();
  return config;
}

int ticks_of(double period_s) { return static_cast<int>(std::lround(period_s / kTick)); }

}  // namespace

void ControllerConfig::validate() const {
  ArmConfig::validate();
  const int ticks = ticks_of(period_s);
  require(ticks >= 1 && ticks <= 100 && std::abs(period_s - ticks * kTick) < 1e-9, "period_s",
          "1 to 100 ms (integer)");
  require(torque_noise_nm >= 0.0 && torque_noise_nm < 100.0, "torque_noise_nm", "in [0, 100)");
}

FriController::FriController(const ControllerConfig& config, hand::Hand hand, FaultSchedule faults)
    : SimulatedArm(checked(config), std::move(hand), std::move(faults)),
      config_(config),
      ticks_(ticks_of(config.period_s)),
      script_(config.script_pause_s, config.first_start_keeps_strategy),
      path_(ticks_),
      impedance_(config.laws),
      random_(config.seed),
      commanded_rad_(config.start_rad),
      msr_(lwr::fri::empty_msr()) {
  config_.safety.max_speed_rad_s *= config.safety_limits;
  path_.start(resting());
}

double FriController::noise() noexcept {
  return config_.torque_noise_nm == 0.0 ? 0.0 : config_.torque_noise_nm * sim::near_normal(random_);
}

lwr::fri::Quality FriController::quality() const noexcept {
  const auto most = faults_.active(FaultKind::kQuality, time_s());
  return most ? std::min(link_.quality(), static_cast<lwr::fri::Quality>(static_cast<int>(*most)))
              : link_.quality();
}

Setpoint FriController::resting() const noexcept {
  Setpoint s;
  s.position = commanded_rad_;
  s.stiffness = config_.krl_stiffness_nm_per_rad;
  s.damping.setConstant(config_.krl_damping);
  return s;
}

/// Fields without a flag come from the KRL side.
Setpoint FriController::setpoint_of(const lwr::fri::Command& c) const noexcept {
  Setpoint s = resting();
  const auto has = [&](std::uint32_t flag) { return (c.cmd_flags & flag) != 0; };
  if (has(lwr::fri::kFlagJntPos))
    s.position = lwr::fri::from_wire(c.jnt_pos);
  if (has(lwr::fri::kFlagJntTrq))
    s.torque = lwr::fri::from_wire(c.add_jnt_trq);
  if (has(lwr::fri::kFlagJntStiff))
    s.stiffness = lwr::fri::from_wire(c.jnt_stiffness);
  if (has(lwr::fri::kFlagJntDamp))
    s.damping = lwr::fri::from_wire(c.jnt_damping);
  return s;
}

void FriController::note(State from, const Violation& why) noexcept {
  if (event_count_ == events_.size()) {
    first_event_ = (first_event_ + 1) % events_.size();
    --event_count_;
  }
  events_[(first_event_ + event_count_++) % events_.size()] = {time_s(), from, state_, why};
}

std::optional<Event> FriController::take_event() noexcept {
  if (event_count_ == 0)
    return std::nullopt;
  const Event event = events_[first_event_];
  first_event_ = (first_event_ + 1) % events_.size();
  --event_count_;
  return event;
}

void FriController::command_here() noexcept {
  commanded_rad_ = plant_.q();
  drop_torque();
  drive_.setZero();
  path_.start(resting());
}

/// Ends command mode. Unless requested, the brakes close. A violation sets error bits; a bad link
/// sets warning bits, since it is not an error of a drive.
void FriController::leave(const Violation& why) noexcept {
  const State from = std::exchange(state_, State::kMon);
  command_here();
  note(from, why);
  if (why.reason == Reason::kAsked)
    return;
  ++drops_;
  braked_ = true;
  const bool link = why.reason == Reason::kMisses || why.reason == Reason::kQualityForced;
  const bool power = why.reason == Reason::kEmergencyStop || why.reason == Reason::kDrivesOff;
  const std::uint16_t bits = why.joints ? why.joints : lwr::fri::kAllDrives;
  if (link)
    warning_ = bits;
  else if (!power)
    error_ = bits;
}

/// Updates emergency stop and drives by the schedule. Power returns by itself; the brakes stay
/// closed until the next start.
void FriController::watch_power() noexcept {
  const double now = time_s();
  const bool stop = faults_.active(FaultKind::kEmergencyStop, now).has_value();
  const auto off =
      static_cast<std::uint16_t>(faults_.active(FaultKind::kDrivesOff, now).value_or(0.0));
  broken_ = static_cast<std::uint16_t>(faults_.active(FaultKind::kDriveError, now).value_or(0.0));
  const bool was_on = power_ == lwr::fri::kAllDrives;
  power_ = static_cast<std::uint16_t>(stop ? 0U : lwr::fri::kAllDrives & ~(off | broken_));
  if (power_ == lwr::fri::kAllDrives || !was_on)
    return;
  const Violation why{stop ? Reason::kEmergencyStop : Reason::kDrivesOff,
                      static_cast<std::uint16_t>(~power_ & lwr::fri::kAllDrives)};
  if (state_ == State::kCmd) {
    leave(why);
  } else {
    command_here();
    braked_ = true;
    note(state_, why);
  }
}

const lwr::fri::MsrPacket& FriController::measure() noexcept {
  if (state_ == State::kOff) {
    state_ = State::kMon;
    note(State::kOff, {});
  }
  watch_power();
  ++msr_.header.send_seq;
  pending_valid_ = pending_not_finite_ = false;
  fill_interface();
  fill_robot();
  fill_measured(plant_.terms());
  if (const auto joint = faults_.active(FaultKind::kNan, time_s())) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    if (*joint >= 8.0)
      msr_.interface.timestamp_s = none;
    else
      msr_.data.jnt_pos[static_cast<std::size_t>(*joint) - 1] = none;
  }
  return msr_;
}

FriController::Verdict FriController::receive(std::span<const std::byte> datagram,
                                              double latency_s) noexcept {
  lwr::fri::CmdPacket packet{};
  const lwr::fri::PacketFault fault = lwr::fri::decode(datagram, packet);
  if (fault == lwr::fri::PacketFault::kLength)
    return ++counts_.length, Verdict::kLength;
  if (fault == lwr::fri::PacketFault::kId)
    return ++counts_.id, Verdict::kId;
  if (fault == lwr::fri::PacketFault::kSizeField)
    return ++counts_.size_field, Verdict::kSizeField;
  if (packet.header.refl_seq != msr_.header.send_seq)
    return ++counts_.stale, Verdict::kStale;
  const bool again = pending_valid_ || pending_not_finite_;
  if (again && lwr::fri::sequence_distance(pending_.header.send_seq, packet.header.send_seq) <= 0)
    return ++counts_.doubled, Verdict::kDoubled;
  pending_ = packet;
  pending_latency_s_ = latency_s;
  pending_valid_ = fault == lwr::fri::PacketFault::kNone;
  pending_not_finite_ = !pending_valid_;
  if (pending_not_finite_)
    return ++counts_.not_finite, Verdict::kNotFinite;
  return again ? (++counts_.replaced, Verdict::kReplaced)
               : (++counts_.accepted, Verdict::kAccepted);
}

lwr::LwrJoints FriController::law(const Setpoint& now,
                                  const lwr::LwrJoints& torque) const noexcept {
  const ArmDynamics::Terms terms = plant_.terms();
  if (state_ != State::kCmd)
    return position_law(config_.laws, terms, plant_.q(), plant_.rate(), commanded_rad_);
  if (script_.control() == Control::kPosition)
    return position_law(config_.laws, terms, plant_.q(), plant_.rate(), now.position);
  return impedance_.torque(terms, plant_.q(), plant_.rate(), now) + torque;
}

void FriController::tick() noexcept {
  const Setpoint now = path_.tick();
  if (state_ == State::kCmd)
    impedance_.prepare(plant_.terms(), now);
  SimulatedArm::tick(now.torque, state_ == State::kCmd, braked_,
                     [&](const lwr::LwrJoints& torque) { return law(now, torque); });
}

void FriController::advance() noexcept {
  for (int i = 0; i < ticks_; ++i)
    tick();
  ++period_;
  apply_answer();
  judge_motion();
  run_script();
}

void FriController::apply_answer() noexcept {
  if (!pending_valid_) {
    if (answered_once_ || pending_not_finite_)
      link_.missed();
    ++periods_since_answer_;
    if (state_ == State::kCmd && pending_not_finite_)
      leave({Reason::kNotFinite, 0});
    else if (state_ == State::kCmd)
      path_.miss();
    return;
  }
  link_.answered(pending_latency_s_);
  answered_once_ = true;
  msr_.header.refl_seq = pending_.header.send_seq;
  answer_ = pending_;
  if (state_ == State::kCmd)
    judge_answer();
  periods_since_answer_ = 1;
}

void FriController::judge_answer() noexcept {
  if (answer_.command.cmd_flags != flags_)
    return leave({Reason::kFlagsChanged, 0});
  const Setpoint requested = setpoint_of(answer_.command);
  // Replacements of missing replies moved the goal, so the time is that since the last goal.
  const double elapsed_s = periods_since_answer_ * config_.period_s;
  if (const Violation why =
          check_command(config_.safety, path_.goal(), requested, elapsed_s, plant_.q()))
    return leave(why);
  path_.answer(requested);
}

void FriController::judge_motion() noexcept {
  if (state_ != State::kCmd)
    return;
  if (const Violation why = check_motion(config_.safety, plant_.rate()))
    return leave(why);
  if (link_.quality() <= lwr::fri::Quality::kBad)
    return leave({Reason::kMisses, 0});
  if (quality() <= lwr::fri::Quality::kBad)
    leave({Reason::kQualityForced, 0});
}

void FriController::run_script() noexcept {
  const KrlScript::Input input{
      answer_.krl.integer[lwr::fri::kFrmIntStrategy],
      answered_once_ ? answer_.krl.integer[lwr::fri::kFrmIntRun] : lwr::fri::kHalt, state_,
      quality()};
  switch (script_.step(input, config_.period_s)) {
    case KrlScript::Request::kNone:
      break;
    case KrlScript::Request::kStop:
      if (state_ == State::kCmd)
        leave({Reason::kAsked, 0});
      error_ = warning_ = 0;
      break;
    case KrlScript::Request::kAcknowledge:
      error_ = warning_ = 0;
      break;
    case KrlScript::Request::kStart:
      start();
      break;
  }
}

void FriController::start() noexcept {
  if (power_ != lwr::fri::kAllDrives)
    return note(state_, {Reason::kDrivesOff, 0});
  const lwr::LwrJoints mirrored = lwr::fri::from_wire(answer_.command.jnt_pos);
  if (const Violation why = check_entry(config_.safety, mirrored, commanded_rad_)) {
    error_ = why.joints ? why.joints : lwr::fri::kAllDrives;
    return note(state_, why);
  }
  const State from = std::exchange(state_, State::kCmd);
  ++starts_;
  script_.started();
  braked_ = false;
  error_ = warning_ = 0;
  flags_ = answer_.command.cmd_flags;
  hand_holds_ = true;
  drop_torque();
  path_.start(resting());
  note(from, {});
}

const lwr::fri::MsrPacket& FriController::close() noexcept {
  const State from = std::exchange(state_, State::kOff);
  command_here();
  braked_ = true;
  note(from, {Reason::kClosed, 0});
  ++msr_.header.send_seq;
  fill_interface();
  fill_robot();
  fill_measured(plant_.terms());
  return msr_;
}

void FriController::fill_interface() noexcept {
  msr_.krl.integer[lwr::fri::kToIntEcho] = script_.echo();
  msr_.krl.integer[lwr::fri::kToIntSimulated] = config_.virtual_time ? lwr::fri::kVirtualTime : 0;
  lwr::fri::Interface& i = msr_.interface;
  i.timestamp_s = static_cast<float>(time_s());
  i.state = state_;
  i.quality = quality();
  i.msr_period_s = i.cmd_period_s = static_cast<float>(config_.period_s);
  i.safety_limits = static_cast<float>(config_.safety_limits);
  i.statistics = link_.statistics();
}

void FriController::fill_robot() noexcept {
  lwr::fri::Robot& r = msr_.robot;
  r.power = power_;
  r.control = script_.control();
  r.error = static_cast<std::uint16_t>(error_ | broken_);
  r.warning = warning_;
  r.temperature.fill(30.0F);
}

void FriController::fill_measured(const ArmDynamics::Terms& terms) noexcept {
  lwr::fri::Measured& d = msr_.data;
  const lwr::LwrJoints q = measured_rad();
  const ArmDynamics& dynamics = plant_.dynamics();
  d.jnt_pos = lwr::fri::to_wire(q);
  d.cart_pos = lwr::fri::to_wire(dynamics.at(q, lwr::LwrJoints::Zero()).tool);
  const lwr::LwrJoints goal = state_ == State::kCmd ? path_.goal().position : commanded_rad_;
  const Pose commanded_pose = dynamics.at(commanded_rad_, lwr::LwrJoints::Zero()).tool;
  d.cmd_jnt_pos = lwr::fri::to_wire(commanded_rad_);
  d.cmd_jnt_pos_fri_offset = lwr::fri::to_wire(lwr::LwrJoints(goal - commanded_rad_));
  d.cmd_cart_pos = lwr::fri::to_wire(commanded_pose);
  d.cmd_cart_pos_fri_offset = lwr::fri::to_wire(Pose{});
  const Mat3 axes = task_axes(config_.laws, terms);
  const Wrench& hand = plant_.hand_wrench();
  const lwr::LwrJoints outer = lwr::joint_torque(terms.jacobian, hand);
  for (int i = 0; i < 7; ++i) {
    const double error = noise();  // one sensor, one error: it appears in both
    d.jnt_trq[static_cast<std::size_t>(i)] = static_cast<float>(plant_.sensed_torque()[i] + error);
    d.est_ext_jnt_trq[static_cast<std::size_t>(i)] = static_cast<float>(outer[i] + error);
  }
  Vec6 wrench;
  wrench << axes.transpose() * hand.force, axes.transpose() * hand.torque;
  d.est_ext_tcp_ft = lwr::fri::to_wire(wrench);
  d.jacobian = lwr::fri::to_wire(in_axes(axes, terms.jacobian));
  Eigen::Map<Eigen::Matrix<float, 7, 7, Eigen::RowMajor>>(d.mass_matrix.data()) =
      terms.mass.cast<float>();
  d.gravity = lwr::fri::to_wire(terms.gravity);
}

TraceRow FriController::row() const noexcept {
  const ArmDynamics::Terms terms = plant_.terms();
  TraceRow row;
  row.time_s = time_s();
  row.state = state_;
  row.quality = quality();
  row.braked = braked_;
  row.tip_m = terms.tool.position;
  row.velocity_m_s = terms.twist.linear;
  if (!braked_)
    row.applied = tool_wrench(terms, drive_);
  row.hand = plant_.hand_wrench();
  row.target_m = hand_.target();
  return row;
}

}  // namespace voxtouch::lwr_sim
