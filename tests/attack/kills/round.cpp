#include "tests/attack/kills/round.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

#include "tests/attack/kills/contact_ring.hpp"
#include "tests/attack/kills/leftovers.hpp"

namespace voxtouch::attack {
namespace {

using namespace std::chrono_literals;
constexpr double kMsPerNs = 1e-6;
constexpr double kBagLosesS = 1.0;       // at most
constexpr auto kStopped = 700ms;         // how long a node is stopped
constexpr double kCommandLivesMs = 3.0;  // a command is repeated this long before it fades

class Round {
 public:
  explicit Round(const RoundOptions& ask)
      : ask_(ask),
        names_before_(shared_names()),
        ring_({.scene = "cup",
               .motion = "slide",
               .rig = ask.rig,
               .domain = ask.domain,
               .more = ask.options}) {}

  RoundResult play() {
    result_.played = reach_contact();
    if (!result_.played) {
      result_.faults.push_back("the ring did not come into contact: " + ring_.refusal());
      return result_;
    }
    send();
    ask_.signal == SIGKILL ? after_kill() : after_stop();
    look_back();
    return result_;
  }

 private:
  /// Force for half a second, the start's ramp, and the present contact.
  bool reach_contact() {
    if (!ring_.reach_contact(700, std::chrono::milliseconds(ask_.after_ms)))
      return false;
    nodes_ = test::children_of(ring_.up().pid());
    return nodes_.size() == 5;
  }

  void send() {
    victim_ = ring_.up().pid();
    for (const pid_t node : nodes_)
      if (program_of(node) == "voxtouch_" + ask_.victim)
        victim_ = node;
    ring_.lose(victim_, ask_.victim == "none" ? 0 : ask_.signal);
    at_ns_ = ring_.lost_at_ns();
  }

  bool needed() const { return ask_.victim == "rendering" || ask_.victim == "coupling"; }

  void after_kill() {
    // A device that is ended in order ends at zero; its last sample may still report the force of
    // the one before.
    wait_until(
        [this] {
          return zero_at() || ask_.victim == "device" ||
                 !program_of(device()).starts_with("voxtouch_device");
        },
        3s);
    judge_zero();
    if (ask_.victim == "up" && !wait_until(
                                   [this] {
                                     return std::all_of(nodes_.begin(), nodes_.end(), [](pid_t p) {
                                       return program_of(p).empty();
                                     });
                                   },
                                   10s))
      result_.faults.push_back("nodes outlive `up`");
    finish();
    if (ask_.victim != "up" && result_.status == 0)
      result_.faults.push_back("the run is called good");
  }

  void after_stop() {
    if (needed()) {
      wait_until([this] { return zero_at().has_value(); }, 3s);
      judge_zero();
    }
    std::this_thread::sleep_for(kStopped);
    if (!needed() && ask_.victim != "device")
      judge_undisturbed();
    const std::int64_t on_ns = unix_ns();
    if (ask_.victim != "none")
      ::kill(victim_, SIGCONT);
    std::this_thread::sleep_for(300ms);
    if (ask_.victim == "device")
      judge_waking(on_ns);
    ring_.up().signal(SIGINT);
    finish();
    if (needed() && result_.status == 0)
      result_.faults.push_back("a run with a node that hung is called good");
  }

  pid_t device() const {
    for (const pid_t node : nodes_)
      if (program_of(node) == "voxtouch_device")
        return node;
    return 0;
  }

  /// The first sample after the signal that has no force.
  std::optional<Seen> zero_at() const {
    for (const Seen& s : ring_.seen())
      if (s.written_ns >= at_ns_ && !s.force_on)
        return s;
    return std::nullopt;
  }

  /// The device's clock at the signal: of the last sample written before it. Without one, of the
  /// first sample after it minus the time since.
  std::int64_t device_time_at_signal(const std::vector<Seen>& seen,
                                     std::vector<Seen>::const_iterator after) const {
    if (after != seen.begin())
      return (after - 1)->sample_ns;
    return after == seen.end() ? at_ns_ : after->sample_ns - (after->written_ns - at_ns_);
  }

