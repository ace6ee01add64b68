#pragma once
/// What a run did, for a person and for a machine.
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "nodes/runtime/roster.hpp"

namespace voxtouch::cli {

/// Everything that `up` knows at the end.
struct RunSummary {
  std::string scene, device, motion, mode, bag;
  std::uint64_t seed = 0;
  std::map<std::string, runtime::NodeReport> reports;  ///< last report of each node
  std::vector<std::string> problems;                   ///< sentences; empty: all is well
  std::vector<std::string> notes;                      ///< sentences that spoil nothing
};

nlohmann::ordered_json to_json(const RunSummary& summary);
std::string to_text(const RunSummary& summary);
/// One line while the ring runs; `nodes` are those that take part.
std::string status_line(const std::map<std::string, runtime::NodeReport>& reports,
                        const std::vector<std::string>& nodes);

}  // namespace voxtouch::cli
