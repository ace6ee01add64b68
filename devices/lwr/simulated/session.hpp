#pragma once
/// The simulated controller on the network: real time by its own clock, or virtual time by the
/// answers that come.
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "devices/arm/simulated/line.hpp"
#include "devices/arm/udp_socket.hpp"
#include "devices/lwr/simulated/fri_controller.hpp"

namespace voxtouch::lwr_sim {

using Line = arm_sim::Line<lwr::fri::MsrPacket>;

struct SessionConfig {
  std::string address = "127.0.0.1";         ///< own, dotted
  std::uint16_t port = 0;                    ///< own source port; 0: one that is free
  std::string remote_address = "127.0.0.1";  ///< where measurements go, dotted
  std::uint16_t remote_port = lwr::fri::kDefaultPort;
  std::optional<double> duration_s;  ///< of the controller's time; absent: until it is told to stop
  double patience_s = 5.0;           ///< virtual time: wall time to wait for an answer
};

enum class Ending : std::uint8_t {
  kStopped,  ///< as it was told
  kDuration,
  kNoAnswer,  ///< virtual time: patience is over
  kDiverged,  ///< the mechanics left the numbers
};

struct SessionCounts {
  std::uint64_t sent = 0, send_errors = 0;
  std::uint64_t received = 0, foreign = 0;  ///< foreign: from another address, not looked at
  std::uint64_t overruns =
      0;  ///< real time: periods that this process was too late for; its clock waited
};

/// In real time a measurement leaves at each deadline of the steady clock, whatever the remote side
/// does; where this process is more than a period late, the deadlines move on (no burst follows).
/// In virtual time nothing waits but for answers: after each newest measurement the answer to it is
/// awaited; where none can come because the line lost it, time goes on at once, and while the
/// controller is silent at one period of wall time a period. The very first measurement is repeated
/// until the remote side is there.
class Session {
 public:
  /// Binds the port. Throws DeviceOpenError with a sentence.
  Session(const SessionConfig& config, FriController& controller, Line line);

  /// Called after each period; may throw.
  std::function<void(const FriController&)> after_period;

  /// Until told, or the end of the duration or of patience. At the end one measurement with state
  /// OFF is sent.
  Ending run(const std::atomic<bool>& stop);

  arm::UdpEndpoint local() const noexcept { return socket_.local(); }
  const SessionCounts& counts() const noexcept { return counts_; }
  const Line& line() const noexcept { return line_; }

 private:
  enum class Wait : std::uint8_t { kAnswered, kTimeout, kStopped };
  bool virtual_period(const std::atomic<bool>& stop, Ending& ending);
  void real_period(std::int64_t deadline_ns);
  Wait await_answer(std::uint16_t send_seq, const lwr::fri::MsrPacket* repeat,
                    const std::atomic<bool>& stop);
  bool send(const lwr::fri::MsrPacket& msr) noexcept;
  /// Takes in everything that waits; true if the answer to `send_seq` was among it. `latency_s`
  /// empty: by the clock.
  bool drain(std::optional<std::uint16_t> send_seq, std::optional<double> latency_s);
  bool finished() const noexcept;

  SessionConfig config_;
  FriController& controller_;
  Line line_;
  arm::UdpEndpoint remote_;
  arm::UdpSocket socket_;
  SessionCounts counts_;
  bool heard_ = false;
  double virtual_latency_s_ = 0.0;
  std::int64_t sent_ns_ = 0;
};

}  // namespace voxtouch::lwr_sim
