#pragma once
/// The command channel: one TCP connection to the robot. After construction no function allocates,
/// blocks or throws, except `wait`.
#include <atomic>
#include <optional>
#include <string>

#include "devices/arm/udp_socket.hpp"
#include "devices/fr3/fci_codec.hpp"

namespace voxtouch::fr3 {

class FciLink {
 public:
  /// Connects within `timeout_s`. Throws DeviceOpenError with the attempt, the system's error and a
  /// remedy; also if `cancelled` is set meanwhile.
  FciLink(const std::string& address, std::uint16_t port, double timeout_s,
          const std::atomic<bool>* cancelled);
  ~FciLink();
  FciLink(const FciLink&) = delete;
  FciLink& operator=(const FciLink&) = delete;

  /// Returns false if it was not sent completely; the channel is then closed.
  bool send(const fci::Message& message) noexcept;
  /// The next complete reply, or nullopt.
  std::optional<fci::Received> poll() noexcept;
  /// Waits for the next complete reply, at most `timeout_s`.
  std::optional<fci::Received> wait(double timeout_s) noexcept;
  /// The robot has closed the channel, or it is broken.
  bool closed() const noexcept { return closed_; }
  /// Received bytes are not a valid message.
  bool got_other_bytes() const noexcept { return reader_.broken() || reader_.pending() > 0; }
  arm::UdpEndpoint robot() const noexcept { return robot_; }
  /// The address of this machine in the connection to the robot.
  std::string own_address() const;

 private:
  int file_ = -1;
  arm::UdpEndpoint robot_;
  fci::StreamReader reader_;
  bool closed_ = false;
};

}  // namespace voxtouch::fr3
