#pragma once
/// The Franka Research 3, or the Panda before it, as a haptic device, over the Franka Control Interface.
///
/// The robot sends its state every millisecond (UDP) and takes joint torques back, on top of its own compensation of gravity. What
/// is done once goes over TCP: Connect, SetCollisionBehavior, SetLoad, Move, StopMove, AutomaticErrorRecovery.
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "devices/arm/udp_socket.hpp"
#include "devices/driver.hpp"
#include "devices/fr3/fci_link.hpp"
#include "devices/fr3/fci_session.hpp"
#include "devices/fr3/fr3_arm.hpp"
#include "devices/fr3/fr3_options.hpp"
#include "devices/fr3/torque_ramp.hpp"

namespace voxtouch::fr3 {

struct Fr3Counts {
  std::uint64_t answered = 0;
  std::uint64_t superseded = 0;      ///< states that a newer one overtook before they were read; not answered
  std::uint64_t unread_answers = 0;  ///< states that the caller left without a `write`; answered without push
  std::uint64_t malformed = 0;       ///< datagrams of another length
  std::uint64_t foreign = 0;         ///< datagrams from another address
  std::uint64_t untrusted = 0;       ///< states with a number that is none, or an undefined mode
  std::uint64_t old = 0;             ///< states as old as one that was taken, or older
  std::uint64_t lost = 0;            ///< counts that were jumped over
  std::uint64_t strange = 0;         ///< states whose count is ahead of all that time could have brought
  std::uint64_t invalid_poses = 0;   ///< states whose angles no arm can have
  std::uint64_t aged = 0;            ///< states that lay in the kernel for too long
  std::uint64_t timeouts = 0;
  std::uint64_t refused = 0;  ///< commands that were not finite or over a limit
  std::uint64_t scaled = 0;   ///< commands made smaller, direction kept, to stay within the joint torques
  std::uint64_t send_errors = 0;
};

/// The numbers of the arm; those of deploy/devices/fr3.yaml.
DeviceDescription describe_fr3();

/// One thread owns it. While the robot listens, every state is answered: by `write`, or without push by the next `read` or by `stop`
/// if `write` was left out, and at once by `read` where it returns an error about a state.
///
/// **Zero force takes steps.** The robot stops itself with a reflex where a joint's torque changes by more than 1 Nm in a
/// millisecond, so force begins and ends along a straight line of at most 0.95 Nm a command: 8.8 N are gone in 7 ms, 60 N in 50 ms.
///
/// read: kTimeout (nothing new in time), kDisconnected (silence, or the command channel has closed), kProtocol (a state that cannot
/// be trusted, or only malformed datagrams came), kFault (a reflex other than lost packets, a user stop that lasts, too many
/// restarts). While there is no torque control samples come all the same.
/// write: kNotFinite, kLimit (check_command), kRecoverable (no torque control, a joint too fast, not sent: `trouble` tells), kProtocol
/// (the sample's pose was not valid), kTimeout (no unanswered state).
///
/// Force is J^T F, geometric Jacobian of the tool, plus the posture torque. The joint torques of a command that would need more than
/// `max_add_torque_nm` are made smaller in proportion. Twist is the Jacobian times the rates that the robot measures.
///
/// Time: the robot's count of milliseconds, from the first state (virtual time: from the first in torque control).
class Fr3Driver : public devices::Driver {
 public:
  /// Connects, and waits for the first state. Throws DeviceOpenError: no connection, a version that it does not speak, a robot that
  /// a person has to see to, an arm of another geometry; the sentence says what to do. In virtual time it returns in torque control.
  explicit Fr3Driver(const Fr3Options& options);
  /// Force along its line to zero, StopMove, zero torque until the robot has left torque control (at most `stop_timeout_s`).
  ~Fr3Driver() override;

  const DeviceDescription& description() const noexcept override { return description_; }
  devices::DeviceResult<devices::DeviceSample> read(std::chrono::microseconds timeout) noexcept override;
  devices::DeviceResult<void> write(const Wrench& command) noexcept override;
  /// The first step towards zero, now; the next states' answers go on with it.
  void stop() noexcept override;
  bool simulated() const noexcept override { return options_.virtual_time; }
  std::string trouble() const override;
  const arm::ArmDescription* arm_description() const noexcept override { return &fr3_description(); }
  std::span<const double> joints() const noexcept override { return {state_.q.data(), static_cast<std::size_t>(state_.q.size())}; }

  // For the thread that owns it.
  const fci::FciSession& session() const noexcept { return session_; }
  const fci::State& state() const noexcept { return state_; }
  const Fr3Counts& counts() const noexcept { return counts_; }
  std::uint16_t version() const noexcept { return dialect_->version; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Intake : std::uint8_t { kNothing, kNew, kUntrusted };
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

  Intake take() noexcept;
  Intake judge(const arm::UdpSocket::Datagram& datagram) noexcept;
  Intake wait_and_take(Clock::time_point deadline) noexcept;
  devices::DeviceError nothing_new(std::uint64_t malformed_before) noexcept;
  void accept() noexcept;
  void measure() noexcept;
  void hear_channel() noexcept;
  void hear(const fci::Received& received) noexcept;
  void ask_what_is_due() noexcept;
  Wrench within_joints(Wrench command) noexcept;
  void answer_without_push() noexcept;
  void answer_untrusted() noexcept;
  bool send(const Joints& torque) noexcept;

  Fr3Options options_;
  std::unique_ptr<FciLink> link_;
  std::unique_ptr<arm::UdpSocket> socket_;
  const fci::Dialect* dialect_;
  Fr3Arm arm_;
  Fr3Limits limits_;
  DeviceDescription description_;
  fci::FciSession session_;
  TorqueRamp ramp_;

  std::array<std::byte, 4096> buffer_;
  fci::State incoming_, state_;
  arm::UdpEndpoint robot_;
  Quat rotation_DB_ = Quat::Identity();
  Fr3Arm::State posture_{};
  devices::DeviceSample sample_;
  Fr3Counts counts_;
  std::atomic<Clock::time_point> heard_;
  std::uint64_t newest_id_ = 0, first_id_ = 0;
  std::uint64_t steps_ms_ = 0;  // since the last state that was accepted
  std::uint32_t next_request_ = 0, move_request_ = 0;
  double posture_share_ = 0.0;
  bool started_ = false;     // a state has been taken
  bool unanswered_ = false;  // state_ waits for its answer
  bool fresh_ = false;       // state_ waits to be read
  bool ending_ = false;      // commands say that the motion is to end

  /// For trouble(), which other threads ask.
  void note() noexcept;
  // Each by itself: a mixture of two moments, for a person's eye, costs nothing.
  std::atomic<fci::Errors> noted_errors_{0};
  std::atomic<fci::Trouble> noted_trouble_{fci::Trouble::kNone};
  std::atomic<fci::Outcome> noted_refusal_{fci::Outcome::kSuccess};
  std::atomic<bool> noted_usable_{true}, noted_closed_{false};
  std::atomic<bool> silent_{false};  // the last read found nothing
};

}  // namespace voxtouch::fr3