  void judge_zero() {
    const std::vector<Seen> seen = ring_.seen();
    const auto after = std::find_if(seen.begin(), seen.end(),
                                    [this](const Seen& s) { return s.written_ns >= at_ns_; });
    if (ask_.victim == "device") {
      if (seen.end() - after > 3)
        result_.faults.push_back("a device that was killed gives samples");
      return;
    }
    const auto zero = std::find_if(after, seen.end(), [](const Seen& s) { return !s.force_on; });
    const auto last = zero == seen.end() ? seen.end() - 1 : zero;
    const std::int64_t from_ns = device_time_at_signal(seen, after);
    result_.zero_ms = kMsPerNs * static_cast<double>(last->sample_ns - from_ns);
    result_.zero_wall_ms = kMsPerNs * static_cast<double>(last->written_ns - at_ns_);
    std::int64_t before_ns = at_ns_, gap_ns = 0;
    for (auto s = after; s != seen.end() && s <= last; ++s)
      gap_ns = std::max(gap_ns, s->written_ns - std::exchange(before_ns, s->written_ns));
    result_.gap_ms = kMsPerNs * static_cast<double>(gap_ns);
    result_.machine_ms = ring_.machine_ms();
    result_.stalled =
        *result_.zero_ms > kZeroWithinMs && *result_.zero_ms - result_.machine_ms <= kZeroWithinMs;
    if (needed() && *result_.zero_ms > kZeroWithinMs && !result_.stalled)
      result_.faults.push_back(
          fmt::format("the device is at zero after {:.1f} ms of its samples", *result_.zero_ms));
    if (zero == seen.end() && program_of(device()) == "voxtouch_device" && needed())
      result_.faults.push_back("the device goes on with force");
  }

  /// A stopped listener must not affect the force. If the machine delayed a thread with the ring's
  /// priority for longer than commands are repeated, the machine is the cause.
  void judge_undisturbed() {
    for (const Seen& s : ring_.seen())
      result_.unforced += s.written_ns >= at_ns_ && !s.force_on;
    result_.machine_ms = ring_.machine_ms();
    result_.stalled = result_.unforced > 0 && result_.machine_ms > kCommandLivesMs;
    if (result_.unforced > 0 && !result_.stalled)
      result_.faults.push_back(
          fmt::format("{} samples were without force while {} stood still; the machine kept a "
                      "thread waiting for {:.1f} ms at most",
                      result_.unforced, ask_.victim, result_.machine_ms));
  }

  /// A resumed device must not continue with its old force: the hand has moved meanwhile.
  void judge_waking(std::int64_t on_ns) {
    int samples = 0;
    bool rested = false;
    for (const Seen& s : ring_.seen())
      if (s.written_ns >= on_ns && samples++ < 5)
        rested |= !s.force_on;
    if (samples > 0 && !rested)
      result_.faults.push_back("the device goes on with the force that it held");
  }

  void finish() {
    const test::Finished end = ring_.up().wait(30s);
    result_.status = end.status;
    said_ = end.out + end.err;
    if (ask_.victim == "device" && ask_.signal == SIGKILL &&
        end.out.find("device ended by signal 9") == std::string::npos)
      result_.faults.push_back("`up` does not say that the device was killed");
  }

  void look_back() {
    const std::vector<Seen> seen = ring_.seen();
    ring_.stop_listening();
    for (const pid_t node : nodes_)
      if (program_of(node).starts_with("voxtouch_"))
        result_.faults.push_back(program_of(node) + " is left behind");
    // Tests that run in parallel have such names too, for a moment: only permanent ones count.
    std::set<std::string> left;
    wait_until(
        [&] {
          std::erase_if(left = shared_names(),
                        [this](const std::string& name) { return names_before_.contains(name); });
          return left.empty();
        },
        2s);
    for (const std::string& name : left)
      result_.faults.push_back(name + " is left behind");
    // A process that ends gives up its memory, and with it its name, before its sockets.
    if (!wait_until([this] { return bound_ports(ask_.domain).empty(); }, 2s))
      result_.faults.push_back("a port of the domain is left behind");
    try {
      const auto states =
          test::read_ring_topic<msg::DeviceState>(ring_.bag(), "/" + ask_.rig + "/device/state");
      // Only while the logger was running.
      std::int64_t last_ns = 0;
      for (const Seen& s : seen)
        if (ask_.victim != "logger" || s.written_ns <= at_ns_ || ask_.signal == SIGSTOP)
          last_ns = s.sample_ns;
      result_.bag_lost_s = states.empty() ? 1e9
                                          : 1e-9 * static_cast<double>(std::max<std::int64_t>(
                                                       0, last_ns - states.back().sample_time_ns));
      if (*result_.bag_lost_s > kBagLosesS)
        result_.faults.push_back(
            fmt::format("the bag lacks the last {:.2f} s, where `up` ended with {} and said: {}",
                        *result_.bag_lost_s, result_.status, said_));
    } catch (const std::exception& error) {
      result_.faults.push_back(std::string("the bag does not open: ") + error.what());
    }
  }

  RoundOptions ask_;
  std::set<std::string> names_before_;
  ContactRing ring_;
  std::vector<pid_t> nodes_;
  pid_t victim_ = 0;
  std::int64_t at_ns_ = 0;
  std::string said_;  ///< by `up`, to its end
  RoundResult result_;
};

}  // namespace

RoundResult play(const RoundOptions& ask) { return Round(ask).play(); }

}  // namespace voxtouch::attack
