#include "tests/attack/failover/failover_round.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <thread>

#include "nodes/runtime/standby.hpp"
#include "tests/attack/kills/felt_ring.hpp"
#include "tests/attack/kills/leftovers.hpp"

namespace voxtouch::attack {
namespace {

using namespace std::chrono_literals;
constexpr auto kStopped = 700ms;  // how long a node stands still
constexpr double kMaxPeriods = 5.0;
constexpr double kRampS = 0.1;  // of the force guard, after a fade
constexpr double kPeriodMs = 1.0;
constexpr int kMaxTold = 10;  // samples named in a sentence

std::vector<std::string> with_standby(const std::vector<std::string>& options) {
  std::vector<std::string> words = test::on_a_busy_machine();
  words.push_back("--standby");
  words.insert(words.end(), options.begin(), options.end());
  return words;
}

double step(const msg::ForceCommand& a, const msg::ForceCommand& b) {
  const auto &f = a.wrench.force, &g = b.wrench.force;
  return std::hypot(f.x - g.x, f.y - g.y, f.z - g.z);
}

bool has_argument(pid_t pid, const std::string& wanted) {
  std::ifstream command("/proc/" + std::to_string(pid) + "/cmdline");
  for (std::string word; std::getline(command, word, '\0');)
    if (word == wanted)
      return true;
  return false;
}

/// The one that was started first, not its standby, which is the same program.
pid_t find_first(pid_t up, const std::string& role) {
  for (const pid_t child : test::children_of(up))
    if (program_of(child) == "voxtouch_" + role && !has_argument(child, "--standby"))
      return child;
  return 0;
}

class Round {
 public:
  explicit Round(const FailoverOptions& ask)
      : ask_(ask),
        ring_({.scene = ask.scene,
               .motion = ask.motion,
               .domain = ask.domain,
               .more = with_standby(ask.options),
               .keys = ask.keys}) {}

  FailoverResult play() {
    result_.played = reach_contact();
    if (!result_.played) {
      result_.faults.push_back("the ring did not come into contact with both standbys known: " +
                               ring_.why_not());
      return result_;
    }
    victim_ = find_first(ring_.up().pid(), ask_.victim);
    if (ask_.up_waits)
      ring_.up().signal(SIGSTOP);
    ring_.lose(victim_, ask_.signal);
    at_ns_ = ring_.lost_at_ns();
    std::this_thread::sleep_for(kStopped);
    result_.machine_ms = ring_.machine_ms();
    if (ask_.signal == SIGSTOP) {
      ::kill(victim_, SIGCONT);
      std::this_thread::sleep_for(kStopped);
    }
    end_ns_ = unix_ns();
    ring_.up().signal(SIGINT);
    if (ask_.up_waits)
      ring_.up().signal(SIGCONT);
    finish();
    look_back();
    return result_;
  }

 private:
  /// Both pairs are known, force for half a second (the start's ramp), and the contact is felt now.
  bool reach_contact() {
    registry_participant_.emplace(ring_.joined("watcher"));
    runtime::NodeRegistry registry(*registry_participant_, "haptic");
    const auto both_named = [&] {
      registry.update();
      const auto names = [&](const char* role) {
        const auto report = registry.find(role);
        return report && runtime::named_standby(*report).participant.has_value();
      };
      return names("rendering") && names("coupling");
    };
    return ring_.reach_contact(1000, std::chrono::milliseconds(200 + ask_.after_ms), both_named);
  }

  void finish() {
    const test::Finished end = ring_.up().wait(30s);
    result_.status = end.status;
    const nlohmann::json summary = test::parse_summary(end.out);
    if (!summary.is_object())
      return result_.faults.push_back("`up` gave no summary: " + end.err);
    if (ask_.signal == SIGKILL && result_.status != 1)
      result_.faults.push_back("a run in which a node was lost is called good");
    const std::string other = ask_.victim + "_standby";
    if (summary.contains("takeovers"))
      for (const nlohmann::json& takeover : summary["takeovers"])
        result_.takeovers += takeover["times"].get<std::uint64_t>();
    if (summary.contains("takeovers"))
      result_.who = summary["takeovers"].dump();
    if (ask_.signal == SIGKILL &&
        end.out.find(fmt::format("{} was ended by signal 9; {}", ask_.victim, other)) ==
            std::string::npos)
      result_.faults.push_back("`up` does not say who was lost and who goes on: " +
                               summary["problems"].dump());
    for (const nlohmann::json& problem : summary["problems"])
      if (problem.get<std::string>().find("was ended by signal 9; ") == std::string::npos)
        result_.faults.push_back("`up` says: " + problem.get<std::string>());
    answered_ = summary["answered"].get<std::uint64_t>();
  }

