/// kill_campaign: kills and stops each process of the ring in contact; reports the time to zero
/// force and what was left. Exit status 1 if a check failed.
#include <fmt/core.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <random>

#include "tests/attack/kills/round.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::attack {
namespace {

struct Options {
  std::vector<std::string> victims{"rendering", "coupling", "device", "logger", "validator", "up"},
      how{"kill", "stop"};
  int times = 100;
  std::uint64_t seed = 1;
  std::string domain;
  std::vector<std::string> up;
  bool each = false;
};

struct Row {
  std::vector<double> zero_ms, zero_wall_ms;
  double machine_ms = 0.0, gap_ms = 0.0, bag_lost_s = 0.0;
  int played = 0, stalled = 0, bad = 0;
};

void add(Row& row, const RoundResult& r) {
  row.played += r.played, row.stalled += r.stalled, row.bad += !r.faults.empty();
  if (r.zero_ms)
    row.zero_ms.push_back(*r.zero_ms), row.zero_wall_ms.push_back(*r.zero_wall_ms);
  row.machine_ms = std::max(row.machine_ms, r.machine_ms),
  row.gap_ms = std::max(row.gap_ms, r.gap_ms);
  row.bag_lost_s = std::max(row.bag_lost_s, r.bag_lost_s.value_or(0.0));
}

std::string span(std::vector<double> values) {
  if (values.empty())
    return "-";
  std::sort(values.begin(), values.end());
  return fmt::format("{:.0f} / {:.0f} / {:.0f}", values.front(), values[values.size() / 2],
                     values.back());
}

int run(int argc, char** argv) {
  Options o;
  CLI::App app("Kills and stops each process of the ring while the hand feels a contact.");
  std::vector<std::string> known = o.victims;
  known.push_back("none");
  app.add_option("--victim", o.victims,
                 "which; none: what the machine itself does meanwhile, with --how stop")
      ->check(CLI::IsMember(known));
  app.add_option("--how", o.how, "kill (SIGKILL), stop (SIGSTOP, and on after 0.7 s)")
      ->check(CLI::IsMember(o.how));
  app.add_option("--times", o.times, "each (100: about two hours for all)")->capture_default_str();
  app.add_option("--seed", o.seed, "of the moments")->capture_default_str();
  app.add_option("--domain", o.domain, "DDS domain (default: one that no other test holds)");
  app.add_option(
         "--up", o.up,
         "an option of `voxtouch up`, such as --up=--realtime=off; may be given more than once")
      ->allow_extra_args(false);
  app.add_flag("--each", o.each, "a line for each round");
  CLI11_PARSE(app, argc, argv);
  if (o.domain.empty())
    o.domain = test::fresh_domain();
  // Excludes what other programs of this machine create and remove meanwhile.
  const test::TemporaryFolder own;
  ::setenv("TMPDIR", own.path().c_str(), 1);
  std::mt19937_64 random(o.seed);
  const std::size_t all = o.victims.size() * o.how.size() * static_cast<std::size_t>(o.times);
  const bool on_terminal = ::isatty(STDERR_FILENO) == 1;
  std::size_t done = 0;
  int bad = 0;
  std::string table =
      fmt::format("{:10} {:5} {:>7} {:>25} {:>25} {:>12} {:>10} {:>9} {:>5}\n", "process", "how",
                  "rounds", "zero after, samples [ms]", "by this clock [ms]", "machine [ms]",
                  "gap [ms]", "bag [s]", "bad");
  for (const std::string& victim : o.victims)
    for (const std::string& how : o.how) {
      Row row;
      for (int n = 0; n < o.times; ++n) {
        RoundOptions ask{.victim = victim,
                         .signal = how == "kill" ? SIGKILL : SIGSTOP,
                         .domain = static_cast<std::uint32_t>(std::stoul(o.domain))};
        ask.options = o.up;
        ask.after_ms = static_cast<int>(random() % 1000);
        const RoundResult r = play(ask);
        add(row, r);
        ++done;
        if (on_terminal)
          fmt::print(stderr, "\r{:3} % {:10} {:5}", 100 * done / all, victim, how);
        if (o.each && r.zero_ms)
          fmt::print(
              "{} {}: zero after {:.1f} ms of samples, {:.1f} ms here; machine {:.1f} ms, gap "
              "{:.1f} ms\n",
              victim, how, *r.zero_ms, *r.zero_wall_ms, r.machine_ms, r.gap_ms);
        if (r.stalled)
          fmt::print(
              "{} {}, round {}: the machine kept a thread waiting for {:.1f} ms; zero after {:.1f} "
              "ms, {} samples without force\n",
              victim, how, n, r.machine_ms, r.zero_ms.value_or(0.0), r.unforced);
        for (const std::string& fault : r.faults)
          fmt::print("FAULT: {} {}, round {}: {}\n", victim, how, n, fault);
        std::fflush(stdout);
      }
      bad += row.bad;
      fmt::print(
          "figure: {} {}: {} rounds, zero force after {} ms, bag loses {:.2f} s, {} not judged as "
          "the machine stalled, {} bad\n",
          victim, how == "kill" ? "killed" : "stopped", row.played, span(row.zero_ms),
          row.bag_lost_s, row.stalled, row.bad);
      table += fmt::format("{:10} {:5} {:7} {:>25} {:>25} {:12.1f} {:10.1f} {:9.2f} {:5}\n", victim,
                           how, row.played, span(row.zero_ms), span(row.zero_wall_ms),
                           row.machine_ms, row.gap_ms, row.bag_lost_s, row.bad);
    }
  if (on_terminal)
    fmt::print(stderr, "\n");
  fmt::print(
      "{}(least / median / most; machine: how long it kept a thread on any CPU waiting; gap: "
      "without a sample of the device)\n",
      table);
  fmt::print("{}\n", bad == 0 ? "PASSED" : "FAILED");
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
