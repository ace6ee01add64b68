#pragma once
/// The DLR / KUKA light-weight robot 4 or 4+ as a haptic device, over the Fast Research
/// Interface 1.0 of its KRC2-LR controller.
///
/// What the controller has to run: a KRL program that calls friOpen(period) and friSetup(address of
/// this machine, port, port), sets $stiffness.strategy from $FRI_FRM_INT[1], calls friStart while
/// $FRI_FRM_INT[2] is 1 and friStop once it is 0, and echoes that in $FRI_TO_INT[2]. It has to
/// widen what the impedance controller may deviate ($stiffness.axismaxdelta, axismaxdeltatrq),
/// since here all force comes as torque on top.
///
/// Not this driver: the successor, LBR iiwa. Its controller's "FRI 1.x" shares the name only. It
/// speaks protocol buffers over UDP 30200 with the roles turned round (the client binds, the
/// controller is addressed by its own application program). Open there: the ids of the monitor and
/// command messages (0x245142, 0x34001), the fields of both (header, joint position and torque,
/// wrench feed-forward, connection quality, session state IDLE to COMMANDING_ACTIVE), and client
/// sources that can be read. Missing for a driver: permission to use those sources without the
/// vendor's product (an own decoder of the messages is possible from the public field numbers), the
/// iiwa's own kinematic and torque limits, a controller-side application, and hardware to see which
/// command mode (torque or wrench overlay) holds its rate.
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

/// The numbers of an arm whose controller sends every `period_s`.
DeviceDescription describe_lwr(double period_s);

/// read: kTimeout (nothing new in time; measurements that are too old are nothing new),
/// kDisconnected (silence, or friClose), kProtocol (a measurement that cannot be trusted, or only
/// malformed datagrams came), kFault (drive error, drives stay off, left command mode too often).
/// While the controller is not in command mode samples come all the same, so that the answers keep
/// coming that the quality is judged by. write: kNotFinite, kLimit (check_command), kRecoverable
/// (not in command mode, quality dropped, too fast, not sent: `session` states it), kProtocol (the
/// sample's pose was not valid), kTimeout (no unanswered measurement). After a kRecoverable the
/// driver works its way back into command mode by itself.
///
/// Force is J^T F, geometric Jacobian of the tool, plus the posture torque (posture_torque.hpp),
/// with stiffness zero and the commanded position at the measured one. The joint torques of a
/// command that would need more than `max_add_torque_nm` are made smaller in proportion. Twist is
/// the Jacobian times low-passed joint rates, and lags as JointRates says.
///
/// Time: periods counted from the first measurement (virtual time: from the first sample in command
/// mode). A controller that announces virtual time (fri::kVirtualTime) makes `simulated()` true: it
/// waits for each answer, so `read` waits for it, up to `virtual_timeout_s` whatever its own
/// timeout; the constructor then returns in command mode.
class LwrDriver : public arm::RequestReplyDriver {
 public:
  /// Waits for the first measurement. Throws DeviceOpenError: port, capture file, nothing or
  /// nothing readable within `connect_timeout_s`, a drive error; the sentence says what to check.
  explicit LwrDriver(const LwrOptions& options);
  /// No push, then the handshake out of command mode (kept up until the controller followed, at
  /// most `stop_timeout_s`); closes.
  ~LwrDriver() override;

  void stop() noexcept override;
  std::string last_error() const override;
  const arm::ArmDescription* arm_description() const noexcept override {
    return &lwr_description();
  }
  std::span<const double> joints() const noexcept override {
    return {q_.data(), static_cast<std::size_t>(q_.size())};
  }

  /// For the thread that owns it: the handshake, the newest measurement, and the packets' numbers.
  /// Real-time safe.
  const fri::FriSession& session() const noexcept { return session_; }
  const fri::MsrPacket& measurement() const noexcept { return msr_; }
  const fri::SequenceCounts& sequence() const noexcept { return sequence_.counts(); }
  std::uint64_t clock_disagreements() const noexcept {
    return clock_ ? clock_->disagreements() : 0;
  }
  /// What keeps the force off and what to do, or that nothing does; with the drives' bits as joint
  /// names. Allocates.
  std::string status_text() const;
  UdpEndpoint local() const noexcept { return socket_->local(); }
  UdpEndpoint controller() const noexcept { return controller_; }

 private:
  void connect();
  void start_in_virtual_time();
  void disengage() noexcept;
  std::string nothing_came() const;

  Intake judge(const UdpSocket::Datagram& datagram,
               std::span<const std::byte> bytes) noexcept override;
  void keep(Intake intake) noexcept override;
  void reply_to_invalid() noexcept override;
  void accept() noexcept override;
  void received_nothing(bool lost) noexcept override;
  bool force_allowed() const noexcept override { return session_.force_allowed(); }
  devices::DeviceError error() const noexcept override { return session_.error(); }
  bool push(const Wrench& command) noexcept override;
  void reply_without_force() noexcept override;
  void measure(double elapsed_s) noexcept;
  fri::Diagnostic check_arm() const noexcept;
  LwrJoints push_for(const Wrench& command) noexcept;
  bool send(const fri::CmdPacket& packet) noexcept;

  LwrOptions options_;
  fri::FriCapture capture_;
  LwrArm arm_;
  LwrLimits limits_;
  fri::SequenceTracker sequence_;
  fri::FriSession session_;
  std::optional<fri::FriComposer> composer_;  // these two: once the period is known
  std::optional<fri::FriClock> clock_;
  arm::JointRates rates_;

  fri::MsrPacket incoming_{}, msr_{};
  LwrArm::State posture_{};
  LwrJoints q_ = LwrJoints::Zero();
  fri::PacketFault last_fault_ = fri::PacketFault::kNone;
  std::size_t last_bad_size_ = 0;
  UdpEndpoint last_bad_from_;
  std::int64_t period_ns_ = 1'000'000;
  std::uint64_t steps_ = 0;  // periods since the last measurement that was accepted
  bool pushing_ = false;     // the last answer held a push

  /// For last_error(), which other threads ask.
  struct Noted {
    fri::Diagnostic diagnostic = fri::Diagnostic::kNone;
    bool usable = true;  // the last measurement
    std::uint16_t power = fri::kAllDrives, error = 0, warning = 0;
  };
  static std::string sentence_for(const Noted& noted);
  Noted noted_now() const noexcept {
    return {session_.diagnostic(), sample_.pose_valid, msr_.robot.power, msr_.robot.error,
            msr_.robot.warning};
  }
  std::atomic<Noted> noted_{Noted{}};
};

}  // namespace voxtouch::lwr
