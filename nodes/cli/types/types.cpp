#include <filesystem>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "nodes/cli/output_file.hpp"
#include "nodes/cli/types/python_topics.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/log/tell.hpp"
#include "voxtouch_msgs/python_types.hpp"

namespace voxtouch::cli {
namespace {

int write_types(const std::filesystem::path& folder) {
  const std::filesystem::path package = folder / "voxtouch_types";
  std::error_code error;
  std::filesystem::create_directories(package, error);
  if (error)
    throw std::runtime_error(fmt::format("the folder {} could not be made: {}", package.string(), error.message()));
  for (const msg::PythonFile& file : msg::kPythonFiles) OutputFile(package / file.name).keep(std::string(file.text));
  OutputFile(package / "topics.py").keep(python_topics());
  log::print_result("{} holds the messages for PyPI's cyclonedds 11; its __init__.py shows how to listen in five lines.\n",
             package.string());
  return 0;
}

}  // namespace

void add_types(CLI::App& app, Action& action) {
  const auto folder = std::make_shared<std::filesystem::path>();
  CLI::App* verb = app.add_subcommand("types",
                                      "Writes all message types and the table of topics for programs in other languages: "
                                      "voxtouch announces no types on\n"
                                      "the network, so that tools which look types up there find none.");
  verb->add_option("--python", *folder, "writes DIR/voxtouch_types, a Python package for cyclonedds 11 of PyPI")
      ->type_name("DIR")
      ->required();
  verb->callback([&action, folder] { action = [folder] { return write_types(*folder); }; });
}

}  // namespace voxtouch::cli
