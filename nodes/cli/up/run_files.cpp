#include "nodes/cli/up/run_files.hpp"

#include <chrono>
#include <cstdlib>
#include <ctime>

#include <nlohmann/json.hpp>

#include "nodes/bag/files.hpp"
#include "nodes/cli/plot_tool.hpp"
#include "nodes/console/log.hpp"

namespace voxtouch::cli {

std::filesystem::path recordings_folder() {
  if (const char* data = std::getenv("XDG_DATA_HOME"); data && *data == '/')
    return std::filesystem::path(data) / "voxtouch/recordings";
  if (const char* home = std::getenv("HOME"); home && *home == '/')
    return std::filesystem::path(home) / ".local/share/voxtouch/recordings";
  return std::filesystem::absolute("recordings");
}

std::filesystem::path make_default_bag(const std::string& scene, const runtime::NodeOptions& node) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char stamp[32];
  std::strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", &local);
  // Rings that run at the same time differ in rig or domain; runs within one second get a number.
  const runtime::NodeOptions usual;
  std::string name = scene + "-" + stamp;
  if (node.rig != usual.rig)
    name += "-" + node.rig;
  if (node.domain != usual.domain)
    name += "-domain" + std::to_string(node.domain);
  std::error_code error;
  std::filesystem::create_directories(recordings_folder(), error);
  std::filesystem::path folder = recordings_folder() / name;
  // create_directory returns false without an error for an existing folder.
  for (int number = 2; !error; ++number) {
    if (!std::filesystem::exists(fault_folder_of(folder), error) &&
        std::filesystem::create_directory(folder, error))
      break;
    folder = recordings_folder() / (name + "-" + std::to_string(number));
  }
  return folder;
}

std::filesystem::path fault_folder_of(const std::filesystem::path& bag) {
  std::filesystem::path folder = std::filesystem::absolute(bag).lexically_normal();
  if (!folder.has_filename())
    folder = folder.parent_path();  // "bags/run/"
  return folder += "_faults";
}

std::string json_of(const RunSummary& summary) {
  return to_json(summary).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
         "\n";  // paths need not be UTF-8
}

void save_verdict(const RunSummary& summary) {
  std::error_code none;
  if (std::filesystem::is_empty(summary.bag, none) || none)
    return;
  const auto kept = bag::write_atomically(std::filesystem::path(summary.bag) / "voxtouch_run.json",
                                          json_of(summary), bag::Flush::kNo);
  if (!kept)
    console::log("note: cannot write the verdict to the recording's folder: {}\n",
                 kept.error().sentence);
}

void report_on(const RunSummary& summary) {
  constexpr std::chrono::seconds kPatience{4};
  if (number(summary.reports, "device", "samples") == 0 || !std::filesystem::exists(summary.bag))
    return;
  const std::filesystem::path page = std::filesystem::path(summary.bag) / "report.html";
  try {
    if (write_report({.bag = summary.bag, .page = page}, kPatience))
      console::log("report: {}\n", page.string());
    else
      console::log("report: {} (still being written)\n", page.string());
  } catch (const std::exception& error) {
    console::log("note: no report: {} `voxtouch report {}` writes it later\n", error.what(),
                 summary.bag);
  }
}

}  // namespace voxtouch::cli
