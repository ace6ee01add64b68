#pragma once
/// The command channel: one TCP connection to the robot. After construction nothing allocates,
/// waits or throws.
#include <atomic>
#include <optional>
#include <string>

#include "devices/arm/udp_socket.hpp"
#include "devices/fr3/fci_codec.hpp"

namespace voxtouch::fr3 {

class FciLink {
 public:
  /// Connects within `timeout_s`. Throws DeviceOpenError: what was tried, what the system said,
  /// what to do; also where `cancelled` was set meanwhile.
  FciLink(const std::string& address, std::uint16_t port, double timeout_s,
          const std::atomic<bool>* cancelled);
  ~FciLink();
  FciLink(const FciLink&) = delete;
  FciLink& operator=(const FciLink&) = delete;

  /// False: it did not go out whole; the channel is closed then.
  bool send(const fci::Message& message) noexcept;
  /// The next whole answer; nullopt: none yet.
  std::optional<fci::Received> poll() noexcept;
  /// Waits for the next whole answer, at most `timeout_s`.
  std::optional<fci::Received> wait(double timeout_s) noexcept;
  /// The robot has closed it, or it broke.
  bool closed() const noexcept { return closed_; }
  /// Bytes came that are no message.
  bool got_other_bytes() const noexcept { return reader_.broken() || reader_.pending() > 0; }
  arm::UdpEndpoint robot() const noexcept { return robot_; }
  /// The address of this machine that the robot sees.
  std::string own_address() const;

 private:
  int file_ = -1;
  arm::UdpEndpoint robot_;
  fci::StreamReader reader_;
  bool closed_ = false;
};

}  // namespace voxtouch::fr3
