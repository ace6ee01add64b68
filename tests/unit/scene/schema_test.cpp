/// The schema for editors compared with the reader: the same keys in both, and nothing refused that
/// the reader accepts.
#include "core/scene/schema.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

#include "tests/unit/scene/scene_fixture.hpp"
#include "tests/unit/scene/schema_checker.hpp"

namespace voxtouch::scene {
namespace {

using Json = nlohmann::json;
using test::violations;

const Json& schema() {
  static const Json json = Json::parse(scene_schema());
  return json;
}
std::string text_of(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}
std::vector<std::filesystem::path> shipped_scenes() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(VOXTOUCH_DEPLOY) + "/scenes"))
    if (entry.path().extension() == ".yaml")
      files.push_back(entry.path());
  return files;
}
std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines)
    text += line + "\n";
  return text;
}

const Json& resolved(const Json& node) {
  return node.contains("$ref")
             ? schema().at(Json::json_pointer(node["$ref"].get<std::string>().substr(1)))
             : node;
}

/// The keys of which an object has exactly one; a key that replaces all of them is excluded.
std::vector<std::string> alternatives(const Json& object) {
  std::vector<std::string> keys;
  if (object.contains("oneOf"))
    for (const Json& one : object["oneOf"])
      if (!one.contains("not"))
        keys.push_back(one["required"][0]);
  return keys;
}

/// A value that the reader takes at this place, with no key that may be left out.
Json least(const Json& place) {
  if (place.contains("default"))
    return place["default"];
  const Json& node = resolved(place);
  if (node.contains("enum"))
    return node["enum"][0];
  const std::string type =
      node.contains("type") && node["type"].is_string() ? node["type"] : Json("string");
  if (type == "string")
    return "a.obj";
  if (type == "boolean")
    return true;
  if (type == "number" || type == "integer")
    return node.value("minimum", 0.0) > 0.0 ? node["minimum"] : Json(1);
  if (type == "array") {
    if (node["minItems"] == 3)
      return {0, 0, 1};
    Json list = Json::array();
    for (int n = 0; n < node.value("minItems", 0); ++n)
      list.push_back(least(node["items"]));
    return list;
  }
  Json object = Json::object();
  for (const Json& key : node["required"])
    object[key.get<std::string>()] = least(node["properties"][key.get<std::string>()]);
  if (const std::vector<std::string> one = alternatives(node); !one.empty()) {
    const bool oil = std::find(one.begin(), one.end(), "viscosity") != one.end();
    const std::string key = oil ? "viscosity" : one.front();
    object[key] = least(node["properties"][key]);
  }
  return object;
}

/// Puts a value at one place of an otherwise least scene.
using Wrap = std::function<Json(const Json&)>;
using Visit = std::function<void(const std::string& at, const Json& object, const Wrap& wrap)>;

Json with(const Json& object, const std::string& key, const Json& value) {
  Json out = least(object);
  const std::vector<std::string> one = alternatives(object);
  if (std::find(one.begin(), one.end(), key) != one.end())
    for (const std::string& other : one)
      out.erase(other);
  if (key == "hand")
    out["design"] = "auto";  // a hand is read only with a design
  out[key] = value;
  return out;
}

/// Each object of the schema that lists keys, at each of its places.
void walk(const Json& place, const std::string& at, const Wrap& wrap, const Visit& visit) {
  const Json& node = resolved(place);
  if (node.contains("properties")) {
    visit(at, node, wrap);
    for (const auto& [key, sub] : node["properties"].items())
      walk(
          sub, at + "/" + key,
          [&, k = key](const Json& value) { return wrap(with(node, k, value)); }, visit);
  } else if (node.contains("items")) {
    walk(
        node["items"], at + "[]", [&](const Json& value) { return wrap(Json::array({value})); },
        visit);
  } else if (node.contains("additionalProperties")) {
    walk(
        node["additionalProperties"], at + "/m",
        [&](const Json& value) {
          return wrap({{"m", value}});
        },
        visit);
  } else if (node.contains("oneOf")) {
    for (const Json& one : node["oneOf"])
      walk(one, at, wrap, visit);
  }
}
void walk_all(const Visit& visit) {
  walk(
      schema(), "", [](const Json& value) { return value; }, visit);
}

