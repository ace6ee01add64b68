#pragma once
/// What a run did, for a person and for a machine.
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "nodes/cli/up/run_limits.hpp"
#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::cli {

using Reports = std::map<std::string, runtime::NodeReport>;  ///< last report of each node

/// A figure of a node's last report, by its name; 0 where there is none.
double number(const Reports& reports, const std::string& node, const std::string& name);
/// A word of it, by its key; empty where there is none.
std::string word(const Reports& reports, const std::string& node, const std::string& key);

/// Everything that `up` knows at the end.
struct RunSummary {
  std::string scene, device, motion, mode, bag;
  std::uint64_t seed = 0;
  double validate_every = 1.0;
  std::map<std::string, double>
      silence_s;  ///< of each node: longest time without a status, as `up` saw it
  std::map<std::string, std::uint64_t> takeovers;  ///< how often each took over from the one that
                                                   ///< it stood by for; none where nobody did
  ChosenLimits limits;
  std::vector<Judged> judged;  ///< by `judge`
  Reports reports;
  std::vector<std::string> problems;  ///< sentences; empty: all is well
  std::vector<std::string> notes;     ///< sentences that spoil nothing
};

/// From what the nodes have reported to what of a run is judged.
RunFigures figures_of(const RunSummary& summary);

/// Its rendering had one.
bool has_virtual_tool(const RunSummary& summary);

/// For a machine, and for a person.
nlohmann::ordered_json to_json(const RunSummary& summary);
std::string to_text(const RunSummary& summary);
/// One line while the ring runs, on the last second; `nodes` are those that take part.
std::string status_line(const Reports& reports, const std::vector<std::string>& nodes);

}  // namespace voxtouch::cli
