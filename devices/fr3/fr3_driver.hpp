#pragma once
/// The Franka Research 3, or the Panda before it, as a haptic device, over the Franka Control
/// Interface.
///
/// The robot sends its state every millisecond (UDP) and takes joint torques back, on top of its
/// own compensation of gravity. What is done once goes over TCP: Connect, SetCollisionBehavior,
/// SetLoad, Move, StopMove, AutomaticErrorRecovery.
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

/// The numbers of the arm; those of deploy/devices/fr3.yaml.
DeviceDescription describe_fr3();

/// While the robot listens, every state is answered.
///
/// **Zero force takes steps.** The robot stops itself with a reflex where a joint's torque changes
/// by more than 1 Nm in a millisecond, so force begins and ends along a straight line of at most
/// 0.95 Nm a command: 8.8 N are gone in 7 ms, 60 N in 50 ms.
///
/// read: kTimeout (nothing new in time), kDisconnected (silence, or the command channel has
/// closed), kProtocol (a state that cannot be trusted, or only malformed datagrams came), kFault (a
/// reflex other than lost packets, a user stop that lasts, too many restarts). While there is no
/// torque control samples come all the same. write: kNotFinite, kLimit (check_command),
/// kRecoverable (no torque control, a joint too fast, not sent: `last_error` states it), kProtocol
/// (the sample's pose was not valid), kTimeout (no unanswered state).
///
/// Force is J^T F, geometric Jacobian of the tool, plus the posture torque. The joint torques of a
/// command that would need more than `max_add_torque_nm` are made smaller in proportion. Twist is
/// the Jacobian times the rates that the robot measures.
///
/// Time: the robot's count of milliseconds, from the first state (virtual time: from the first in
/// torque control).
class Fr3Driver : public arm::RequestReplyDriver {
 public:
  /// Connects, and waits for the first state. Throws DeviceOpenError: no connection, a version that
  /// it does not speak, a robot that a person has to see to, an arm of another geometry; the
  /// sentence says what to do. In virtual time it returns in torque control.
  explicit Fr3Driver(const Fr3Options& options);
  /// Force along its line to zero, StopMove, zero torque until the robot has left torque control
  /// (at most `stop_timeout_s`).
  ~Fr3Driver() override;

  /// The first step towards zero, now; the next states' answers go on with it.
  void stop() noexcept override;
  std::string last_error() const override;
  const arm::ArmDescription* arm_description() const noexcept override {
    return &fr3_description();
  }
  std::span<const double> joints() const noexcept override {
    return {state_.q.data(), static_cast<std::size_t>(state_.q.size())};
  }

  // For the thread that owns it.
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

  Intake judge(const arm::UdpSocket::Datagram& datagram,
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
  bool push(const Wrench& command) noexcept override;
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
  std::uint64_t steps_ms_ = 0;  // since the last state that was accepted
  std::uint32_t next_request_ = 0, move_request_ = 0;
  bool started_ = false;  // a state has been taken
  bool ending_ = false;   // commands say that the motion is to end

  /// For last_error(), which other threads ask.
  void note() noexcept;
  // Each by itself: a mixture of two moments, for a person's eye, costs nothing.
  std::atomic<fci::Errors> noted_errors_{0};
  std::atomic<fci::Diagnostic> noted_diagnostic_{fci::Diagnostic::kNone};
  std::atomic<fci::Outcome> noted_refusal_{fci::Outcome::kSuccess};
  std::atomic<bool> noted_usable_{true}, noted_closed_{false};
};

}  // namespace voxtouch::fr3
