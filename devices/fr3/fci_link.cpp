#include "devices/fr3/fci_link.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

namespace voxtouch::fr3 {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kGlanceMs = 50;

/// Returns true if data (or the end) is available, false after the time.
bool wait_for(int file, short what, int milliseconds) noexcept {
  pollfd requested{file, what, 0};
  return ::poll(&requested, 1, milliseconds) > 0;
}

std::string advice(int error, const std::string& address) {
  if (error == ECONNREFUSED)
    return "connection refused: activate FCI on its web page (https://" + address +
           "), with the joints unlocked";
  if (error == ETIMEDOUT || error == EHOSTUNREACH || error == ENETUNREACH)
    return "check the option 'address', the cable, this machine's address in the robot's network, "
           "and 'ping " +
           address + "'";
  return "check the option 'address' and the network";
}

}  // namespace

FciLink::FciLink(const std::string& address, std::uint16_t port, double timeout_s,
                 const std::atomic<bool>* cancelled) {
  const auto host = arm::parse_ipv4(address);
  if (!host)
    throw devices::DeviceOpenError(
        fmt::format("device 'fr3': '{}' is not an IPv4 address, such as 172.16.0.2", address));
  robot_ = {*host, port};
  file_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (file_ < 0)
    throw devices::DeviceOpenError(
        fmt::format("device 'fr3': cannot create a TCP socket: {}", std::strerror(errno)));
  const int on = 1;
  setsockopt(file_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  setsockopt(file_, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(*host);
  to.sin_port = htons(port);
  int error = connect(file_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0 ? 0 : errno;
  for (const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
       error == EINPROGRESS;) {
    const bool ready = wait_for(file_, POLLOUT, kGlanceMs);
    socklen_t size = sizeof error;
    if (ready)
      getsockopt(file_, SOL_SOCKET, SO_ERROR, &error, &size);
    if (!ready && Clock::now() > end)
      error = ETIMEDOUT;
    if (cancelled && cancelled->load()) {
      close(file_);
      throw devices::DeviceOpenError("device 'fr3': cancelled while waiting for the robot");
    }
  }
  if (error == 0)
    return;
  close(file_);
  throw devices::DeviceOpenError(
      fmt::format("device 'fr3': no connection to a robot at TCP {}:{} ({}): {}", address, port,
                  std::strerror(error), advice(error, address)));
}

FciLink::~FciLink() { close(file_); }

std::string FciLink::own_address() const {
  sockaddr_in own{};
  socklen_t size = sizeof own;
  getsockname(file_, reinterpret_cast<sockaddr*>(&own), &size);
  const std::string text = arm::text_of({ntohl(own.sin_addr.s_addr), 0});
  return text.substr(0, text.rfind(':'));
}

bool FciLink::send(const fci::Message& message) noexcept {
  if (closed_)
    return false;
  const std::span<const std::byte> bytes = message.span();
  const ssize_t sent = ::send(file_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  closed_ =
      sent != static_cast<ssize_t>(
                  bytes.size());  // requests are short: if one does not fit, the peer does not read
  return !closed_;
}

std::optional<fci::Received> FciLink::poll() noexcept {
  for (;;) {
    if (auto message = reader_.next())
      return message;
    if (closed_ || reader_.broken())
      return closed_ = true, std::nullopt;
    const std::span<std::byte> room = reader_.room();
    const ssize_t got = recv(file_, room.data(), room.size(), MSG_DONTWAIT);
    if (got > 0) {
      reader_.took(static_cast<std::size_t>(got));
      continue;
    }
    if (got < 0 && errno == EINTR)
      continue;
    if (got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK))
      closed_ = true;
    return std::nullopt;
  }
}

std::optional<fci::Received> FciLink::wait(double timeout_s) noexcept {
  for (const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);;) {
    if (auto message = poll())
      return message;
    if (closed_ || Clock::now() > end)
      return std::nullopt;
    wait_for(file_, POLLIN, kGlanceMs);
  }
}

}  // namespace voxtouch::fr3
