#pragma once
/// A scripted KRC on the loopback: it sends the `msr` that the test sets; its KRL program follows
/// the handshake.
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "devices/arm/udp_socket.hpp"
#include "devices/lwr/fri_codec.hpp"
#include "devices/lwr/lwr_driver.hpp"

namespace voxtouch::test {

class FakeController {
 public:
  explicit FakeController(const std::string& address = "127.0.0.1");

  /// Stamps, counts on and sends `msr`. The two halves apart for tests that lose, hold back or
  /// double packets.
  void send();
  lwr::fri::MsrPacket next();
  void send(const lwr::fri::MsrPacket& packet);
  void send_bytes(std::span<const std::byte> bytes);
  /// All new answers; the program follows the last request if `program_runs`.
  std::vector<lwr::fri::CmdPacket> receive();

  /// Opens a driver that listens on a free port, sending until it has opened (or thrown).
  std::unique_ptr<lwr::LwrDriver> open(lwr::LwrOptions options = {});
  /// Closes the driver while answering its handshake.
  void close(std::unique_ptr<lwr::LwrDriver> driver);
  /// Runs `body` while measurements are sent every half a millisecond.
  void serve_while(const std::function<void()>& body);

  lwr::fri::MsrPacket msr = lwr::fri::empty_msr();  ///< the next packet
  bool program_runs = true;                         ///< state and echo follow the requests
  std::uint16_t port = 0;                           ///< of the driver
  std::vector<lwr::fri::CmdPacket> received;        ///< every answer so far

 private:
  void follow(const lwr::fri::CmdPacket& command);
  arm::UdpSocket socket_;
  std::uint64_t periods_ = 0;
};

/// Options for a test: loopback, a port that is free now, short times.
lwr::LwrOptions quick_options();

struct Cycle {
  devices::DeviceResult<devices::DeviceSample> sample;
  devices::DeviceResult<void> written;
  lwr::fri::CmdPacket command;  ///< the last answer
  std::size_t answers = 0;
};
/// One period: measurement, read, write (only after a good read), answers.
Cycle cycle(FakeController& controller, lwr::LwrDriver& driver, const Wrench& command = {});
/// Cycles until force flows, at most 200. False if it never did.
bool run_to_command(FakeController& controller, lwr::LwrDriver& driver);

/// Largest torque in an answer.
double torque_of(const lwr::fri::CmdPacket& command);

}  // namespace voxtouch::test
