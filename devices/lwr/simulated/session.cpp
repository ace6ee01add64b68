#include "devices/lwr/simulated/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>
#include <utility>

namespace voxtouch::lwr_sim {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

std::int64_t now_ns() {
  return std::chrono::duration_cast<nanoseconds>(Clock::now().time_since_epoch()).count();
}
nanoseconds seconds_as_ns(double s) { return nanoseconds(std::llround(1e9 * s)); }

/// A stop is noticed after this, at the latest.
constexpr nanoseconds kPollPeriod = milliseconds(50);

/// Virtual time: a measurement that nobody has answered for so long may have gone to a side that
/// was just being restarted.
constexpr nanoseconds kRepeatAfter = milliseconds(200);

}  // namespace

Session::Session(const SessionConfig& config, FriController& controller, Line line)
    : config_(config),
      controller_(controller),
      line_(std::move(line)),
      socket_(config.address, config.port) {
  const auto address = arm::parse_ipv4(config.remote_address);
  if (!address || config.remote_port == 0)
    throw devices::DeviceOpenError(
        fmt::format("'{}:{}' is no address and port of a remote side, like 127.0.0.1:{}",
                    config.remote_address, config.remote_port, lwr::fri::kDefaultPort));
  remote_ = {*address, config.remote_port};
}

bool Session::send(const lwr::fri::MsrPacket& msr) noexcept {
  const bool gone = socket_.send(std::as_bytes(std::span(&msr, 1)), remote_);
  ++(gone ? counts_.sent : counts_.send_errors);
  return gone;
}

bool Session::drain(std::optional<std::uint16_t> send_seq, std::optional<double> latency_s) {
  std::array<std::byte, 2048> buffer;
  bool found = false;
  while (const auto datagram = socket_.receive(buffer)) {
    if (datagram->from != remote_) {
      ++counts_.foreign;
      continue;
    }
    ++counts_.received;
    heard_ = true;
    const double now = controller_.time_s();
    if (line_.silent(now))
      continue;
    const std::size_t size = std::min(datagram->size, buffer.size());
    if (send_seq && size >= sizeof(lwr::fri::Header)) {
      lwr::fri::Header header;
      std::memcpy(&header, buffer.data(), sizeof header);
      found = found || (size == lwr::fri::kCmdSize && header.refl_seq == *send_seq);
    }
    if (line_.loses_answer(now))
      continue;
    const double measured = 1e-9 * static_cast<double>(now_ns() - datagram->age.count() - sent_ns_);
    controller_.receive(std::span(buffer.data(), size),
                        latency_s.value_or(std::max(measured, 0.0)));
  }
  return found;
}

Session::Wait Session::await_answer(std::uint16_t send_seq, const lwr::fri::MsrPacket* repeat,
                                    const std::atomic<bool>& stop) {
  const auto begin = Clock::now(), end = begin + seconds_as_ns(config_.patience_s);
  while (!stop.load(std::memory_order_relaxed)) {
    if (drain(send_seq, virtual_latency_s_))
      return Wait::kAnswered;
    const nanoseconds left = end - Clock::now();
    if (left <= nanoseconds(0))
      return Wait::kTimeout;
    // The remote side may not be there yet, or not there again: the same packet goes out once more.
    // One that has it already takes it for what it is, a duplicate.
    if (!socket_.wait(std::min(left, kPollPeriod)) && repeat &&
        (!heard_ || Clock::now() - begin > kRepeatAfter))
      send(*repeat);
  }
  return Wait::kStopped;
}

/// All that leaves before the period's end leaves now; then the answer to the newest is awaited, if
/// the newest left.
bool Session::virtual_period(const std::atomic<bool>& stop, Ending& ending) {
  const double now = controller_.time_s(), end = now + controller_.config().period_s * (1.0 - 1e-6);
  const bool silent = line_.silent(now);
  const lwr::fri::MsrPacket& msr = controller_.measure();
  if (silent) {
    std::this_thread::sleep_for(seconds_as_ns(controller_.config().period_s));
    drain(std::nullopt, 0.0);
    return true;
  }
  line_.put(msr, now);
  std::optional<std::uint16_t> newest;
  while (const Line::Packet* packet = line_.take(end)) {
    send(packet->msr);
    const std::uint16_t sequence = packet->msr.header.send_seq;
    if (newest && lwr::fri::sequence_distance(*newest, sequence) <= 0)
      continue;
    newest = sequence;
    virtual_latency_s_ = std::max(packet->due_s - packet->sent_s, 0.0);
  }
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

void Session::real_period(std::int64_t deadline_ns) {
  const double now = controller_.time_s();
  const std::int64_t start_ns = now_ns();
  sent_ns_ = start_ns;
  const lwr::fri::MsrPacket& msr = controller_.measure();
  if (!line_.silent(now))
    line_.put(msr, now);
  for (;;) {
    const std::int64_t at_ns = now_ns();
    const double at_s = now + 1e-9 * static_cast<double>(at_ns - start_ns);
    while (const Line::Packet* packet = line_.silent(now) ? nullptr : line_.take(at_s + 1e-9))
      send(packet->msr);
    drain(std::nullopt, std::nullopt);
    if (at_ns >= deadline_ns)
      return;
    const double due = line_.next_due_s() - at_s;
    const nanoseconds to_due = due < 1.0
                                   ? nanoseconds(std::max<std::int64_t>(std::llround(1e9 * due), 0))
                                   : milliseconds(1000);
    socket_.wait(std::min(nanoseconds(deadline_ns - at_ns), to_due));
  }
}

bool Session::finished() const noexcept {
  return config_.duration_s && controller_.time_s() >= *config_.duration_s - 1e-9;
}

Ending Session::run(const std::atomic<bool>& stop) {
  const std::int64_t period_ns = seconds_as_ns(controller_.config().period_s).count();
  std::int64_t deadline_ns = now_ns();
  Ending ending = Ending::kStopped;
  while (!stop.load(std::memory_order_relaxed)) {
    if (finished()) {
      ending = Ending::kDuration;
      break;
    }
    if (controller_.config().virtual_time) {
      if (!virtual_period(stop, ending))
        break;
    } else {
      deadline_ns += period_ns;
      if (now_ns() > deadline_ns) {  // a whole period late: the clock waits rather than hurry after
        ++counts_.overruns;
        deadline_ns = now_ns() + period_ns;
      }
      real_period(deadline_ns);
    }
    controller_.advance();
    if (!controller_.finite()) {
      ending = Ending::kDiverged;
      break;
    }
    if (after_period)
      after_period(controller_);
  }
  send(controller_.close());
  return ending;
}

}  // namespace voxtouch::lwr_sim