/// JSON with bare keys, which is YAML.
std::string yaml(const Json& value) {
  std::string text;
  if (value.is_object()) {
    for (const auto& [key, sub] : value.items())
      text += (text.empty() ? "" : ", ") + key + ": " + yaml(sub);
    return "{" + text + "}";
  }
  if (value.is_array()) {
    for (const Json& sub : value)
      text += (text.empty() ? "" : ", ") + yaml(sub);
    return "[" + text + "]";
  }
  return value.is_string() ? value.get<std::string>() : value.dump();
}

class Schema : public SceneFolder {
 protected:
  /// The reader's message; empty if it accepts the scene.
  std::string said(const Json& scene) const {
    try {
      parse(yaml(scene));
      return "";
    } catch (const SceneError& error) {
      return error.what();
    }
  }
};

TEST_F(Schema, IsTheShippedFile) {
  EXPECT_EQ(text_of(std::string(VOXTOUCH_DEPLOY) + "/scenes/scene.schema.json"), scene_schema())
      << "voxtouch schema > deploy/scenes/scene.schema.json";
}

TEST_F(Schema, HoldsForEachShippedSceneAndIsNamedInIt) {
  const auto files = shipped_scenes();
  ASSERT_GE(files.size(), 8U);
  Json scenes = Json::array();
  for (const auto& file : files) {
    const std::string text = text_of(file);
    EXPECT_TRUE(text.starts_with("# yaml-language-server: $schema=scene.schema.json\n")) << file;
    scenes.push_back(test::to_json(parse_yaml(text, file)));
  }
  const auto wrong = violations(schema(), scenes);
  for (std::size_t n = 0; n < files.size(); ++n)
    EXPECT_EQ(joined(wrong[n]), "") << files[n];
}

TEST_F(Schema, HoldsForASceneWithAllKeysAndForTheLeastOne) {
  const auto wrong = violations(schema(), {test::to_json(parse_yaml(kFull, "s.yaml")),
                                           test::to_json(parse_yaml(kSmall, "s.yaml"))});
  for (const auto& one : wrong)
    EXPECT_EQ(joined(one), "");
  EXPECT_EQ(said(least(schema())), "");
}

TEST_F(Schema, NamesAtEachPlaceTheKeysThatTheReaderAllowsAndNoOthers) {
  int places = 0;
  walk_all([&](const std::string& at, const Json& object, const Wrap& wrap) {
    SCOPED_TRACE(at);
    const std::string error = said(wrap(with(object, "zzz", 1)));
    const std::size_t list = error.find("Allowed: ");
    ASSERT_NE(error.find("'zzz'"), std::string::npos) << error;
    ASSERT_NE(list, std::string::npos) << error;
    std::set<std::string> reader, named;
    std::stringstream words(error.substr(list + 9, error.rfind('.') - list - 9));
    for (std::string word; std::getline(words >> std::ws, word, ',');)
      reader.insert(word);
    for (const auto& [key, unused] : object["properties"].items())
      named.insert(key);
    EXPECT_EQ(reader, named);
    ++places;
  });
  EXPECT_GE(places, 24);
}

TEST_F(Schema, RequiresTheKeysThatTheReaderMisses) {
  walk_all([&](const std::string& at, const Json& object, const Wrap& wrap) {
    SCOPED_TRACE(at);
    EXPECT_EQ(said(wrap(least(object))).find("is missing"), std::string::npos)
        << said(wrap(least(object)));
    for (const std::string key : object["required"]) {
      Json without = least(object);
      without.erase(key);
      const std::string error = said(wrap(without));
      EXPECT_NE(error.find(std::string("'").append(key).append("' is missing")), std::string::npos)
          << key << ": " << error;
    }
  });
}

