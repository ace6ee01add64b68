#pragma once
/// As much of JSON Schema 2020-12 as the scene's schema uses, to hold scenes against it.
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/scene/yaml_tree.hpp"

namespace voxtouch::test {

/// As an editor reads it: plain words that are numbers or flags are such, what is quoted is a text.
nlohmann::json to_json(const scene::YamlNode& node);

/// What is wrong with `value`, each with its place ("/contact/model: ..."); empty where it conforms. Throws
/// std::invalid_argument for a keyword that it does not know, so that none is passed over.
std::vector<std::string> violations(const nlohmann::json& schema, const nlohmann::json& value);

}  // namespace voxtouch::test