  /// By the bag: what the device wrote, and every command that was sent.
  void look_back() {
    const auto states =
        test::read_ring_topic<msg::DeviceState>(ring_.bag(), "/haptic/device/state");
    const auto sent =
        test::read_ring_topic<msg::ForceCommand>(ring_.bag(), "/haptic/coupling/command");
    std::uint64_t lost = 0, end = 0;
    for (const Seen& seen : ring_.seen()) {
      if (seen.written_ns <= at_ns_)
        lost = seen.sequence;
      if (seen.written_ns <= end_ns_)
        end = seen.sequence;
    }
    std::map<std::uint64_t, msg::ForceCommand>
        commands;  // the device takes what is newer than all before
    for (const msg::ForceCommand& c : sent) {
      if (commands.empty() || c.sequence_number > commands.rbegin()->first)
        commands.emplace(c.sequence_number, c);
      else
        ++result_.sent_late;
    }
    // The bag may lack some; there were at most so many to answer, those that nobody answered in
    // the takeover among them.
    const std::uint64_t most =
        commands.empty() ? 0 : commands.rbegin()->first - commands.begin()->first + 1;
    if (answered_ > most)
      result_.answered_twice = static_cast<int>(answered_ - most);
    judge_gap(commands, lost, end);
    std::string unforced;  // how many samples after the loss
    for (const msg::DeviceState& s : states)
      if (s.sequence_number >= lost && s.sequence_number <= end &&
          (s.flags & msg::device_state::kFlagForceOn) == 0) {
        if (++result_.unforced <= kMaxTold)
          unforced += fmt::format(" {}", s.sequence_number - lost);
      }
    result_.stalled = result_.machine_ms > kPeriodMs;
    const bool excused = result_.stalled;
    if (result_.takeover_periods > kMaxPeriods && !excused)
      result_.faults.push_back(fmt::format(
          "the takeover took {} periods; the machine kept a thread waiting for {:.1f} ms",
          result_.takeover_periods, result_.machine_ms));
    if (result_.unforced > 0 && !excused)
      result_.faults.push_back(fmt::format("{} samples were without force, of {} after the loss:{}",
                                           result_.unforced, end - lost, unforced));
    if (result_.answered_twice > 0)
      result_.faults.push_back(fmt::format("the device took {} answers more than there are samples",
                                           result_.answered_twice));
    if (result_.takeovers == 0)
      result_.faults.push_back("nobody took over");
    if (result_.step_n > std::max(result_.ramp_step_n,
                                  result_.usual_step_n * std::max(1.0, result_.takeover_periods)) &&
        !excused)
      result_.faults.push_back(
          fmt::format("the force stepped by {:.3f} N, where the ramp allows {:.3f} N",
                      result_.step_n, result_.ramp_step_n));
  }

  /// The largest gap between two answered samples from shortly before the signal on.
  void judge_gap(const std::map<std::uint64_t, msg::ForceCommand>& commands, std::uint64_t lost,
                 std::uint64_t end) {
    constexpr double kMaxN = 8.5;  // of the simulated Phantom
    for (auto next = commands.upper_bound(lost > 1000 ? lost - 1000 : 0); next != commands.end();
         ++next) {
      if (next == commands.begin())
        continue;
      const auto before = std::prev(next);
      const std::uint64_t periods = next->first - before->first;
      if (next->first < lost - 5) {
        if (periods == 1)
          result_.usual_step_n = std::max(result_.usual_step_n, step(before->second, next->second));
      } else if (next->first <= end && static_cast<double>(periods) > result_.takeover_periods) {
        result_.takeover_periods = static_cast<double>(periods);
        result_.step_n = step(before->second, next->second);
        result_.ramp_step_n = kMaxN * static_cast<double>(periods) * 1e-3 * kPeriodMs / kRampS;
      }
    }
  }

  FailoverOptions ask_;
  FeltRing ring_;
  std::optional<bus::Participant> registry_participant_;
  pid_t victim_ = 0;
  std::int64_t at_ns_ = 0, end_ns_ = 0;
  std::uint64_t answered_ = 0;
  FailoverResult result_;
};

}  // namespace

FailoverResult play(const FailoverOptions& ask) { return Round(ask).play(); }

}  // namespace voxtouch::attack
