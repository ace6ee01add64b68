#pragma once
/// What can be known before any node starts is said before any node starts.
#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "nodes/cli/summary.hpp"

namespace voxtouch::cli {

/// Throws std::runtime_error, a sentence: unknown device or motion, a scene that is too stiff for the device even with one point in
/// contact, a bag folder (empty: none) that exists or could not be made. Returns what a user may want to know, as sentences.
std::vector<std::string> check_before_start(const Scene& scene, const std::string& device, const std::string& motion,
                                            const std::filesystem::path& bag);

/// Sorts what the nodes have reported into problems and notes.
void judge(RunSummary& summary);

}  // namespace voxtouch::cli
