#pragma once
/// The figures of a run as a table for a terminal.
#include <string>

#include "nodes/cli/up/run_verdict.hpp"

namespace voxtouch::cli {

/// Name, value, unit and limit of each figure, two figures a line, on 12 lines of at most
/// 100 columns.
std::string figure_table(const RunRecord& run, const RunVerdict& verdict);

}  // namespace voxtouch::cli
