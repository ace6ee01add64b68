#pragma once
/// The simulated robot on the network: one command channel (TCP), states out and commands in (UDP).
/// Real time by its own clock, or virtual time by the received commands.
#include <array>
#include <memory>

#include "devices/arm/simulated/network_loop.hpp"
#include "devices/fr3/simulated/fci_robot.hpp"

namespace voxtouch::fr3_sim {

using Line = arm_sim::Line<fr3::fci::State>;
using arm_sim::Ending;

struct ServerConfig : arm_sim::NetworkConfig {  ///< the port is that of TCP
  bool virtual_time = false;
};

/// Serves one client at a time; a second one is refused. In real time a state is sent at each
/// millisecond of the steady clock while a client is connected. In virtual time only commands are
/// waited for: after each newest state the server waits for its command, in a motion or not. If the
/// line lost the state, time continues at once.
class FciServer final : public arm_sim::NetworkLoop<FciRobot, fr3::fci::State> {
 public:
  /// Starts listening. Throws DeviceOpenError with a sentence.
  FciServer(const ServerConfig& config, FciRobot& robot, Line line);
  ~FciServer();
  FciServer(const FciServer&) = delete;
  FciServer& operator=(const FciServer&) = delete;

  std::uint16_t port() const noexcept { return port_; }

 private:
  void accept_clients() noexcept;
  void read_channel() noexcept override;
  void read_client() noexcept;
  void handle(const fr3::fci::Received& message) noexcept;
  void close_connection() noexcept;
  void send_message(const fr3::fci::Message& message) noexcept;
  void answer_ended_motion() noexcept;
  void wait_for_input(std::chrono::nanoseconds most) noexcept;
  bool virtual_period(const std::atomic<bool>& stop, Ending& ending) override;
  std::span<const std::byte> encode(const fr3::fci::State& state) noexcept override;
  std::optional<std::uint64_t> answered(
      std::span<const std::byte> datagram) const noexcept override;
  void receive(std::span<const std::byte> datagram, std::chrono::nanoseconds) noexcept override {
    controller_.receive(datagram);
  }
  void advanced() noexcept override { answer_ended_motion(); }
  bool serving() const noexcept override { return client_ >= 0 && remote_.port != 0; }

  int listener_ = -1, client_ = -1;
  std::uint16_t port_ = 0;
  std::unique_ptr<fr3::fci::StreamReader> reader_;
  std::optional<std::uint32_t> motion_;  // the running Move
  std::optional<std::uint64_t> newest_;  // the newest state sent
  bool connected_once_ = false, closed_done_ = false;
  std::array<std::byte, fr3::fci::kMaxStateBytes> bytes_;
};

}  // namespace voxtouch::fr3_sim
