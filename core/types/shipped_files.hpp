#pragma once
/// YAML files that are shipped with voxtouch: scenes, devices.
#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

#include "core/types/program_folder.hpp"

namespace voxtouch {

/// Names in this folder ("scenes"), sorted, without suffix; empty if the folder does not exist.
inline std::vector<std::string> shipped_files(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(shared_folder() / folder, error))
    if (entry.path().extension() == ".yaml")
      names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

/// The file of such a name, which has to be one of them.
inline std::filesystem::path shipped_file(const std::string& folder, const std::string& name) {
  return std::filesystem::canonical(shared_folder() / folder / (name + ".yaml"));
}

}  // namespace voxtouch
