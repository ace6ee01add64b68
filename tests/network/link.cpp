/// emulated_link: a network switch between cards with delay and loss, in user space. A received
/// frame is forwarded after the delay, in order, to the card behind which its receiver was last
/// seen, or to all others. Each is lost with the probability, by a seeded generator. Lines on stdin
/// change it at run time. "cut" loses all frames and "heal" ends that; both print their Unix time.
/// "no multicast" loses multicast from then on (not broadcasts, which resolve addresses). "end"
/// ends the program, which prints the numbers of forwarded and lost frames. usage: emulated_link
/// DELAY_MS LOSS SEED CARD CARD...
#include <arpa/inet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <netpacket/packet.h>
#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Address = std::array<unsigned char, ETH_ALEN>;

int open_card(const char* name) {
  const int card = socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK, htons(ETH_P_ALL));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(if_nametoindex(name));
  packet_mreq all{.mr_ifindex = address.sll_ifindex,
                  .mr_type = PACKET_MR_PROMISC,
                  .mr_alen = 0,
                  .mr_address = {}};
  if (card < 0 || address.sll_ifindex == 0 ||
      bind(card, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      setsockopt(card, SOL_PACKET, PACKET_ADD_MEMBERSHIP, &all, sizeof all) != 0)
    throw std::runtime_error(std::string("the card ") + name + " cannot be opened");
  return card;
}

struct Frame {
  Clock::time_point due;
  std::size_t from;  ///< card
  std::vector<char> bytes;

  Address address(std::size_t at) const {
    Address found;
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), found.size(),
                reinterpret_cast<char*>(found.data()));
    return found;
  }
  Address receiver() const { return address(0); }
  Address sender() const { return address(ETH_ALEN); }
};

/// To a group of hosts, and not to all.
bool is_multicast(const Address& receiver) {
  return (receiver[0] & 1U) != 0 &&
         std::ranges::any_of(receiver, [](unsigned char byte) { return byte != 0xff; });
}

class Link {
 public:
  Link(double delay_ms, double loss, std::uint64_t seed, const std::vector<const char*>& cards)
      : delay_(std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double, std::milli>(delay_ms))),
        lost_(loss),
        random_(seed) {
    for (const char* card : cards)
      polled_.push_back({open_card(card), POLLIN, 0});
    polled_.push_back({STDIN_FILENO, POLLIN, 0});
  }

  void run() {
    while (!ended_) {
      const timespec patience = until_next();
      ppoll(polled_.data(), polled_.size(), &patience, nullptr);
      if (polled_.back().revents)
        obey();
      for (std::size_t card = 0; card < cards(); ++card)
        if (polled_[card].revents)
          take(card);
      for (; !queue_.empty() && queue_.front().due <= Clock::now(); queue_.pop_front())
        give(queue_.front());
    }
    std::printf("%lu frames carried, %lu lost\n", carried_, dropped_);
  }

 private:
  std::size_t cards() const { return polled_.size() - 1; }

  timespec until_next() const {
    Clock::duration wait = std::chrono::milliseconds(100);
    if (!queue_.empty())
      wait = std::clamp(queue_.front().due - Clock::now(), Clock::duration::zero(), wait);
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(wait).count();
    return {ns / 1'000'000'000, ns % 1'000'000'000};
  }

  void take(std::size_t card) {
    std::array<char, 65536> bytes;
    for (;;) {
      sockaddr_ll from{};
      socklen_t size = sizeof from;
      const ssize_t count = recvfrom(polled_[card].fd, bytes.data(), bytes.size(), 0,
                                     reinterpret_cast<sockaddr*>(&from), &size);
      if (count <= 0)
        return;
      if (from.sll_pkttype == PACKET_OUTGOING || count < static_cast<ssize_t>(sizeof(ether_header)))
        continue;  // ours
      Frame frame{Clock::now() + delay_, card, {bytes.begin(), bytes.begin() + count}};
      behind_[frame.sender()] = card;
      if (no_multicast_ && is_multicast(frame.receiver()))
        continue;
      if (cut_ || lost_(random_))
        ++dropped_;
      else
        queue_.push_back(std::move(frame));
    }
  }

  void give(const Frame& frame) {
    const auto known = behind_.find(frame.receiver());
    for (std::size_t card = 0; card < cards(); ++card)
      if (card != frame.from && (known == behind_.end() || known->second == card))
        carried_ += send(polled_[card].fd, frame.bytes.data(), frame.bytes.size(), 0) > 0;
  }

  void obey() {
    std::array<char, 256> text{};
    const ssize_t count = read(STDIN_FILENO, text.data(), text.size());
    if (count <= 0)
      ended_ = true;
    std::istringstream lines(
        std::string(text.data(), count > 0 ? static_cast<std::size_t>(count) : 0));
    for (std::string line; std::getline(lines, line);) {
      if (line == "end")
        ended_ = true;
      if (line == "cut" || line == "heal") {
        cut_ = line == "cut";
        const auto now = std::chrono::system_clock::now().time_since_epoch();
        std::printf("%s %.6f\n", line.c_str(), std::chrono::duration<double>(now).count());
        std::fflush(stdout);
      }
      if (line == "no multicast")
        no_multicast_ = true;
    }
  }

  std::vector<pollfd> polled_;  ///< the cards, and stdin behind them
  Clock::duration delay_;
  std::bernoulli_distribution lost_;
  std::mt19937_64 random_;
  std::deque<Frame> queue_;
  std::map<Address, std::size_t> behind_;  ///< which card a host was received at
  unsigned long carried_ = 0, dropped_ = 0;
  bool cut_ = false, no_multicast_ = false, ended_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) {
    std::fprintf(stderr, "usage: emulated_link DELAY_MS LOSS SEED CARD CARD...\n");
    return 1;
  }
  const sched_param first{.sched_priority = 60};
  sched_setscheduler(0, SCHED_FIFO,
                     &first);  // if permitted: the link is not part of the measurement
  try {
    Link(std::atof(argv[1]), std::atof(argv[2]), std::strtoull(argv[3], nullptr, 10),
         {argv + 4, argv + argc})
        .run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
