#pragma once
/// The simulated robot on the network: one command channel (TCP), states out and commands in (UDP);
/// real time by its own clock, or virtual time by the commands that come.
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "devices/arm/simulated/line.hpp"
#include "devices/arm/udp_socket.hpp"
#include "devices/fr3/simulated/fci_robot.hpp"

namespace voxtouch::fr3_sim {

using Line = arm_sim::Line<fr3::fci::State>;

struct ServerConfig {
  std::string address = "127.0.0.1";  ///< own, dotted
  std::uint16_t port = 0;             ///< TCP; 0: one that is free
  bool virtual_time = false;
  double patience_s = 5.0;  ///< virtual time: wall time to wait for an answer
};

enum class Ending : std::uint8_t {
  kStopped,   ///< as it was told
  kNoAnswer,  ///< virtual time: patience is over
  kDiverged,  ///< the mechanics left the numbers
};

struct ServerCounts {
  std::uint64_t sent = 0, send_errors = 0, received = 0, foreign = 0;
  std::uint64_t connections = 0;
  std::uint64_t overruns =
      0;  ///< real time: milliseconds that this process was too late for; its clock waited
};

/// One remote side at a time: whoever comes second is turned away. In real time a state leaves at
/// each millisecond of the steady clock while somebody is connected. In virtual time nothing waits
/// but for commands: after each newest state the command that names it is awaited, in a motion or
/// not; where none can come because the line lost it, time goes on at once.
class FciServer {
 public:
  /// Listens. Throws DeviceOpenError with a sentence.
  FciServer(const ServerConfig& config, FciRobot& robot, Line line);
  ~FciServer();
  FciServer(const FciServer&) = delete;
  FciServer& operator=(const FciServer&) = delete;

  /// Called after each millisecond; may throw.
  std::function<void(const FciRobot&)> after_period;

  /// Until told, or the end of patience.
  Ending run(const std::atomic<bool>& stop);

  std::uint16_t port() const noexcept { return port_; }
  const ServerCounts& counts() const noexcept { return counts_; }
  const Line& line() const noexcept { return line_; }

 private:
  void accept_clients() noexcept;
  void read_channel() noexcept;
  void read_client() noexcept;
  void handle(const fr3::fci::Received& message) noexcept;
  void close_connection() noexcept;
  bool send_due(double until_s) noexcept;
  bool take_commands(std::optional<std::uint64_t> awaited) noexcept;
  bool virtual_period(const std::atomic<bool>& stop, Ending& ending);
  void real_period(std::int64_t deadline_ns);
  void wait_for_input(std::int64_t ns) noexcept;
  void send_message(const fr3::fci::Message& message) noexcept;
  bool serving() const noexcept { return client_ >= 0 && remote_.port != 0; }

  ServerConfig config_;
  FciRobot& robot_;
  Line line_;
  arm::UdpSocket socket_;
  int listener_ = -1, client_ = -1;
  std::uint16_t port_ = 0;
  arm::UdpEndpoint remote_;
  std::unique_ptr<fr3::fci::StreamReader> reader_;
  std::optional<std::uint32_t> motion_;  // the Move that runs
  std::optional<std::uint64_t> newest_;  // the newest state that left
  bool closed_done_ = false;
  ServerCounts counts_;
};

}  // namespace voxtouch::fr3_sim
