#include "devices/lwr/simulated/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <thread>
#include <utility>

namespace voxtouch::lwr_sim {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

/// Virtual time: a measurement without a reply for this long may have been sent to a side that was
/// restarting.
constexpr nanoseconds kRepeatAfter = std::chrono::milliseconds(200);

}  // namespace

Session::Session(const SessionConfig& config, FriController& controller, Line line)
    : NetworkLoop(config, config.port, controller.config().period_s,
                  controller.config().virtual_time, controller, std::move(line)) {
  const auto address = arm::parse_ipv4(config.remote_address);
  if (!address || config.remote_port == 0)
    throw devices::DeviceOpenError(
        fmt::format("'{}:{}' is not an address and port, such as 127.0.0.1:{}",
                    config.remote_address, config.remote_port, lwr::fri::kDefaultPort));
  remote_ = {*address, config.remote_port};
}

std::optional<std::uint64_t> Session::answered(std::span<const std::byte> datagram) const noexcept {
  if (datagram.size() != lwr::fri::kCmdSize)
    return std::nullopt;
  lwr::fri::Header header;
  std::memcpy(&header, datagram.data(), sizeof header);
  return header.refl_seq;
}

void Session::receive(std::span<const std::byte> datagram, nanoseconds age) noexcept {
  const double measured_s =
      std::max(1e-9 * static_cast<double>(arm_sim::now_ns() - age.count() - sent_ns_), 0.0);
  controller_.receive(datagram,
                      controller_.config().virtual_time ? virtual_latency_s_ : measured_s);
}

Session::Wait Session::await_answer(std::uint16_t send_seq, const lwr::fri::MsrPacket* repeat,
                                    const std::atomic<bool>& stop) {
  const auto begin = Clock::now(), end = begin + arm_sim::seconds_as_ns(config_.patience_s);
  while (!stop.load(std::memory_order_relaxed)) {
    if (drain(send_seq))
      return Wait::kAnswered;
    const nanoseconds left = end - Clock::now();
    if (left <= nanoseconds(0))
      return Wait::kTimeout;
    // The remote side may not be ready, or may be restarting, so the same packet is sent again. A
    // side that has received it treats it as a duplicate.
    if (!socket_.wait(std::min(left, arm_sim::kPollPeriod)) && repeat &&
        (counts_.received == 0 || Clock::now() - begin > kRepeatAfter))
      send(*repeat);
  }
  return Wait::kStopped;
}

/// Sends all packets that are due in this period; then waits for the reply to the newest, if it was
/// sent.
bool Session::virtual_period(const std::atomic<bool>& stop, Ending& ending) {
  const double now = controller_.time_s(), end = now + controller_.config().period_s * (1.0 - 1e-6);
  const bool silent = line_.silent(now);
  const lwr::fri::MsrPacket& msr = controller_.measure();
  if (silent) {
    std::this_thread::sleep_for(arm_sim::seconds_as_ns(controller_.config().period_s));
    drain();
    return true;
  }
  line_.put(msr, now);
  std::optional<std::uint16_t> newest;
  send_due(end, [&](const Line::Packet& packet) {
    const std::uint16_t sequence = packet.msr.header.send_seq;
    if (newest && lwr::fri::sequence_distance(*newest, sequence) <= 0)
      return;
    newest = sequence;
    virtual_latency_s_ = std::max(packet.due_s - packet.sent_s, 0.0);
  });
  if (!newest)
    return true;
  const bool current = *newest == msr.header.send_seq;
  const Wait result = await_answer(*newest, current ? &msr : nullptr, stop);
  if (result == Wait::kTimeout)
    ending = Ending::kNoAnswer;
  if (result == Wait::kStopped)
    ending = Ending::kStopped;
  return result == Wait::kAnswered;
}

}  // namespace voxtouch::lwr_sim
