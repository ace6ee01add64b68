#pragma once
/// Where a run keeps its files, and what stands next to its bag in the end.
#include <filesystem>
#include <string>

#include "nodes/cli/up/summary.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::cli {

/// Of the user and not of the current folder, which may not be writable: as the XDG
/// base directories have it.
std::filesystem::path recordings_folder();
/// A folder there for a bag of this scene that begins now. Makes it, so that each of several runs
/// that begin in the same second has its own; the path alone where no folder can be made.
std::filesystem::path make_default_bag(const std::string& scene, const runtime::NodeOptions& node);

/// Removes the folder at its end if nothing is in it. An empty path: none.
class EmptyFolderGuard {
 public:
  explicit EmptyFolderGuard(std::filesystem::path folder) : folder_(std::move(folder)) {}
  EmptyFolderGuard(const EmptyFolderGuard&) = delete;
  EmptyFolderGuard& operator=(const EmptyFolderGuard&) = delete;
  ~EmptyFolderGuard() {
    std::error_code ignored;
    std::filesystem::remove(folder_, ignored);
  }
  const std::filesystem::path& folder() const noexcept { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// Where device and coupling keep what they saw before a fault; made with the first one.
std::filesystem::path fault_folder_of(const std::filesystem::path& bag);

/// The summary as one JSON object.
std::string json_of(const RunSummary& summary);
/// A bag alone does not state whether its run passed: voxtouch_run.json next to it does, with
/// each limit and what was met.
void keep_verdict(const RunSummary& summary);
/// Next to the bag, and no part of the run: where it cannot be drawn a sentence says so, and a long
/// one goes on by itself.
void report_on(const RunSummary& summary);

}  // namespace voxtouch::cli
