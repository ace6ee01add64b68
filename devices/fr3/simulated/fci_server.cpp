#include "devices/fr3/simulated/fci_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <thread>
#include <utility>

namespace voxtouch::fr3_sim {
namespace {

using fr3::fci::Outcome;
using fr3::fci::Request;
using std::chrono::nanoseconds;

constexpr nanoseconds kMillisecond = std::chrono::milliseconds(1);

}  // namespace

FciServer::FciServer(const ServerConfig& config, FciRobot& robot, Line line)
    : NetworkLoop(config, 0, kTick, config.virtual_time, robot, std::move(line)) {
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int on = 1;
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(*arm::parse_ipv4(config.address));
  own.sin_port = htons(config.port);
  if (bind(listener_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0 ||
      listen(listener_, 4) != 0) {
    const int error = errno;
    close(listener_);
    throw devices::DeviceOpenError(
        fmt::format("cannot listen on TCP {}:{}: {}; check for another robot at this address",
                    config.address, config.port, std::strerror(error)));
  }
  socklen_t size = sizeof own;
  getsockname(listener_, reinterpret_cast<sockaddr*>(&own), &size);
  port_ = ntohs(own.sin_port);
}

FciServer::~FciServer() {
  close_connection();
  close(listener_);
}

void FciServer::close_connection() noexcept {
  if (client_ >= 0)
    close(client_);
  client_ = -1;
  remote_ = {};
  motion_.reset();
  controller_.abandoned();
}

void FciServer::accept_clients() noexcept {
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const int file =
        accept4(listener_, reinterpret_cast<sockaddr*>(&from), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (file < 0)
      return;
    if (client_ >= 0) {
      close(file);
      continue;
    }
    const int on = 1;
    setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    client_ = file;
    remote_ = {ntohl(from.sin_addr.s_addr), 0};
    reader_ = std::make_unique<fr3::fci::StreamReader>();
    connected_once_ = true;
  }
}

void FciServer::send_message(const fr3::fci::Message& message) noexcept {
  if (client_ >= 0)
    (void)::send(client_, message.span().data(), message.size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

/// Departures are processed first: consecutive programs do not count as simultaneous.
void FciServer::read_channel() noexcept {
  read_client();
  accept_clients();
  read_client();
}

void FciServer::read_client() noexcept {
  if (controller_.faults().active(FaultKind::kClosed, controller_.time_s())) {
    if (!std::exchange(closed_done_, true))
      close_connection();
  }
  while (client_ >= 0) {
    if (const auto message = reader_->next()) {
      handle(*message);
      continue;
    }
    const std::span<std::byte> room = reader_->room();
    const ssize_t got = recv(client_, room.data(), room.size(), MSG_DONTWAIT);
    if (got > 0)
      reader_->took(static_cast<std::size_t>(got));
    else if (got == 0 || (errno != EAGAIN && errno != EINTR) || reader_->broken())
      return close_connection();
    else if (errno == EAGAIN)
      return;
  }
}

void FciServer::handle(const fr3::fci::Received& message) noexcept {
  const fr3::fci::Dialect& dialect = controller_.dialect();
  const auto request = fr3::fci::request_of(dialect, message.command);
  if (!request)
    return;
  if (*request == Request::kConnect) {
    std::uint16_t version = 0, port = 0;
    std::memcpy(&version, &message.body[0], sizeof version);
    std::memcpy(&port, &message.body[2], sizeof port);
    const bool accepted = version == dialect.version;
    send_message(fr3::fci::connect_answer(message.id, accepted, dialect.version));
    if (!accepted)
      return close_connection();
    remote_.port = port;
    return;
  }
  const Outcome outcome = controller_.request(*request, message);
  if (*request == Request::kMove && outcome == Outcome::kStarted)
    motion_ = message.id;
  send_message(fr3::fci::answer(dialect, *request, message.id, outcome));
  answer_ended_motion();
}

void FciServer::answer_ended_motion() noexcept {
  const auto ended = controller_.motion_ended();
  if (!ended || !motion_)
    return;
  send_message(fr3::fci::answer(controller_.dialect(), Request::kMove, *motion_, *ended));
  motion_.reset();
}

std::span<const std::byte> FciServer::encode(const fr3::fci::State& state) noexcept {
  return std::span(bytes_).first(fr3::fci::encode(controller_.dialect(), state, bytes_));
}

std::optional<std::uint64_t> FciServer::answered(
    std::span<const std::byte> datagram) const noexcept {
  std::uint64_t id = 0;
  if (datagram.size() < sizeof id)
    return std::nullopt;
  std::memcpy(&id, datagram.data(), sizeof id);
  return id;
}

void FciServer::wait_for_input(nanoseconds most) noexcept {
  // The UDP socket blocks on its own; the channel is polled often enough in between.
  if (serving())
    return void(socket_.wait(std::min(most, kMillisecond)));
  std::array<pollfd, 2> files{{{listener_, POLLIN, 0}, {client_, POLLIN, 0}}};
  const timespec limit{0, most.count()};
  ppoll(files.data(), client_ >= 0 ? 2 : 1, &limit, nullptr);
}

bool FciServer::virtual_period(const std::atomic<bool>& stop, Ending& ending) {
  while (!serving()) {
    if (stop.load(std::memory_order_relaxed))
      return false;
    if (client_ < 0 &&
        connected_once_) {  // after the last client has left, the time of the arm follows the clock
      std::this_thread::sleep_for(kMillisecond);
      read_channel();
      if (client_ < 0)
        return controller_.measure(), true;
      continue;
    }
    wait_for_input(arm_sim::kPollPeriod);
    read_channel();
  }
  const double now = controller_.time_s(), until = now + kTick * (1.0 - 1e-6);
  const bool silent = line_.silent(now);
  const fr3::fci::State& state = controller_.measure();
  if (silent) {
    std::this_thread::sleep_for(kMillisecond);
    drain();
    read_channel();
    return true;
  }
  line_.put(state, now);
  bool sent = false;
  send_due(until, [&](const Line::Packet& packet) {
    newest_ = std::max(newest_.value_or(0), packet.msr.message_id);
    sent = true;
  });
  if (!sent)
    return read_channel(), true;
  const auto patience =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(config_.patience_s);
  while (serving() && !drain(newest_)) {
    if (stop.load(std::memory_order_relaxed))
      return false;
    if (std::chrono::steady_clock::now() > patience)
      return ending = Ending::kNoAnswer, false;
    read_channel();
    if (serving())
      wait_for_input(arm_sim::kPollPeriod);
  }
  read_channel();  // requests sent earlier than the command
  return true;
}

}  // namespace voxtouch::fr3_sim
