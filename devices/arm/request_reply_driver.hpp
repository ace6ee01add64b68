#pragma once
/// Common part of the drivers of arms whose controller sends a measurement per period over UDP and
/// expects one reply to each.
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

/// Counts since opening. A measurement is a datagram with the state of the arm. The LWR's driver
/// does not use `out_of_order`, `lost` and `from_future`.
struct AnswerCounts {
  std::uint64_t answered = 0;
  std::uint64_t superseded = 0;      ///< not answered: a newer measurement came before `read`
  std::uint64_t unread_answers = 0;  ///< answered without force: the caller made no `write`
  std::uint64_t malformed = 0;       ///< datagrams with a wrong length, id or size field
  std::uint64_t foreign = 0;         ///< datagrams from another address
  std::uint64_t invalid = 0;         ///< with NaN or infinity, or an undefined state or mode
  std::uint64_t out_of_order = 0;    ///< not newer than one already taken
  std::uint64_t lost = 0;            ///< skipped numbers
  std::uint64_t from_future = 0;     ///< numbered ahead of the elapsed time
  std::uint64_t invalid_poses = 0;   ///< without finite joint positions within the arm's range
  std::uint64_t stale = 0;           ///< waited too long in the kernel
  std::uint64_t refused = 0;         ///< commands that were not finite or exceeded a limit
  std::uint64_t scaled = 0;          ///< commands scaled down to the joint torque limits
  std::uint64_t send_errors = 0;
};

/// Owned by one thread. A measurement is answered by `write`; without a `write`, the next `read` or
/// `stop` answers it without force. If `read` returns an error about a measurement, it answers at
/// once, so an error removes the force within its period. The derived driver of an arm implements
/// the meaning of its datagrams and its replies.
class RequestReplyDriver : public devices::Driver {
 public:
  const DeviceDescription& description() const noexcept final { return description_; }
  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept final;
  devices::DeviceResult<void> write(const Wrench& command) noexcept final;
  bool simulated() const noexcept final { return virtual_time_; }
  /// For the owning thread. Real-time safe.
  const AnswerCounts& counts() const noexcept { return counts_; }

 protected:
  using Clock = std::chrono::steady_clock;
  enum class Intake : std::uint8_t { kNothing, kNew, kInvalid };

  /// `silence_s`: without a measurement for this long the controller is lost. `virtual_timeout_s`:
  /// longest wait in virtual time.
  RequestReplyDriver(std::unique_ptr<UdpSocket> socket, double silence_s, double virtual_timeout_s)
      : socket_(std::move(socket)),
        silence_s_(silence_s),
        virtual_timeout_s_(virtual_timeout_s) {}

  /// Empties the socket, waiting for data until `deadline`; only the newest measurement counts.
  Intake wait_and_take(Clock::time_point deadline) noexcept;

  // All of these are real-time safe.
  /// Classifies a datagram; every measurement is recorded as received and counted.
  virtual Intake classify(const UdpSocket::Datagram& datagram,
                          std::span<const std::byte> bytes) noexcept = 0;
  /// Keeps the last classified datagram as the newest measurement; of kInvalid ones only the
  /// header is valid.
  virtual void keep(Intake intake) noexcept = 0;
  /// Replies to a kept invalid measurement; nothing is sent until the first valid one.
  virtual void reply_to_invalid() noexcept = 0;
  /// Makes the kept measurement the sample, which waits for its reply.
  virtual void accept() noexcept = 0;
  /// No measurement arrived in time; `lost`: the controller is lost.
  virtual void received_nothing(bool lost) noexcept = 0;
  virtual bool closed() const noexcept { return false; }  ///< the controller has ended the session
  virtual bool force_allowed() const noexcept = 0;
  /// Why the session gives no force; kRecoverable if force is possible.
  virtual devices::DeviceError error() const noexcept = 0;
  /// Replies with this wrench, in D. Returns false if it could not be sent.
  virtual bool reply_with(const Wrench& command) noexcept = 0;
  virtual void reply_without_force() noexcept = 0;

  std::unique_ptr<UdpSocket> socket_;
  UdpEndpoint controller_;  // source of the newest measurement
  DeviceDescription description_;
  devices::DeviceSample sample_;
  AnswerCounts counts_;
  Quat rotation_DB_ = Quat::Identity();
  std::atomic<Clock::time_point> received_;  // time of the last measurement
  std::atomic<bool> silent_{false};          // the last read found no measurement
  double posture_ratio_ = 0.0;               // of the posture torque, 0 to 1
  bool virtual_time_ = false;
  bool unanswered_ = false;  // the kept measurement waits for its reply
  bool fresh_ = false;       // the kept measurement has not been read

 private:
  Intake take() noexcept;
  devices::DeviceError nothing_new(std::uint64_t malformed_before) noexcept;

  std::array<std::byte, 4096> buffer_;
  double silence_s_, virtual_timeout_s_;
};

}  // namespace voxtouch::arm
