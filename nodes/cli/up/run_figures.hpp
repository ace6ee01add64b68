#pragma once
/// From what the nodes have reported to what of a run is judged.
#include "nodes/cli/up/run_limits.hpp"
#include "nodes/cli/up/summary.hpp"

namespace voxtouch::cli {

RunFigures figures_of(const RunSummary& summary);

}  // namespace voxtouch::cli
