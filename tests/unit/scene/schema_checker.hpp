#pragma once
/// Scenes checked by the schema that editors read.
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/scene/yaml_tree.hpp"

namespace voxtouch::test {

/// As an editor reads it: plain words that are numbers or flags become such, quoted ones are text.
nlohmann::json to_json(const scene::YamlNode& node);

/// Violations of each of `values`, each with its place ("$.contact.model: ..."); empty if it
/// conforms. By python3-jsonschema, in a child process. Throws std::runtime_error if that fails,
/// for example for an invalid schema.
std::vector<std::vector<std::string>> violations(const nlohmann::json& schema,
                                                 const nlohmann::json& values);

}  // namespace voxtouch::test
