#pragma once
/// Network loop of any simulated controller: real time by its own clock, or virtual time by the
/// received replies.
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
  std::uint16_t port = 0;             ///< own; 0: a free one
  std::optional<double> duration_s;   ///< of the controller's time; absent: until stopped
  double patience_s = 5.0;            ///< virtual time: wall time to wait for a reply
};

enum class Ending : std::uint8_t {
  kStopped,  ///< as requested
  kDuration,
  kNoAnswer,  ///< virtual time: no reply within the patience
  kDiverged,  ///< the mechanics are not finite
};

struct NetworkCounts {
  std::uint64_t sent = 0, send_errors = 0;
  std::uint64_t received = 0, foreign = 0;  ///< foreign: from another address, ignored
  /// Real time: periods missed by this process, during which its clock was suspended.
  std::uint64_t overruns = 0;
};

inline std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
inline std::chrono::nanoseconds seconds_as_ns(double s) {
  return std::chrono::nanoseconds(std::llround(1e9 * s));
}

/// Longest time until a stop is noticed.
inline constexpr std::chrono::nanoseconds kPollPeriod = std::chrono::milliseconds(50);

/// In real time a measurement is sent at each deadline of the steady clock, independent of the
/// remote side. If this process is more than a period late, the deadlines are shifted, without a
/// burst. A derived class implements its protocol and virtual time.
template <class Controller, class Payload>
class NetworkLoop {
 public:
  using Line = arm_sim::Line<Payload>;
  virtual ~NetworkLoop() = default;

  /// Called after each period; may throw.
  std::function<void(const Controller&)> after_period;

  /// Runs until stopped, or until the duration or the patience ends.
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
        // A whole period late: the clock is suspended instead of catching up.
        if (now_ns() > deadline_ns) {
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

  // Protocol of the derived class.
  /// Waits for the replies of one period; returns false at the end, with the reason in `ending`.
  virtual bool virtual_period(const std::atomic<bool>& stop, Ending& ending) = 0;
  virtual std::span<const std::byte> encode(const Payload& payload) noexcept = 0;
  /// The measurement that a datagram replies to; empty if it is not a reply.
  virtual std::optional<std::uint64_t> answered(
      std::span<const std::byte> datagram) const noexcept = 0;
  /// `age`: waiting time of the datagram in the kernel.
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
  /// Sends all packets due earlier than `until_s`; `left` receives each packet.
  template <class Left>
  void send_due(double until_s, Left&& left) noexcept {
    while (const typename Line::Packet* packet = line_.take(until_s)) {
      send(packet->msr);
      left(*packet);
    }
  }
  /// Processes all waiting datagrams; returns true if a reply to `awaited` was among them.
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
  std::int64_t sent_ns_ = 0;  ///< real time: time of this period's measurement

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
