#pragma once
/// Pictures: drawn by voxtouch_plot (deploy/tools/plot.py), a Python program that stands next to
/// this one, in a process of its own.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

namespace voxtouch::cli {

/// Throws std::runtime_error, a sentence, where no picture could be drawn at `picture`: Python,
/// matplotlib or the folder is missing, or the name ends in something else than .png, .svg or .pdf
/// (`may_be_page`: or .html). Before a long run, so that it is reported then and not after it.
void check_picture(const std::filesystem::path& picture, bool may_be_page = false);

/// Draws `json`, what the verb `kind` (accuracy, design, identify) prints with --json. Gives the
/// tool's sentence on what the picture shows; throws std::runtime_error, a sentence, where it was
/// not drawn.
std::string draw_picture(const std::string& kind, const std::string& json,
                         const std::filesystem::path& picture);

/// The page of a recorded run, or of two side by side.
struct Report {
  std::filesystem::path bag, page;
  std::filesystem::path compared{};  ///< a second bag; empty: none
  std::string rig{};                 ///< empty: the one that the bag holds
};

/// Writes it, and reports its progress on stderr once that takes longer than a second. Gives the
/// tool's sentence. Throws std::runtime_error, a sentence, where it was not written. Where it takes
/// longer than `patience`, nothing is given and the tool goes on by itself, also when this program
/// has ended; a page is under its name only when it is whole.
std::optional<std::string> write_report(
    const Report& report, std::optional<std::chrono::milliseconds> patience = std::nullopt);

}  // namespace voxtouch::cli
