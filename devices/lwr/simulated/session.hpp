#pragma once
/// The simulated controller on the network: real time by its own clock, or virtual time by the
/// received replies.
#include <string>

#include "devices/arm/simulated/network_loop.hpp"
#include "devices/lwr/simulated/fri_controller.hpp"

namespace voxtouch::lwr_sim {

using Line = arm_sim::Line<lwr::fri::MsrPacket>;
using arm_sim::Ending;

struct SessionConfig : arm_sim::NetworkConfig {
  std::string remote_address = "127.0.0.1";  ///< destination of measurements, dotted
  std::uint16_t remote_port = lwr::fri::kDefaultPort;
};

/// In virtual time only replies are waited for: after each newest measurement the session waits for
/// its reply. If the line lost it, time continues at once; while the controller is silent, at one
/// period of wall time per period. The first measurement is repeated until the remote side is
/// ready. At the end one measurement with state OFF is sent.
class Session final : public arm_sim::NetworkLoop<FriController, lwr::fri::MsrPacket> {
 public:
  /// Binds the port. Throws DeviceOpenError with a sentence.
  Session(const SessionConfig& config, FriController& controller, Line line);

  arm::UdpEndpoint local() const noexcept { return socket_.local(); }

 private:
  enum class Wait : std::uint8_t { kAnswered, kTimeout, kStopped };
  bool virtual_period(const std::atomic<bool>& stop, Ending& ending) override;
  std::span<const std::byte> encode(const lwr::fri::MsrPacket& msr) noexcept override {
    return std::as_bytes(std::span(&msr, 1));
  }
  std::optional<std::uint64_t> answered(
      std::span<const std::byte> datagram) const noexcept override;
  void receive(std::span<const std::byte> datagram, std::chrono::nanoseconds age) noexcept override;
  void ended() noexcept override { send(controller_.close()); }
  Wait await_answer(std::uint16_t send_seq, const lwr::fri::MsrPacket* repeat,
                    const std::atomic<bool>& stop);

  double virtual_latency_s_ = 0.0;
};

}  // namespace voxtouch::lwr_sim
