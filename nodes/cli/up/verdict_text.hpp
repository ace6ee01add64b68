#pragma once
/// Texts of a verdict. All sentences about findings are made here.
#include <string>
#include <vector>

#include "nodes/cli/up/run_verdict.hpp"

namespace voxtouch::cli {

/// "PASSED", or "FAILED (2 of 19 limits, 1 other fault)"; both include force fades and fault
/// records.
std::string verdict_line(const RunRecord& run, const RunVerdict& verdict);
/// Reasons of a failure: the faults, then the limits; each once.
std::vector<std::string> problems_of(const RunRecord& run, const RunVerdict& verdict);
std::vector<std::string> notes_of(const RunRecord& run, const RunVerdict& verdict);
/// A limit that is not met.
std::string sentence_of(const CheckedLimit& judged);

}  // namespace voxtouch::cli
