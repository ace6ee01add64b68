/// coupling_campaign: simulates coupling designs and counts unstable loops. Exit status 1 if a
/// design is unstable, or a loop that the linear model rates stable with a margin of 5 %.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "tests/experiments/coupling_campaign/campaign.hpp"

namespace voxtouch::campaign {
namespace {

struct Arguments {
  std::uint64_t runs = 10000, seed = 1, first = 0;
  std::vector<std::string> phases{"recipe", "designs", "predictor"};
  double overload = 1.0;
  std::optional<double> damping_force_ratio;
  bool json = false, corners = true;
};

Arguments parse(CLI::App& app, int argc, char** argv) {
  Arguments a;
  app.add_option(
         "--runs", a.runs,
         "runs of designs, four a member of the population; the other phases get a quarter of it")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", a.seed, "of the population and of every run");
  app.add_option("--first", a.first,
                 "index of the first member: --first N --runs 4 repeats member N alone");
  app.add_option("--phases", a.phases, "any of recipe, designs, predictor")
      ->check(CLI::IsMember({"recipe", "designs", "predictor"}))
      ->delimiter(',');
  app.add_flag("--corners,!--no-corners", a.corners,
               "designs for the corners of the population's ranges as well");
  app.add_option("--overload", a.overload,
                 "designs: contacts this many times stiffer than promised, to see that it is seen")
      ->check(CLI::PositiveNumber);
  app.add_option(
         "--damping-force-ratio", a.damping_force_ratio,
         "designs: most that injected damping adds, as a fraction of the law's force; 0: not "
         "bounded. Default: as the designer chooses")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--json", a.json, "one JSON array instead of the table");
  app.parse(argc, argv);
  return a;
}

int run(const Arguments& a) {
  Options options;
  options.seed = a.seed, options.first = a.first, options.corners = a.corners,
  options.overload = a.overload, options.damping_force_ratio = a.damping_force_ratio;
  options.members = (a.runs + 3) / 4;
  std::vector<PhaseResult> results;
  for (const std::string& phase : a.phases) {
    std::uint64_t reported = 0;
    options.progress = [&](std::uint64_t done, std::uint64_t all) {
      if (20 * done / all == reported)
        return;
      reported = 20 * done / all;
      fmt::print(stderr, "{}: {} of {}\n", phase, done, all);
    };
    results.push_back(phase == "recipe"    ? recipe_phase(options)
                      : phase == "designs" ? design_phase(options)
                                           : predictor_phase(options));
  }
  fmt::print("{}", a.json ? as_json(results) : as_table(results));
  for (const PhaseResult& r : results)
    if (!r.failures.empty())
      return 1;
  return 0;
}

}  // namespace
}  // namespace voxtouch::campaign

int main(int argc, char** argv) {
  CLI::App app{"Tries coupling designs in simulated loops and counts what becomes unstable."};
  try {
    return voxtouch::campaign::run(voxtouch::campaign::parse(app, argc, argv));
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    fmt::print(stderr, "coupling_campaign: {}\n", e.what());
    return 2;
  }
}
