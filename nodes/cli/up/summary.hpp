#pragma once
/// Summary of a run, as text and as JSON.
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "nodes/cli/up/run_verdict.hpp"

namespace voxtouch::cli {

struct RunSummary : RunRecord {
  RunVerdict verdict;
};

nlohmann::ordered_json to_json(const RunSummary& summary);
/// The verdict, its reasons, then the figures.
std::string to_text(const RunSummary& summary);
/// One line during the run, on the last second; `nodes` are the participating ones.
std::string status_line(const Reports& reports, const std::vector<std::string>& nodes);

}  // namespace voxtouch::cli
