#pragma once
/// Driver of the DLR / KUKA light-weight robot 4 or 4+ as a haptic device, over the Fast Research
/// Interface 1.0 of its KRC2-LR controller.
///
/// The controller must run a KRL program that calls friOpen(period) and friSetup(address of this
/// machine, port, port), and sets $stiffness.strategy from $FRI_FRM_INT[1]. The program calls
/// friStart while $FRI_FRM_INT[2] is 1, calls friStop once it is 0, and echoes it in
/// $FRI_TO_INT[2]. It must widen the deviation limits of the impedance controller
/// ($stiffness.axismaxdelta, axismaxdeltatrq), because all force is additional torque.
///
/// The successor, LBR iiwa, is not supported: its "FRI 1.x" is a different protocol (protocol
/// buffers over UDP 30200).
#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

#include "devices/arm/joint_rates.hpp"
#include "devices/arm/request_reply_driver.hpp"
#include "devices/lwr/fri_capture.hpp"
#include "devices/lwr/fri_clock.hpp"
#include "devices/lwr/fri_composer.hpp"
#include "devices/lwr/fri_sequence.hpp"
#include "devices/lwr/fri_session.hpp"
#include "devices/lwr/lwr_arm.hpp"
#include "devices/lwr/lwr_options.hpp"

namespace voxtouch::lwr {

/// Description of an arm whose controller sends at intervals of `period_s`.
DeviceDescription describe_lwr(double period_s);

/// Errors of `read`: kTimeout (no new measurement in time, or only outdated ones), kDisconnected
/// (silence, or friClose), kProtocol (an invalid measurement, or only malformed datagrams), kFault
/// (drive error, drives stay off, left command mode too often). Outside command mode samples
/// continue, so that the replies that determine the quality continue too.
///
/// Errors of `write`: kNotFinite, kLimit (check_command), kRecoverable (not in command mode,
/// quality dropped, too fast, not sent; `session` gives the reason), kProtocol (the pose of the
/// sample was invalid), kTimeout (no unanswered measurement). After kRecoverable the driver returns
/// to command mode by itself.
///
/// Force is J^T F, with the geometric Jacobian of the tool, plus the posture torque
/// (posture_torque.hpp). Stiffness is zero and the commanded position is the measured one. Joint
/// torques of a command beyond `max_add_torque_nm` are scaled down in proportion. The twist is the
/// Jacobian times low-passed joint rates, with the lag of JointRates.
///
/// Time: periods counted from the first measurement (virtual time: from the first sample in command
/// mode). A controller that announces virtual time (fri::kVirtualTime) makes `simulated()` true. It
/// waits for each reply, so `read` waits for it up to `virtual_timeout_s`, independent of its own
/// timeout. The constructor then returns in command mode.
class LwrDriver : public arm::RequestReplyDriver {
 public:
  /// Waits for the first measurement. Throws DeviceOpenError, with a remedy: port, capture file, no
  /// valid measurement within `connect_timeout_s`, a drive error.
  explicit LwrDriver(const LwrOptions& options);
  /// Removes the force and leaves command mode by the handshake (until the controller followed, at
  /// most `stop_timeout_s`); then closes.
  ~LwrDriver() override;

  void stop() noexcept override;
  std::string last_error() const override;
  const arm::ArmDescription* arm_description() const noexcept override {
    return &lwr_description();
  }
  std::span<const double> joints() const noexcept override {
    return {q_.data(), static_cast<std::size_t>(q_.size())};
  }

  /// For the owning thread: the handshake, the newest measurement, and the packet counts. Real-time
  /// safe.
  const fri::FriSession& session() const noexcept { return session_; }
  const fri::MsrPacket& measurement() const noexcept { return msr_; }
  const fri::SequenceCounts& sequence() const noexcept { return sequence_.counts(); }
  std::uint64_t clock_disagreements() const noexcept {
    return clock_ ? clock_->disagreements() : 0;
  }
  /// Reason for zero force and the remedy, or that force is possible; with the drives' bits as
  /// joint names. Allocates.
  std::string status_text() const;
  UdpEndpoint local() const noexcept { return socket_->local(); }
  UdpEndpoint controller() const noexcept { return controller_; }

 private:
  void connect();
  void start_in_virtual_time();
  void disengage() noexcept;
  std::string nothing_came() const;

  Intake classify(const UdpSocket::Datagram& datagram,
                  std::span<const std::byte> bytes) noexcept override;
  void keep(Intake intake) noexcept override;
  void reply_to_invalid() noexcept override;
  void accept() noexcept override;
  void received_nothing(bool lost) noexcept override;
  bool force_allowed() const noexcept override { return session_.force_allowed(); }
  devices::DeviceError error() const noexcept override { return session_.error(); }
  bool reply_with(const Wrench& command) noexcept override;
  void reply_without_force() noexcept override;
  void measure(double elapsed_s) noexcept;
  fri::Diagnostic check_arm() const noexcept;
  LwrJoints added_torque(const Wrench& command) noexcept;
  bool send(const fri::CmdPacket& packet) noexcept;

  LwrOptions options_;
  fri::FriCapture capture_;
  LwrArm arm_;
  LwrLimits limits_;
  fri::SequenceTracker sequence_;
  fri::FriSession session_;
  std::optional<fri::FriComposer> composer_;  // both exist once the period is known
  std::optional<fri::FriClock> clock_;
  arm::JointRates rates_;

  fri::MsrPacket incoming_{}, msr_{};
  LwrArm::State posture_{};
  LwrJoints q_ = LwrJoints::Zero();
  fri::PacketFault last_fault_ = fri::PacketFault::kNone;
  std::size_t last_bad_size_ = 0;
  UdpEndpoint last_bad_from_;
  std::int64_t period_ns_ = 1'000'000;
  std::uint64_t steps_ = 0;          // periods since the last accepted measurement
  bool replied_with_force_ = false;  // the last reply contained a force

  /// For last_error(), which other threads call.
  struct Snapshot {
    fri::Diagnostic diagnostic = fri::Diagnostic::kNone;
    bool usable = true;  // the last measurement
    std::uint16_t power = fri::kAllDrives, error = 0, warning = 0;
  };
  static std::string sentence_for(const Snapshot& snapshot);
  Snapshot take_snapshot() const noexcept {
    return {session_.diagnostic(), sample_.pose_valid, msr_.robot.power, msr_.robot.error,
            msr_.robot.warning};
  }
  std::atomic<Snapshot> snapshot_{Snapshot{}};
};

}  // namespace voxtouch::lwr
