#pragma once
/// Whether a run has passed, and why not. Pure: a record in, enumerators and values out.
#include <vector>

#include "nodes/cli/up/run_record.hpp"

namespace voxtouch::cli {

struct RunVerdict {
  std::vector<CheckedLimit> limits;  ///< all, in the table's order
  std::vector<Found> faults;         ///< in addition to limits
  std::vector<Found> notes;
  bool passed() const;
  std::size_t limits_failed() const;
};
RunVerdict judge(const RunRecord& run);

}  // namespace voxtouch::cli
