/// emulated_link: a network link between two cards with delay and loss, in user space. Frames that come in at one card leave the other one
/// after the delay, in order; each is lost with the probability, by a seeded generator. Lines on stdin change it while it runs: "cut" loses all,
/// "heal" ends that, "end" ends the program, which then says how many frames it carried and lost.
/// usage: emulated_link CARD CARD DELAY_MS LOSS SEED
#include <arpa/inet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <netpacket/packet.h>
#include <poll.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

int open_card(const char* name) {
  const int card = socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK, htons(ETH_P_ALL));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(if_nametoindex(name));
  packet_mreq all{.mr_ifindex = address.sll_ifindex, .mr_type = PACKET_MR_PROMISC, .mr_alen = 0, .mr_address = {}};
  if (card < 0 || address.sll_ifindex == 0 || bind(card, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      setsockopt(card, SOL_PACKET, PACKET_ADD_MEMBERSHIP, &all, sizeof all) != 0)
    throw std::runtime_error(std::string("the card ") + name + " cannot be opened");
  return card;
}

struct Frame {
  Clock::time_point due;
  std::vector<char> bytes;
};

class Link {
 public:
  Link(const char* left, const char* right, double delay_ms, double loss, std::uint64_t seed)
      : cards_{open_card(left), open_card(right)}, delay_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::milli>(delay_ms))),
        lost_(loss), random_(seed) {}

  void run() {
    while (!ended_) {
      std::array<pollfd, 3> all{pollfd{cards_[0], POLLIN, 0}, pollfd{cards_[1], POLLIN, 0}, pollfd{STDIN_FILENO, POLLIN, 0}};
      const timespec patience = until_next();
      ppoll(all.data(), all.size(), &patience, nullptr);
      if (all[2].revents) obey();
      for (std::size_t side : {0U, 1U}) {
        if (all[side].revents) take(side);
        give(side);
      }
    }
    std::printf("%lu frames carried, %lu lost\n", carried_, dropped_);
  }

 private:
  timespec until_next() const {
    Clock::duration wait = std::chrono::milliseconds(100);
    for (const auto& queue : queues_)
      if (!queue.empty()) wait = std::min(wait, std::max(queue.front().due - Clock::now(), Clock::duration::zero()));
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(wait).count();
    return {ns / 1'000'000'000, ns % 1'000'000'000};
  }

  void take(std::size_t side) {
    std::array<char, 65536> bytes;
    for (;;) {
      sockaddr_ll from{};
      socklen_t size = sizeof from;
      const ssize_t count = recvfrom(cards_[side], bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
      if (count <= 0) return;
      if (from.sll_pkttype == PACKET_OUTGOING) continue;  // ours
      if (cut_ || lost_(random_)) {
        ++dropped_;
        continue;
      }
      queues_[side].push_back({Clock::now() + delay_, {bytes.begin(), bytes.begin() + count}});
    }
  }

  void give(std::size_t side) {
    for (auto& queue = queues_[side]; !queue.empty() && queue.front().due <= Clock::now(); queue.pop_front()) {
      carried_ += send(cards_[1 - side], queue.front().bytes.data(), queue.front().bytes.size(), 0) > 0;
    }
  }

  void obey() {
    std::array<char, 64> text{};
    const ssize_t count = read(STDIN_FILENO, text.data(), text.size() - 1);
    const std::string word(text.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
    ended_ = count <= 0 || word.starts_with("end");
    if (word.starts_with("cut")) cut_ = true;
    if (word.starts_with("heal")) cut_ = false;
  }

  std::array<int, 2> cards_;
  Clock::duration delay_;
  std::bernoulli_distribution lost_;
  std::mt19937_64 random_;
  std::array<std::deque<Frame>, 2> queues_;  ///< by the card that they came in at
  unsigned long carried_ = 0, dropped_ = 0;
  bool cut_ = false, ended_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: emulated_link CARD CARD DELAY_MS LOSS SEED\n");
    return 1;
  }
  const sched_param first{.sched_priority = 60};
  sched_setscheduler(0, SCHED_FIFO, &first);  // where it is allowed: the link is no part of what is measured
  try {
    Link(argv[1], argv[2], std::atof(argv[3]), std::atof(argv[4]), std::strtoull(argv[5], nullptr, 10)).run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
