/// failover_campaign: loses rendering and coupling in contact, with a standby each, and tells how
/// soon the other one took over and what the force did. Exit status 1 if something did not hold.
#include <fmt/core.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <random>

#include "nodes/security/make_keys.hpp"
#include "tests/attack/failover/failover_round.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::attack {
namespace {

struct Options {
  std::vector<std::string> victims{"rendering", "coupling"}, how{"kill", "stop"};
  int times = 100;
  std::uint64_t seed = 1;
  std::string domain, scene = FailoverOptions{}.scene, motion = FailoverOptions{}.motion;
  std::vector<std::string> up;
  bool each = false, secured = false;
};

struct Row {
  std::map<int, int> periods;  ///< how many rounds took so many
  double step_n = 0.0, usual_n = 0.0, machine_ms = 0.0;
  int played = 0, stalled = 0, bad = 0, unforced = 0, answered_twice = 0, sent_late = 0;
};

int run(int argc, char** argv) {
  Options o;
  CLI::App app("Loses rendering and coupling while the hand feels a contact, with a standby each.");
  app.add_option("--victim", o.victims, "which")->check(CLI::IsMember(o.victims));
  app.add_option("--how", o.how, "kill (SIGKILL), stop (SIGSTOP, and on after 0.7 s)")
      ->check(CLI::IsMember(o.how));
  app.add_option("--times", o.times, "each (100: about forty minutes for all)")
      ->capture_default_str();
  app.add_option("--seed", o.seed, "of the moments")->capture_default_str();
  app.add_option("--domain", o.domain, "DDS domain (default: one that no other test holds)");
  app.add_option("--scene", o.scene, "a shipped one")->capture_default_str();
  app.add_option("--motion", o.motion, "of the scene")->capture_default_str();
  app.add_option(
         "--up", o.up,
         "an option of `voxtouch up`, such as --up=--realtime=off; may be given more than once")
      ->allow_extra_args(false);
  app.add_flag("--secured", o.secured, "under --security, with keys made for it");
  app.add_flag("--each", o.each, "a line for each round");
  CLI11_PARSE(app, argc, argv);
  if (o.domain.empty())
    o.domain = test::fresh_domain();
  const test::TemporaryFolder folder;
  if (o.secured)
    security::make_keys(folder / "keys", "haptic", 30);
  std::mt19937_64 random(o.seed);
  int bad = 0;
  for (const std::string& victim : o.victims)
    for (const std::string& how : o.how) {
      Row row;
      for (int n = 0; n < o.times; ++n) {
        FailoverOptions ask{.victim = victim,
                            .signal = how == "kill" ? SIGKILL : SIGSTOP,
                            .domain = static_cast<std::uint32_t>(std::stoul(o.domain))};
        ask.scene = o.scene, ask.motion = o.motion, ask.options = o.up;
        if (o.secured)
          ask.keys = folder / "keys";
        ask.after_ms = static_cast<int>(random() % 500);
        const FailoverResult r = play(ask);
        row.played += r.played, row.stalled += r.stalled, row.bad += !r.faults.empty();
        row.unforced += r.unforced, row.answered_twice += r.answered_twice,
            row.sent_late += r.sent_late;
        row.step_n = std::max(row.step_n, r.step_n),
        row.usual_n = std::max(row.usual_n, r.usual_step_n),
        row.machine_ms = std::max(row.machine_ms, r.machine_ms);
        if (r.played)
          ++row.periods[static_cast<int>(r.takeover_periods)];
        fmt::print(stderr, "\r{} {} {}/{} ", victim, how, n + 1, o.times);
        if (o.each)
          fmt::print(
              "{} {}: {:.0f} periods, {} without force, {} sent late, step {:.3f} N (usual {:.3f}, "
              "ramp {:.3f}), {} takeovers {}, machine {:.1f} ms{}\n",
              victim, how, r.takeover_periods, r.unforced, r.sent_late, r.step_n, r.usual_step_n,
              r.ramp_step_n, r.takeovers, r.who, r.machine_ms, r.stalled ? ", told apart" : "");
        for (const std::string& fault : r.faults)
          fmt::print("FAULT: {} {}, round {}: {}\n", victim, how, n, fault);
        std::fflush(stdout);
      }
      bad += row.bad;
      std::string spread;
      for (const auto& [periods, rounds] : row.periods)
        spread += fmt::format("{}{} periods {}x", spread.empty() ? "" : ", ", periods, rounds);
      fmt::print(
          "figure: {} {}: {} rounds, taken over after {}; {} samples without force, {} answered "
          "twice ({} sent late and refused), largest step {:.3f} N "
          "(between two samples before {:.3f} N), machine {:.1f} ms, {} told apart, {} bad\n",
          victim, how, row.played, spread, row.unforced, row.answered_twice, row.sent_late,
          row.step_n, row.usual_n, row.machine_ms, row.stalled, row.bad);
    }
  fmt::print(stderr, "\n");
  fmt::print("{}\n", bad == 0 ? "All is well." : "Not well.");
  return bad == 0 ? 0 : 1;
}

}  // namespace
}  // namespace voxtouch::attack

int main(int argc, char** argv) {
  try {
    return voxtouch::attack::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
