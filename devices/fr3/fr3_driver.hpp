#pragma once
/// Driver of the Franka Research 3, or the Panda, as a haptic device over the Franka Control
/// Interface.
///
/// The robot sends its state every millisecond (UDP) and receives joint torques, which it adds to
/// its own gravity compensation. Requests use TCP: Connect, SetCollisionBehavior, SetLoad, Move,
/// StopMove, AutomaticErrorRecovery.
#include <atomic>
#include <memory>
#include <string>

#include "devices/arm/request_reply_driver.hpp"
#include "devices/fr3/fci_link.hpp"
#include "devices/fr3/fci_session.hpp"
#include "devices/fr3/fr3_arm.hpp"
#include "devices/fr3/fr3_options.hpp"
#include "devices/fr3/torque_ramp.hpp"

namespace voxtouch::fr3 {

/// Description of the arm, equal to deploy/devices/fr3.yaml.
DeviceDescription describe_fr3();

/// Driver of the arm. While the robot expects commands, every state is answered.
///
/// **Zero force takes several steps.** The robot stops itself with a reflex if the torque of a
/// joint changes by more than 1 Nm in a millisecond. Force therefore begins and ends along a
/// straight line of at most 0.95 Nm per command: 8.8 N take 7 ms, 60 N take 50 ms.
///
/// Errors of `read`: kTimeout (no new state in time), kDisconnected (silence, or the command
/// channel was closed), kProtocol (an invalid state, or only malformed datagrams), kFault (a reflex
/// other than lost packets, a lasting user stop, too many restarts). Samples continue without
/// torque control.
///
/// Errors of `write`: kNotFinite, kLimit (check_command), kRecoverable (no torque control, a joint
/// too fast, not sent; `last_error` gives the reason), kProtocol (the pose of the sample was
/// invalid), kTimeout (no unanswered state).
///
/// Force is J^T F, with the geometric Jacobian of the tool, plus the posture torque. Joint torques
/// of a command beyond `max_add_torque_nm` are scaled down in proportion. The twist is the Jacobian
/// times the joint rates measured by the robot.
///
/// Time: the robot's count of milliseconds, from the first state (virtual time: from the first in
/// torque control).
class Fr3Driver : public arm::RequestReplyDriver {
 public:
  /// Connects, and waits for the first state. Throws DeviceOpenError, with a remedy: no connection,
  /// an unsupported version, a robot that requires the operator, an arm of another geometry. In
  /// virtual time it returns in torque control.
  explicit Fr3Driver(const Fr3Options& options);
  /// Ramps the force to zero, sends StopMove, and sends zero torque until the robot has left torque
  /// control (at most `stop_timeout_s`).
  ~Fr3Driver() override;

  /// Makes the first step towards zero at once; the replies to the next states continue it.
  void stop() noexcept override;
  std::string last_error() const override;
  const arm::ArmDescription* arm_description() const noexcept override {
    return &fr3_description();
  }
  std::span<const double> joints() const noexcept override {
    return {state_.q.data(), static_cast<std::size_t>(state_.q.size())};
  }

  // For the owning thread.
  const fci::FciSession& session() const noexcept { return session_; }
  const fci::State& state() const noexcept { return state_; }
  std::uint16_t version() const noexcept { return dialect_->version; }

 private:
  struct Connected {
    std::unique_ptr<FciLink> link;
    std::unique_ptr<arm::UdpSocket> socket;
    const fci::Dialect* dialect;
  };
  static Connected connect(const Fr3Options& options);
  explicit Fr3Driver(const Fr3Options& options, Connected connected);
  void set_up();
  void first_state();
  void compare_geometry() const;
  void start_in_virtual_time();
  void disengage() noexcept;
  fci::Received answer_to(const fci::Message& message, fci::Request request);

  Intake classify(const arm::UdpSocket::Datagram& datagram,
                  std::span<const std::byte> bytes) noexcept override;
  void keep(Intake intake) noexcept override {
    if (intake == Intake::kNew)
      state_ = incoming_;
  }
  void reply_to_invalid() noexcept override;
  void accept() noexcept override;
  void received_nothing(bool lost) noexcept override;
  bool closed() const noexcept override { return link_->closed(); }
  bool force_allowed() const noexcept override {
    return session_.force_allowed() && !link_->closed();
  }
  devices::DeviceError error() const noexcept override { return session_.error(); }
  bool reply_with(const Wrench& command) noexcept override;
  void reply_without_force() noexcept override;
  void measure() noexcept;
  void receive_channel() noexcept;
  void receive(const fci::Received& received) noexcept;
  void ask_what_is_due() noexcept;
  Wrench within_joints(Wrench command) noexcept;
  bool send(const Joints& torque) noexcept;

  Fr3Options options_;
  std::unique_ptr<FciLink> link_;
  const fci::Dialect* dialect_;
  Fr3Arm arm_;
  Fr3Limits limits_;
  fci::FciSession session_;
  TorqueRamp ramp_;

  fci::State incoming_, state_;
  Fr3Arm::State posture_{};
  std::uint64_t newest_id_ = 0, first_id_ = 0;
  std::uint64_t steps_ms_ = 0;  // since the last accepted state
  std::uint32_t next_request_ = 0, move_request_ = 0;
  bool started_ = false;  // a state has been taken
  bool ending_ = false;   // commands request the end of the motion

  /// For last_error(), which other threads call.
  void note() noexcept;
  // Stored individually: values of two different moments are acceptable in a message.
  std::atomic<fci::Errors> noted_errors_{0};
  std::atomic<fci::Diagnostic> noted_diagnostic_{fci::Diagnostic::kNone};
  std::atomic<fci::Outcome> noted_refusal_{fci::Outcome::kSuccess};
  std::atomic<bool> noted_usable_{true}, noted_closed_{false};
};

}  // namespace voxtouch::fr3
