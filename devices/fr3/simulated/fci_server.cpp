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
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <utility>

namespace voxtouch::fr3_sim {
namespace {

using Clock = std::chrono::steady_clock;
using fr3::fci::Outcome;
using fr3::fci::Request;

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kPollPeriod =
    50 * kMillisecond;  // a stop is noticed after this, at the latest

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
      .count();
}

}  // namespace

FciServer::FciServer(const ServerConfig& config, FciRobot& robot, Line line)
    : config_(config),
      robot_(robot),
      line_(std::move(line)),
      socket_(config.address, 0) {
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
        fmt::format("cannot listen on TCP {}:{}: {}; is another robot there?", config.address,
                    config.port, std::strerror(error)));
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
  robot_.abandoned();
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
    ++counts_.connections;
  }
}

void FciServer::send_message(const fr3::fci::Message& message) noexcept {
  if (client_ >= 0)
    (void)::send(client_, message.span().data(), message.size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

/// Who has gone is noticed before who comes: one program after the other is not two at a time.
void FciServer::read_channel() noexcept {
  read_client();
  accept_clients();
  read_client();
}

void FciServer::read_client() noexcept {
  if (robot_.faults().active(FaultKind::kClosed, robot_.time_s())) {
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
  const fr3::fci::Dialect& dialect = robot_.dialect();
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
  const Outcome outcome = robot_.request(*request, message);
  if (*request == Request::kMove && outcome == Outcome::kStarted)
    motion_ = message.id;
  send_message(fr3::fci::answer(dialect, *request, message.id, outcome));
  if (const auto ended = robot_.motion_ended(); ended && motion_) {
    send_message(fr3::fci::answer(dialect, Request::kMove, *motion_, *ended));
    motion_.reset();
  }
}

/// What leaves before `until_s` leaves now. False: nothing did.
bool FciServer::send_due(double until_s) noexcept {
  bool sent = false;
  while (const Line::Packet* packet = line_.take(until_s)) {
    std::array<std::byte, fr3::fci::kMaxStateBytes> bytes;
    const std::size_t size = fr3::fci::encode(robot_.dialect(), packet->msr, bytes);
    ++(socket_.send(std::span(bytes).first(size), remote_) ? counts_.sent : counts_.send_errors);
    newest_ = std::max(newest_.value_or(0), packet->msr.message_id);
    sent = true;
  }
  return sent;
}

/// True: the command that names `awaited` was among them.
bool FciServer::take_commands(std::optional<std::uint64_t> awaited) noexcept {
  std::array<std::byte, 2048> buffer;
  bool found = false;
  while (const auto datagram = socket_.receive(buffer)) {
    if (datagram->from != remote_) {
      ++counts_.foreign;
      continue;
    }
    ++counts_.received;
    const double now = robot_.time_s();
    if (line_.silent(now))
      continue;
    const std::size_t size = std::min(datagram->size, buffer.size());
    std::uint64_t id = 0;
    if (size >= sizeof id)
      std::memcpy(&id, buffer.data(), sizeof id);
    found = found || (awaited && id == *awaited);
    if (!line_.loses_answer(now))
      robot_.receive(std::span(buffer).first(size));
  }
  return found;
}

void FciServer::wait_for_input(std::int64_t ns) noexcept {
  std::array<pollfd, 2> files{{{listener_, POLLIN, 0}, {client_, POLLIN, 0}}};
  // The UDP socket waits for itself; the channel is looked at often enough beside it.
  if (serving()) {
    socket_.wait(std::chrono::nanoseconds(std::min(ns, kMillisecond)));
  } else {
    const timespec limit{ns / 1'000'000'000, ns % 1'000'000'000};
    ppoll(files.data(), client_ >= 0 ? 2 : 1, &limit, nullptr);
  }
}

bool FciServer::virtual_period(const std::atomic<bool>& stop, Ending& ending) {
  while (!serving()) {
    if (stop.load(std::memory_order_relaxed))
      return false;
    if (client_ < 0 && counts_.connections >
                           0) {  // after the last one has gone the arm's time goes on by the clock
      const timespec pause{0, kMillisecond};
      nanosleep(&pause, nullptr);
      read_channel();
      if (client_ < 0)
        return robot_.measure(), true;
      continue;
    }
    wait_for_input(kPollPeriod);
    read_channel();
  }
  const double now = robot_.time_s(), until = now + kTick * (1.0 - 1e-6);
  const bool silent = line_.silent(now);
  const fr3::fci::State& state = robot_.measure();
  if (silent) {
    const timespec pause{0, kMillisecond};
    nanosleep(&pause, nullptr);
    take_commands(std::nullopt);
    read_channel();
    return true;
  }
  line_.put(state, now);
  if (!send_due(until))
    return read_channel(), true;
  const auto patience = Clock::now() + std::chrono::duration<double>(config_.patience_s);
  while (serving() && !take_commands(newest_)) {
    if (stop.load(std::memory_order_relaxed))
      return false;
    if (Clock::now() > patience)
      return ending = Ending::kNoAnswer, false;
    read_channel();
    if (serving())
      wait_for_input(kPollPeriod);
  }
  read_channel();  // what was asked for before the command was sent
  return true;
}

void FciServer::real_period(std::int64_t deadline_ns) {
  read_channel();
  const double now = robot_.time_s();
  const std::int64_t start_ns = now_ns();
  const fr3::fci::State& state = robot_.measure();
  if (serving() && !line_.silent(now))
    line_.put(state, now);
  for (;;) {
    const std::int64_t at_ns = now_ns();
    const double at_s = now + 1e-9 * static_cast<double>(at_ns - start_ns);
    if (serving() && !line_.silent(now))
      send_due(at_s + 1e-9);
    take_commands(std::nullopt);
    if (at_ns >= deadline_ns)
      return;
    const double due_s = std::max(line_.next_due_s() - at_s, 0.0);
    const std::int64_t to_due = due_s < 1.0 ? std::llround(1e9 * due_s) : kMillisecond;
    socket_.wait(std::chrono::nanoseconds(std::min(deadline_ns - at_ns, to_due)));
  }
}

Ending FciServer::run(const std::atomic<bool>& stop) {
  std::int64_t deadline_ns = now_ns();
  Ending ending = Ending::kStopped;
  while (!stop.load(std::memory_order_relaxed)) {
    if (config_.virtual_time) {
      if (!virtual_period(stop, ending))
        break;
    } else {
      deadline_ns += kMillisecond;
      if (now_ns() > deadline_ns) {  // a whole period late: the clock waits rather than hurry after
        ++counts_.overruns;
        deadline_ns = now_ns() + kMillisecond;
      }
      real_period(deadline_ns);
    }
    robot_.advance();
    if (const auto ended = robot_.motion_ended(); ended && motion_) {
      send_message(fr3::fci::answer(robot_.dialect(), Request::kMove, *motion_, *ended));
      motion_.reset();
    }
    if (!robot_.finite())
      return Ending::kDiverged;
    if (after_period)
      after_period(robot_);
  }
  return ending;
}

}  // namespace voxtouch::fr3_sim
