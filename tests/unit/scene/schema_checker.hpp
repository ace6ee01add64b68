#pragma once
/// Scenes checked by the schema that editors read.
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/scene/yaml_tree.hpp"

namespace voxtouch::test {

/// As an editor reads it: plain words that are numbers or flags are such, what is quoted is a text.
nlohmann::json to_json(const scene::YamlNode& node);

/// What is wrong with each of the list `values`, each with its place ("$.contact.model: ...");
/// empty where it conforms. By python3-jsonschema, in a process of its own. Throws
/// std::runtime_error where that fails, as on a schema that is none.
std::vector<std::vector<std::string>> violations(const nlohmann::json& schema,
                                                 const nlohmann::json& values);

}  // namespace voxtouch::test
