#pragma once
/// A simulated controller on the network, whatever it enabled: real time by its own clock, or
/// virtual time by the answers that come.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "devices/arm/simulated/line.hpp"
#include "devices/arm/udp_socket.hpp"

namespace voxtouch::arm_sim {

struct NetworkConfig {
  std::string address = "127.0.0.1";  ///< own, dotted
  std::uint16_t port = 0;             ///< own; 0: one that is free
  std::optional<double> duration_s;   ///< of the controller's time; absent: until it is stopped
  double patience_s = 5.0;            ///< virtual time: wall time to wait for an answer
};

enum class Ending : std::uint8_t {
  kStopped,  ///< as it was set
  kDuration,
  kNoAnswer,  ///< virtual time: patience is over
  kDiverged,  ///< the mechanics left the numbers
};

struct NetworkCounts {
  std::uint64_t sent = 0, send_errors = 0;
  std::uint64_t received = 0, foreign = 0;  ///< foreign: from another address, not looked at
  std::uint64_t overruns =
      0;  ///< real time: periods that this process was too late for; its clock waited
};

inline std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
inline std::chrono::nanoseconds seconds_as_ns(double s) {
  return std::chrono::nanoseconds(std::llround(1e9 * s));
}

/// A stop is noticed after this, at the latest.
inline constexpr std::chrono::nanoseconds kPollPeriod = std::chrono::milliseconds(50);

/// In real time a measurement leaves at each deadline of the steady clock, whatever the remote side
/// does; where this process is more than a period late, the deadlines move on (no burst follows). A
/// front gives the rules of its protocol, and virtual time.
template <class Controller, class Payload>
class NetworkLoop {
 public:
  using Line = arm_sim::Line<Payload>;
  virtual ~NetworkLoop() = default;

  /// Called after each period; may throw.
  std::function<void(const Controller&)> after_period;

  /// Until stopped, or the end of the duration or of patience.
  Ending run(const std::atomic<bool>& stop) {
    const std::int64_t period_ns = seconds_as_ns(period_s_).count();
    std::int64_t deadline_ns = now_ns();
    Ending ending = Ending::kStopped;
    while (!stop.load(std::memory_order_relaxed)) {
      if (config_.duration_s && controller_.time_s() >= *config_.duration_s - 1e-9) {
        ending = Ending::kDuration;
        break;
      }
      if (virtual_time_) {
        if (!virtual_period(stop, ending))
          break;
      } else {
        deadline_ns += period_ns;
        if (now_ns() >
            deadline_ns) {  // a whole period late: the clock waits rather than hurry after
          ++counts_.overruns;
          deadline_ns = now_ns() + period_ns;
        }
        real_period(deadline_ns);
      }
      controller_.advance();
      advanced();
      if (!controller_.finite()) {
        ending = Ending::kDiverged;
        break;
      }
      if (after_period)
        after_period(controller_);
    }
    ended();
    return ending;
  }

  const NetworkCounts& counts() const noexcept { return counts_; }
  const Line& line() const noexcept { return line_; }

 protected:
  NetworkLoop(const NetworkConfig& config, std::uint16_t udp_port, double period_s,
              bool virtual_time, Controller& controller, Line line)
      : config_(config),
        controller_(controller),
        line_(std::move(line)),
        socket_(config.address, udp_port),
        period_s_(period_s),
        virtual_time_(virtual_time) {}

  // What a front's protocol says.
  /// One period's answers are there; false: it ends, `ending` says why.
  virtual bool virtual_period(const std::atomic<bool>& stop, Ending& ending) = 0;
  virtual std::span<const std::byte> encode(const Payload& payload) noexcept = 0;
  /// Which measurement a datagram answers; nothing where it is none that could.
  virtual std::optional<std::uint64_t> answered(
      std::span<const std::byte> datagram) const noexcept = 0;
  /// `age`: how long the datagram lay in the kernel.
  virtual void receive(std::span<const std::byte> datagram,
                       std::chrono::nanoseconds age) noexcept = 0;
  virtual bool serving() const noexcept { return true; }
  virtual void read_channel() noexcept {}
  virtual void advanced() noexcept {}
  virtual void ended() noexcept {}

  bool send(const Payload& payload) noexcept {
    const bool gone = socket_.send(encode(payload), remote_);
    ++(gone ? counts_.sent : counts_.send_errors);
    return gone;
  }
  /// What leaves before `until_s` leaves now; `left` receives each.
  template <class Left>
  void send_due(double until_s, Left&& left) noexcept {
    while (const typename Line::Packet* packet = line_.take(until_s)) {
      send(packet->msr);
      left(*packet);
    }
  }
  /// Takes in everything that waits; true: an answer to `awaited` was among it.
  bool drain(std::optional<std::uint64_t> awaited = std::nullopt) noexcept {
    std::array<std::byte, 2048> buffer;
    bool found = false;
    while (const auto datagram = socket_.receive(buffer)) {
      if (datagram->from != remote_) {
        ++counts_.foreign;
        continue;
      }
      ++counts_.received;
      const double now = controller_.time_s();
      if (line_.silent(now))
        continue;
      const auto bytes =
          std::span<const std::byte>(buffer).first(std::min(datagram->size, buffer.size()));
      found = found || (awaited && answered(bytes) == awaited);
      if (!line_.loses_answer(now))
        receive(bytes, datagram->age);
    }
    return found;
  }

  NetworkConfig config_;
  Controller& controller_;
  Line line_;
  arm::UdpSocket socket_;
  arm::UdpEndpoint remote_;
  NetworkCounts counts_;
  std::int64_t sent_ns_ = 0;  ///< real time: when this period's measurement was made

 private:
  void real_period(std::int64_t deadline_ns) noexcept {
    read_channel();
    const double now = controller_.time_s();
    sent_ns_ = now_ns();
    const Payload& measured = controller_.measure();
    const bool enabled = serving() && !line_.silent(now);
    if (enabled)
      line_.put(measured, now);
    for (;;) {
      const std::int64_t at_ns = now_ns();
      const double at_s = now + 1e-9 * static_cast<double>(at_ns - sent_ns_);
      if (enabled)
        send_due(at_s + 1e-9, [](const auto&) {});
      drain();
      if (at_ns >= deadline_ns)
        return;
      const double due_s = std::clamp(line_.next_due_s() - at_s, 0.0, 1.0);
      socket_.wait(std::min(std::chrono::nanoseconds(deadline_ns - at_ns), seconds_as_ns(due_s)));
    }
  }

  double period_s_;
  bool virtual_time_;
};

}  // namespace voxtouch::arm_sim
