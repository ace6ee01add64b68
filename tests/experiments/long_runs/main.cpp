/// long_runs: a billion filter steps, ten million frames of moving contact, a billion steps of a
/// tumbling body, a million frames with floating-point traps, a hundred million hostile commands.
/// Exit status 1 if something drifts, grows, traps or is not finite. hour_of_ring.py runs the whole
/// ring for an hour.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "tests/experiments/long_runs/long_runs.hpp"

namespace voxtouch::long_runs {
namespace {

void show(std::uint64_t done, std::uint64_t all) {
  static std::uint64_t reported = 101;
  const std::uint64_t percent = all ? 100 * done / all : 100;
  if (percent == reported)
    return;
  reported = percent;
  fmt::print(stderr, "\r{:3} %", percent);
  std::fflush(stderr);
}

int print_findings(const Findings& f) {
  fmt::print(stderr, "\n");
  for (const std::string& line : f.lines)
    fmt::print("{}\n", line);
  if (f.slow_down != 1.0)
    fmt::print(
        "CPU time of the last tenth over that of the first: {:.3f}; resident memory grew by {} "
        "bytes, the heap by {}\n",
        f.slow_down, f.resident_growth, f.heap_growth);
  for (const std::string& fault : f.faults)
    fmt::print("FAULT: {}\n", fault);
  fmt::print("{}\n", f.faults.empty() ? "PASSED" : "FAILED");
  return f.faults.empty() ? 0 : 1;
}

int run(int argc, char** argv) {
  CLI::App app("Runs that are long enough for drift, leaks and slow-down to show.");
  app.require_subcommand(1);
  std::uint64_t seed = 1;
  FilterRunOptions filter;
  ContactRunOptions contact;
  TumbleRunOptions tumble;
  TrapRunOptions traps;
  CommandRunOptions commands;
  contact.scene = VOXTOUCH_DEPLOY "/scenes/cup.yaml", traps.scenes = VOXTOUCH_DEPLOY "/scenes";
  CLI::App* f = app.add_subcommand(
      "filter",
      "a contact held for --steps samples; step responses; clocks that cannot be relied on");
  f->add_option("--steps", filter.steps, "samples (1e9: a minute)")->capture_default_str();
  CLI::App* c =
      app.add_subcommand("contact", "a tool that wanders over a scene, round the whole loop");
  c->add_option("--frames", contact.frames, "samples (1e7: about two minutes)")
      ->capture_default_str();
  c->add_option("--scene", contact.scene, "the cup, with any model or effect")
      ->capture_default_str()
      ->check(CLI::ExistingFile);
  c->add_option("--model", contact.model, "contact model instead of the scene's")
      ->check(CLI::IsMember({"original", "adapted", "field"}));
  CLI::App* b = app.add_subcommand(
      "tumble", "a rigid body that turns for ever: is its orientation still a rotation?");
  b->add_option("--steps", tumble.steps, "samples (1e9: about nine minutes)")
      ->capture_default_str();
  CLI::App* t = app.add_subcommand(
      "traps", "random contact with floating-point traps on, in all models and effects");
  t->add_option("--frames", traps.frames, "samples (1e6: a minute)")->capture_default_str();
  CLI::App* h = app.add_subcommand(
      "commands", "hostile commands of any bits through gate and guard of every shipped device");
  h->add_option("--commands", commands.commands, "how many (1e8: a minute)")->capture_default_str();
  for (CLI::App* sub : {f, c, t, h})
    sub->add_option("--seed", seed, "of all that is random")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  filter.seed = contact.seed = traps.seed = commands.seed = seed;
  if (f->parsed())
    return print_findings(run_filter(filter, show));
  if (c->parsed())
    return print_findings(run_contact(contact, show));
  if (b->parsed())
    return print_findings(run_tumble(tumble, show));
  if (h->parsed())
    return print_findings(run_commands(commands, show));
  return print_findings(run_traps(traps, show));
}

}  // namespace
}  // namespace voxtouch::long_runs

int main(int argc, char** argv) {
  try {
    return voxtouch::long_runs::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