TEST_F(Schema, RefusesNothingThatTheReaderTakes) {
  const std::vector<Json> candidates = {-1,
                                        0,
                                        0.5,
                                        1,
                                        2,
                                        32,
                                        1e9,
                                        "word",
                                        "auto",
                                        true,
                                        Json::array(),
                                        {1, 0, 0},
                                        {1, 0, 0, 0},
                                        Json::object()};
  int refused = 0;
  Json accepted = Json::array();
  std::vector<std::string> places;
  walk_all([&](const std::string& at, const Json& object, const Wrap& wrap) {
    for (const auto& [key, unused] : object["properties"].items())
      for (const Json& candidate : candidates) {
        const Json scene = wrap(with(object, key, candidate));
        if (!said(scene).empty()) {
          ++refused;
          continue;
        }
        accepted.push_back(scene);
        places.push_back(at + "/" + key + " = " + candidate.dump());
      }
  });
  EXPECT_GT(refused, 1000);
  ASSERT_GT(accepted.size(), 100U);
  const auto wrong = violations(schema(), accepted);
  for (std::size_t n = 0; n < wrong.size(); ++n)
    EXPECT_EQ(joined(wrong[n]), "") << places[n];
}

TEST_F(Schema, SeesTheSlipsThatEditorsAreToShow) {
  struct Slip {
    const char *from, *to;
    bool wrong = true;
  };
  const std::vector<Slip> slips = {
      {"scene: small", "scene: small", false},
      {"voxel_size: 0.002", "voxel_size: -0.002"},
      {"voxel_size: 0.002", "voxel_size: two"},
      {"voxel_size", "voxel_sise"},
      {"dynamic: {mesh: b.obj}\n", ""},
      {"stiffness_n_per_m: 10", "stiffness_n_per_m: 10, stiffness_n_per_m3: 1"},
      {"stiffness_n_per_m: 10", "model: field, stiffness_n_per_m: 10"},
      {"stiffness_n_per_m: 10", "model: field", false},
      {"stiffness_n_per_m: 10", "model: field, stiffness_n_per_m3: 10", false},
      {"stiffness_n_per_m: 10", "model: field, rendering: penalty"},
      {"stiffness_n_per_m: 10", "model: adapted"},
      {"stiffness_n_per_m: 10", "model: adapted, stiffness_n_per_m: 10, rendering: memoryless",
       false},
      {"stiffness_n_per_m: 10", "model: adapted, rendering: memoryless"},
      {"contact:", "effects: [{gravity: {}}]\ncontact:"},
      {"contact:", "effects: [{viscosity: {}}]\ncontact:"},
      {"contact:", "effects: [{viscosity: {damping_ns_per_m: 1e6}}]\ncontact:"},
      {"contact:", "effects: [{viscosity: {damping_ns_per_m: 1}}]\ncontact:", false},
      {"contact:", "coupling: {design: auto, damping_ratio: 1}\ncontact:"},
      {"contact:", "coupling: {kind: auto}\ncontact:"},
      {"contact:", "device: {clutch_button: 32}\ncontact:"},
      {"contact:", "motions: {m: {}}\ncontact:"},
  };
  Json scenes = Json::array();
  for (const Slip& slip : slips) {
    std::string text = kSmall;
    const std::size_t at = text.find(slip.from);
    ASSERT_NE(at, std::string::npos) << slip.from;
    text.replace(at, std::string_view(slip.from).size(), slip.to);
    scenes.push_back(test::to_json(parse_yaml(text, "s.yaml")));
  }
  const auto wrong = violations(schema(), scenes);
  for (std::size_t n = 0; n < slips.size(); ++n)
    EXPECT_EQ(!wrong[n].empty(), slips[n].wrong) << slips[n].to;
}

}  // namespace
}  // namespace voxtouch::scene
