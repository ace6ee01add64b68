#pragma once
/// Files of a run next to its bag.
#include <filesystem>
#include <string>

#include "nodes/cli/up/summary.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::cli {

/// Of the user and not of the current folder, which may not be writable: as the XDG
/// base directories have it.
std::filesystem::path recordings_folder();
/// Creates a folder for a bag of this scene that begins now. Runs that begin in the same second get
/// different folders. Returns the path only if the folder cannot be created.
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

/// Folder for the fault records of device and coupling; created with the first one.
std::filesystem::path fault_folder_of(const std::filesystem::path& bag);

/// The summary as one JSON object.
std::string json_of(const RunSummary& summary);
/// Writes voxtouch_run.json next to the bag: the verdict, with each limit and its measured value.
void save_verdict(const RunSummary& summary);
/// Draws the report next to the bag. It is not part of the run: a failure prints a sentence, and a
/// long one continues in the background.
void report_on(const RunSummary& summary);

}  // namespace voxtouch::cli
