#include "nodes/bag/bag_origin.hpp"

#include <fstream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/types/version.hpp"

namespace voxtouch::bag {
namespace {

std::string text_in(const nlohmann::json& map, const char* key) {
  return map.is_object() && map.contains(key) && map[key].is_string() ? map[key].get<std::string>()
                                                                      : std::string();
}

}  // namespace

std::string other_layout_error(const std::filesystem::path& bag, const HashOf& hash_of) {
  std::error_code error;
  const std::filesystem::path folder =
      std::filesystem::is_directory(bag, error) ? bag : bag.parent_path();
  std::ifstream file(folder / "voxtouch_recording.json");
  const auto recording = nlohmann::json::parse(file, nullptr, false);
  if (!recording.is_object() || !recording.contains("topics") || !recording["topics"].is_array())
    return {};
  std::set<std::string> changed;
  for (const auto& topic : recording["topics"]) {
    const std::string type = text_in(topic, "type"), then = text_in(topic, "type_hash"),
                      now(hash_of(type));
    if (!then.empty() && !now.empty() && then != now)
      changed.insert(type);
  }
  if (changed.empty())
    return {};
  const std::string by = text_in(recording, "voxtouch");
  return fmt::format(
      "'{}' was recorded by voxtouch {}, where {} {} laid out differently than in version {}. Read "
      "it with the recording version (deploy/CHANGELOG.md lists the changes).",
      bag.string(), by.empty() ? "(unknown version)" : by, fmt::join(changed, ", "),
      changed.size() == 1 ? "is" : "are", version());
}

}  // namespace voxtouch::bag
