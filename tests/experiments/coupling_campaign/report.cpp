#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tests/experiments/coupling_campaign/campaign.hpp"

namespace voxtouch::campaign {

std::string as_table(const std::vector<PhaseResult>& phases) {
  std::string out;
  for (const PhaseResult& phase : phases) {
    out += fmt::format("{}\n  {:<48}{:>8}{:>10}{:>8}{:>10}\n", phase.name, "", "runs", "unstable",
                       "%", "decaying");
    for (const Tally& t : phase.tallies) {
      const double percent =
          t.runs > 0 ? 100.0 * static_cast<double>(t.unstable) / static_cast<double>(t.runs) : 0.0;
      out += fmt::format("  {:<48}{:>8}{:>10}{:>8.2f}{:>10}\n", t.name, t.runs, t.unstable, percent,
                         t.decaying);
    }
    for (const Figure& f : phase.figures)
      out += fmt::format("  {:<48}{:>8.4g}\n", f.name, f.value);
    for (const Failure& f : phase.failures)
      out += fmt::format("  FAILED {}: seed {} {} {}: {}\n", f.setting, f.seed,
                         f.corner ? "corner" : "member", f.index, f.details);
    out += "\n";
  }
  return out;
}

std::string as_json(const std::vector<PhaseResult>& phases) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const PhaseResult& phase : phases) {
    nlohmann::ordered_json one{{"phase", phase.name}};
    for (const Tally& t : phase.tallies)
      one["runs"].push_back(
          {{"kind", t.name}, {"runs", t.runs}, {"unstable", t.unstable}, {"decaying", t.decaying}});
    for (const Figure& f : phase.figures)
      one["figures"][f.name] = f.value;
    one["failures"] = nlohmann::ordered_json::array();
    for (const Failure& f : phase.failures)
      one["failures"].push_back({{"trial", f.setting},
                                 {"seed", f.seed},
                                 {"index", f.index},
                                 {"corner", f.corner},
                                 {"details", f.details}});
    out.push_back(std::move(one));
  }
  return out.dump(2) + "\n";
}

}  // namespace voxtouch::campaign
