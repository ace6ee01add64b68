#pragma once
/// What the drivers of arms share whose controller sends a measurement each period over UDP and
/// wants one answer to each.
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "devices/arm/udp_socket.hpp"
#include "devices/driver.hpp"

namespace voxtouch::arm {

/// What came and went since opening. A measurement is a datagram with the arm's state.
struct AnswerCounts {
  std::uint64_t answered = 0;
  std::uint64_t superseded =
      0;  ///< measurements that a newer one overtook before they were read; not answered
  std::uint64_t unread_answers =
      0;  ///< measurements that the caller left without a `write`; answered without push
  std::uint64_t malformed = 0;  ///< datagrams of another length, id or size field
  std::uint64_t foreign = 0;    ///< datagrams from another address
  std::uint64_t untrusted =
      0;  ///< measurements with a number that is none, or an undefined state or mode
  std::uint64_t old =
      0;  ///< measurements as old as one that was taken, or older; not counted by the LWR's driver
  std::uint64_t lost = 0;  ///< counts that were jumped over; likewise
  std::uint64_t strange =
      0;  ///< measurements whose count is ahead of all that time could have brought; likewise
  std::uint64_t invalid_poses =
      0;                      ///< measurements without finite joint positions that the arm can have
  std::uint64_t aged = 0;     ///< measurements that lay in the kernel for too long
  std::uint64_t refused = 0;  ///< commands that were not finite or over a limit
  std::uint64_t scaled =
      0;  ///< commands made smaller, direction kept, to stay within the joint torques
  std::uint64_t send_errors = 0;
};

/// One thread owns it. A measurement is answered by `write`, or without push by the next `read` or
/// by `stop` where `write` was left out, and at once by `read` where it returns an error about a
/// measurement: an error costs the force within its period. The arm's own driver says below what
/// its datagrams mean, and what it answers.
class RequestReplyDriver : public devices::Driver {
 public:
  const DeviceDescription& description() const noexcept final { return description_; }
  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept final;
  devices::DeviceResult<void> write(const Wrench& command) noexcept final;
  bool simulated() const noexcept final { return virtual_time_; }
  /// For the thread that owns it. Real-time safe.
  const AnswerCounts& counts() const noexcept { return counts_; }

 protected:
  using Clock = std::chrono::steady_clock;
  enum class Intake : std::uint8_t { kNothing, kNew, kUntrusted };

  /// `silence_s`: without a measurement for this long the controller has gone; `virtual_timeout_s`:
  /// how long one in virtual time may take.
  RequestReplyDriver(std::unique_ptr<UdpSocket> socket, double silence_s, double virtual_timeout_s)
      : socket_(std::move(socket)),
        silence_s_(silence_s),
        virtual_timeout_s_(virtual_timeout_s) {}

  /// Empties the socket, waiting until `deadline` for something to be there; what counts is the
  /// newest measurement in it.
  Intake wait_and_take(Clock::time_point deadline) noexcept;

  // All of these are real-time safe.
  /// What a datagram is; a measurement is noted as received, and counted whatever it is.
  virtual Intake judge(const UdpSocket::Datagram& datagram,
                       std::span<const std::byte> bytes) noexcept = 0;
  /// The datagram that was judged last is the newest measurement; of kUntrusted ones the head alone
  /// is good.
  virtual void keep(Intake intake) noexcept = 0;
  /// A measurement was kept that is not to be trusted; nothing is answered before the first one
  /// that is.
  virtual void reply_to_invalid() noexcept = 0;
  /// The kept measurement becomes the sample, and waits for its answer.
  virtual void accept() noexcept = 0;
  /// Nothing came in time; `lost`: for so long that the controller has gone.
  virtual void received_nothing(bool lost) noexcept = 0;
  virtual bool closed() const noexcept { return false; }  ///< the controller has ended the session
  virtual bool force_allowed() const noexcept = 0;
  /// Why the session gives no force; kRecoverable also where it does.
  virtual devices::DeviceError error() const noexcept = 0;
  /// Answers with this wrench, in D. False: it could not be sent.
  virtual bool push(const Wrench& command) noexcept = 0;
  virtual void reply_without_force() noexcept = 0;

  std::unique_ptr<UdpSocket> socket_;
  UdpEndpoint controller_;  // where the newest measurement came from
  DeviceDescription description_;
  devices::DeviceSample sample_;
  AnswerCounts counts_;
  Quat rotation_DB_ = Quat::Identity();
  std::atomic<Clock::time_point> received_;  // when the last measurement came
  std::atomic<bool> silent_{false};          // the last read found nothing
  double posture_ratio_ = 0.0;               // of the posture torque, 0 to 1
  bool virtual_time_ = false;
  bool unanswered_ = false;  // the kept measurement waits for its answer
  bool fresh_ = false;       // the kept measurement waits to be read

 private:
  Intake take() noexcept;
  devices::DeviceError nothing_new(std::uint64_t malformed_before) noexcept;

  std::array<std::byte, 4096> buffer_;
  double silence_s_, virtual_timeout_s_;
};

}  // namespace voxtouch::arm
