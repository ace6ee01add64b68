#pragma once
/// Where a run keeps its files, and what stands beside its bag in the end.
#include <filesystem>
#include <string>

#include "nodes/cli/up/summary.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::cli {

/// Of the user and not of the current folder, which may be one that nobody can write to: as the XDG
/// base directories have it.
std::filesystem::path recordings_folder();
/// A folder there for a bag of this scene that begins now.
std::filesystem::path default_bag(const std::string& scene, const runtime::NodeOptions& node);
/// Where device and coupling keep what they saw before a fault; made with the first one.
std::filesystem::path faults_beside(const std::filesystem::path& bag);

/// The summary as one JSON object.
std::string json_of(const RunSummary& summary);
/// A bag alone does not tell whether its run was a good one: voxtouch_run.json beside it does, with
/// each limit and what was met.
void keep_verdict(const RunSummary& summary);
/// Beside the bag, and no part of the run: where it cannot be drawn a sentence says so, and a long
/// one goes on by itself.
void report_on(const RunSummary& summary);

}  // namespace voxtouch::cli
