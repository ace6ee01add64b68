#pragma once
/// Pictures, drawn by voxtouch_plot (deploy/tools/plot.py), a Python program next to this one, as a
/// child process.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

namespace voxtouch::cli {

/// Throws std::runtime_error if no picture can be drawn at `picture`: Python, matplotlib or the
/// folder is missing, or the suffix is not .png, .svg or .pdf (`may_be_page`: or .html). Called
/// before a long run, so that it is reported early.
void check_picture(const std::filesystem::path& picture, bool may_be_page = false);

/// Draws `json`, the output of the verb `kind` (accuracy, design, identify) with --json. Returns
/// the tool's sentence about the picture. Throws std::runtime_error if it was not drawn.
std::string draw_picture(const std::string& kind, const std::string& json,
                         const std::filesystem::path& picture);

/// The page of a recorded run, or of two side by side.
struct Report {
  std::filesystem::path bag, page;
  std::filesystem::path compared{};  ///< a second bag; empty: none
  std::string rig{};                 ///< empty: that of the bag
};

/// Writes the report, with progress on stderr after a second. Returns the tool's sentence. Throws
/// std::runtime_error on failure. If it takes longer than `patience`, the result is empty and the
/// tool continues in the background, also after the end of this program. The page gets its name
/// only when it is complete.
std::optional<std::string> write_report(
    const Report& report, std::optional<std::chrono::milliseconds> patience = std::nullopt);

}  // namespace voxtouch::cli
