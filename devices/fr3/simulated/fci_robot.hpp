#pragma once
/// The simulated robot: arm, controller and operator; everything except the network.
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "devices/arm/simulated/simulated_arm.hpp"
#include "devices/fr3/fci_codec.hpp"
#include "devices/fr3/simulated/fr3_plant.hpp"

namespace voxtouch::fr3_sim {

using arm_sim::Fault, arm_sim::FaultKind, arm_sim::FaultSchedule, arm_sim::kSubstep, arm_sim::kTick;
inline constexpr arm_sim::ControllerFaults kFaults{
    "loss answer_loss late jitter reorder duplicate nan user_stop guiding reflex not_ready silent "
    "closed",
    7.0};

/// Limits at which the robot stops itself.
struct Limits {
  arm::Joints torque_nm = (arm::Joints() << 87, 87, 87, 87, 12, 12, 12).finished();
  arm::Joints speed_rad_s = fr3_speed_limit();
  double torque_step_nm = 1.0;  ///< between two commands: 1000 Nm/s
  int consecutive_losses = 20;  ///< commands, as in the manufacturer's manual
};

struct RobotConfig : arm_sim::ArmConfig {
  RobotConfig() {
    plant = fr3_plant();
    start_rad = fr3::fr3_rest_posture();
    torque_lag_s = 0.0027;  // 60 Hz
    angle_resolution_rad = 1e-5;
  }
  std::uint16_t version = fr3::fci::kNewestVersion;  ///< of the server
  Vec3 ee_in_flange = Vec3::Zero();
  Limits limits;

  /// Throws std::runtime_error that names field and rule.
  void validate() const;
};

struct RobotCounts {
  std::uint64_t commands = 0;  ///< accepted, in time
  std::uint64_t missed = 0;    ///< milliseconds of a motion without a command
  std::uint64_t length = 0, stale = 0, not_finite = 0, idle = 0;
  std::uint64_t motions = 0, reflexes = 0;
};

/// One millisecond: `measure`, any number of `receive`, `advance`. A command received in between
/// acts from the next millisecond on; without one the last continues. Time is a count: equal seeds
/// and calls give bit-identical results. Real-time safe after construction.
class FciRobot final : public arm_sim::SimulatedArm {
 public:
  /// Throws std::runtime_error for a configuration, hand or motion that cannot be simulated.
  FciRobot(const RobotConfig& config, hand::Hand hand, FaultSchedule faults = FaultSchedule());

  /// The state at the start of this millisecond.
  const fr3::fci::State& measure() noexcept;
  void receive(std::span<const std::byte> datagram) noexcept;
  void advance() noexcept;

  /// Processes a request of the command channel and returns the reply.
  fr3::fci::Outcome request(fr3::fci::Request request, const fr3::fci::Received& body) noexcept;
  /// The end of the motion since the last call, for the reply to Move.
  std::optional<fr3::fci::Outcome> motion_ended() noexcept;
  /// The client has disconnected: a motion ends.
  void abandoned() noexcept;

  double time_s() const noexcept { return static_cast<double>(ticks_) * kTick; }
  const fr3::fci::Dialect& dialect() const noexcept { return *dialect_; }
  fr3::fci::RobotMode mode() const noexcept { return state_.mode; }
  bool in_motion() const noexcept { return state_.mode == fr3::fci::RobotMode::kMove; }
  const RobotCounts& counts() const noexcept { return counts_; }
  const RobotConfig& config() const noexcept { return config_; }
  /// Force and torque of the drives at the tool, in addition to carrying and holding the arm, over
  /// the last millisecond, in the base.
  Wrench applied() const noexcept;

 private:
  void watch_people() noexcept;
  void take_command() noexcept;
  void judge_motion() noexcept;
  void reflex(fr3::fci::Errors errors) noexcept;
  void leave(fr3::fci::RobotMode to, fr3::fci::Outcome how) noexcept;
  void tick() noexcept;

  RobotConfig config_;
  const fr3::fci::Dialect* dialect_;
  std::uint64_t ticks_ = 0;
  fr3::fci::State state_;
  arm::Joints held_rad_;  // position that the robot's controller keeps
  arm::Joints commanded_ = arm::Joints::Zero();
  // Last torque that gave force over the last millisecond.
  arm::Joints measured_ = arm::Joints::Zero();
  std::optional<fr3::fci::Command> pending_;
  bool not_finite_ = false;
  bool armed_ = false;  // the remote side has begun to reply
  bool reflex_done_ = false;
  int consecutive_losses_ = 0;
  std::array<bool, 100> window_{};  // the last milliseconds of a motion: answered in time
  double worst_hand_n_ = 20.0;      // allowed by SetCollisionBehavior; assumed until then
  std::optional<fr3::fci::Outcome> ended_;
  RobotCounts counts_;
};

}  // namespace voxtouch::fr3_sim
