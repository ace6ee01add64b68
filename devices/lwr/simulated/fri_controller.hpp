#pragma once
/// The simulated robot controller with its arm and operator; everything except the network.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>

#include "devices/arm/simulated/simulated_arm.hpp"
#include "devices/lwr/fri_codec.hpp"
#include "devices/lwr/simulated/command_path.hpp"
#include "devices/lwr/simulated/krl_script.hpp"
#include "devices/lwr/simulated/link_quality.hpp"
#include "devices/lwr/simulated/lwr_plant.hpp"
#include "devices/lwr/simulated/safety.hpp"

namespace voxtouch::lwr_sim {

using arm_sim::Fault, arm_sim::FaultKind, arm_sim::FaultSchedule, arm_sim::kSubstep, arm_sim::kTick;
inline constexpr arm_sim::ControllerFaults kFaults{
    "loss answer_loss late jitter reorder duplicate nan drives_off drive_error estop quality "
    "silent",
    8.0};

struct ControllerConfig : arm_sim::ArmConfig {
  ControllerConfig() {
    plant = lwr_plant();
    start_rad = lwr::lwr_rest_posture();
  }
  double period_s = 0.001;     ///< argument of friOpen: 1 to 100 ms, integer milliseconds
  double safety_limits = 1.0;  ///< argument of friStart: fraction of the joints' speed, in (0, 1]
  SafetyRules safety;
  double torque_noise_nm = 0.05;  ///< standard deviation of each torque sensor; assumed
  /// Stiffness and damping of a command without their flags, as in published programs.
  lwr::LwrJoints krl_stiffness_nm_per_rad = lwr::LwrJoints::Constant(1000.0);
  double krl_damping = 0.7;
  double script_pause_s = 0.05;             ///< of the KRL program's loop, as in a published one
  bool first_start_keeps_strategy = false;  ///< see KrlScript
  bool virtual_time = false;                ///< announced in $FRI_TO_INT[16]

  /// Throws std::runtime_error that names field and rule.
  void validate() const;
};

/// Received datagrams by result.
struct AnswerCounts {
  std::uint64_t accepted = 0;                        ///< in time
  std::uint64_t length = 0, id = 0, size_field = 0;  ///< not a command packet
  std::uint64_t not_finite = 0;
  std::uint64_t stale = 0;  ///< does not reply to the last measurement
  /// Replies to it again with a newer count: accepted in place of the previous one.
  std::uint64_t replaced = 0;
  std::uint64_t doubled = 0;  ///< replies to it again with the same or an older count
};

/// A change of the state.
struct Event {
  double time_s = 0.0;
  lwr::fri::State from = lwr::fri::State::kMon, to = lwr::fri::State::kMon;
  Violation why;
};

/// One row of the trace; base axes.
struct TraceRow {
  double time_s = 0.0;
  lwr::fri::State state = lwr::fri::State::kMon;
  lwr::fri::Quality quality = lwr::fri::Quality::kUnacceptable;
  bool braked = false;
  Vec3 tip_m = Vec3::Zero(), velocity_m_s = Vec3::Zero();
  /// Force of the drives at the tool in addition to carrying the arm; zero while brakes hold it.
  Wrench applied;
  Wrench hand;                   ///< of the operator on the tool
  Vec3 target_m = Vec3::Zero();  ///< goal of the hand
};

/// One period: `measure`, any number of `receive`, `advance`. A reply received in between acts from
/// the next period on. Time is a count of periods without a clock, so equal seeds and replies give
/// bit-identical results. The state is OFF until the first measurement and after `close`. Real-time
/// safe after construction.
class FriController final : public arm_sim::SimulatedArm {
 public:
  /// Throws std::runtime_error for a configuration, hand or motion that cannot be simulated.
  FriController(const ControllerConfig& config, hand::Hand hand,
                FaultSchedule faults = FaultSchedule());

  /// The measurement at the start of this period.
  const lwr::fri::MsrPacket& measure() noexcept;
  enum class Verdict : std::uint8_t {
    kAccepted,
    kLength,
    kId,
    kSizeField,
    kNotFinite,
    kStale,
    kReplaced,
    kDoubled
  };
  /// Processes a datagram of this period, `latency_s` after its measurement was sent.
  Verdict receive(std::span<const std::byte> datagram, double latency_s) noexcept;
  /// Advances by one period; then checks the reply or its absence, motion and link.
  void advance() noexcept;
  /// friStop and friClose: returns the final measurement. Brakes close.
  const lwr::fri::MsrPacket& close() noexcept;

  double time_s() const noexcept { return static_cast<double>(period_) * config_.period_s; }
  std::uint64_t periods() const noexcept { return period_; }
  lwr::fri::State state() const noexcept { return state_; }
  lwr::fri::Quality quality() const noexcept;
  bool braked() const noexcept { return braked_; }
  const AnswerCounts& counts() const noexcept { return counts_; }
  const LinkQuality& link() const noexcept { return link_; }
  const ControllerConfig& config() const noexcept { return config_; }
  std::uint64_t starts() const noexcept { return starts_; }
  std::uint64_t drops() const noexcept { return drops_; }  ///< times command mode ended by itself
  TraceRow row() const noexcept;
  /// Events since the last call, oldest first, including refused starts (from == to).
  std::optional<Event> take_event() noexcept;

 private:
  void watch_power() noexcept;
  void tick() noexcept;
  lwr::LwrJoints law(const Setpoint& now, const lwr::LwrJoints& torque) const noexcept;
  void apply_answer() noexcept;
  void judge_answer() noexcept;
  void judge_motion() noexcept;
  void run_script() noexcept;
  void start() noexcept;
  void leave(const Violation& why) noexcept;
  Setpoint setpoint_of(const lwr::fri::Command& command) const noexcept;
  Setpoint resting() const noexcept;
  void command_here() noexcept;
  void note(lwr::fri::State from, const Violation& why) noexcept;
  void fill_interface() noexcept;
  void fill_robot() noexcept;
  void fill_measured(const ArmDynamics::Terms& terms) noexcept;
  double noise() noexcept;

  ControllerConfig config_;
  int ticks_;
  LinkQuality link_;
  KrlScript script_;
  CommandPath path_;
  Impedance impedance_;
  std::mt19937_64 random_;

  std::uint64_t period_ = 0, starts_ = 0, drops_ = 0;
  lwr::fri::State state_ = lwr::fri::State::kOff;
  bool braked_ = false;
  std::uint16_t error_ = 0, broken_ = 0, warning_ = 0, power_ = lwr::fri::kAllDrives;
  lwr::LwrJoints commanded_rad_;  // the KRL side's commanded position

  lwr::fri::MsrPacket msr_;
  lwr::fri::CmdPacket answer_{}, pending_{};
  bool pending_valid_ = false, pending_not_finite_ = false, answered_once_ = false;
  double pending_latency_s_ = 0.0;
  std::uint32_t flags_ = 0;  // of command mode
  int periods_since_answer_ = 1;
  AnswerCounts counts_;
  std::array<Event, 32> events_{};
  std::size_t first_event_ = 0, event_count_ = 0;
};

}  // namespace voxtouch::lwr_sim
