#pragma once
/// Pictures: drawn by voxtouch_plot (deploy/tools/plot.py), a Python program that stands beside this one, in a process of its own.
#include <filesystem>
#include <string>

namespace voxtouch::cli {

/// Throws std::runtime_error, a sentence, where no picture could be drawn at `picture`: Python, matplotlib or the folder is missing, or
/// the name ends in something else than .png, .svg or .pdf. Before a long run, so that it is told then and not after it.
void check_picture(const std::filesystem::path& picture);

/// Draws `json`, what the verb `kind` (accuracy, design) prints with --json. Gives the tool's sentence on what the picture shows; throws
/// std::runtime_error, a sentence, where it was not drawn.
std::string draw_picture(const std::string& kind, const std::string& json, const std::filesystem::path& picture);

}  // namespace voxtouch::cli
