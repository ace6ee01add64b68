// garbage_rtps: datagrams that no RTPS stack should send, to the loopback ports of a DDS domain.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "tests/attack/network/garbage.hpp"
#include "tests/attack/network/ghost.hpp"

namespace {

using namespace voxtouch::attack;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

struct Options {
  std::uint32_t domain = 0;
  double seconds = 5.0, rate = 5000.0;
  std::uint64_t seed = 1, from = 0;
  std::vector<std::string> kinds = {std::begin(kGarbageNames), std::end(kGarbageNames)};
};

class Sender {
 public:
  Sender() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Sender() { close(fd_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  bool send(const Bytes& bytes, std::uint16_t port) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(port);
    return sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                  sizeof to) >= 0;
  }

 private:
  int fd_;
};

std::vector<Garbage> kinds_of(const Options& o) {
  std::vector<Garbage> kinds;
  for (std::size_t k = 0; k < std::size(kGarbageNames); ++k)
    if (std::find(o.kinds.begin(), o.kinds.end(), kGarbageNames[k]) != o.kinds.end())
      kinds.push_back(static_cast<Garbage>(k));
  return kinds;
}

int run(const Options& o) {
  const std::vector<Garbage> kinds = kinds_of(o);
  const Neighbours neighbours =
      listen_for_neighbours(o.domain, milliseconds(2000));  // each announces itself twice a second
  std::vector<std::uint16_t> ports(neighbours.ports.begin(), neighbours.ports.end());
  ports.push_back(discovery_port(o.domain));
  fmt::print("domain {}: {} participants on loopback, {} ports; seed {}, messages from {} on\n",
             o.domain, neighbours.prefixes.size(), ports.size(), o.seed, o.from);
  std::fflush(stdout);
  const Sender sender;
  std::array<std::uint64_t, std::size(kGarbageNames)> sent{};
  const auto start = Clock::now();
  const auto count = static_cast<std::uint64_t>(std::llround(o.seconds * o.rate));
  for (std::uint64_t n = 0; n < count; ++n) {
    std::this_thread::sleep_until(
        start + std::chrono::nanoseconds(std::llround(1e9 * static_cast<double>(n) / o.rate)));
    const Garbage kind = kinds[(o.from + n) % kinds.size()];
    const std::uint64_t i = (o.from + n) / kinds.size();  // of its kind
    const std::uint16_t port = ports[i / kGhostSteps % ports.size()];
    if (sender.send(make_garbage(kind, o.seed, i, neighbours), port))
      ++sent[static_cast<std::size_t>(kind)];
  }
  fmt::print("figure: sent in {:.1f} s:",
             std::chrono::duration<double>(Clock::now() - start).count());
  for (const Garbage kind : kinds)
    fmt::print(" {} {}", sent[static_cast<std::size_t>(kind)],
               kGarbageNames[static_cast<std::size_t>(kind)]);
  fmt::print("\n");
  return neighbours.prefixes.empty() ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Sends datagrams that no RTPS stack should send to the loopback ports of a DDS domain, whose "
      "participants it learns first by\n"
      "listening for two seconds. No process may end of it, and the ring goes on; only `spoofed` "
      "and `flipped`, which speak under a\n"
      "participant's own name, may disturb who receives whom. Exit status 1: none was there.");
  Options o;
  app.add_option("--domain", o.domain, "DDS domain")->required()->check(CLI::Range(0U, 200U));
  app.add_option("--seconds", o.seconds, "how long it sends")
      ->check(CLI::Range(0.0, 600.0))
      ->capture_default_str();
  app.add_option("--rate", o.rate, "messages a second")
      ->check(CLI::Range(1.0, 50000.0))
      ->capture_default_str();
  app.add_option("--seed", o.seed, "same seed, same messages but for the participants' own names")
      ->capture_default_str();
  app.add_option("--from", o.from, "number of the first message, to find one again")
      ->capture_default_str();
  app.add_option("--kinds", o.kinds, "of them only")
      ->delimiter(',')
      ->check(CLI::IsMember(o.kinds))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return run(o);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
