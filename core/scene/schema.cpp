#include "core/scene/schema.hpp"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/effects/effect_kind.hpp"

namespace voxtouch {
namespace {

using Json = nlohmann::ordered_json;

Json described(Json type, std::string_view meaning) {
  if (!meaning.empty()) type["description"] = meaning;
  return type;
}
Json with_default(Json type, Json standard) {
  type["default"] = std::move(standard);
  return type;
}
Json text(std::string_view meaning) { return described({{"type", "string"}, {"minLength", 1}}, meaning); }
/// A name: the reader takes words that look like numbers too.
Json name(std::string_view meaning) {
  return described({{"type", {"string", "number", "boolean"}}, {"minLength", 1}}, meaning);
}
Json flag(bool standard, std::string_view meaning) {
  return described({{"type", "boolean"}, {"default", standard}}, meaning);
}
Json positive(std::string_view meaning) { return described({{"type", "number"}, {"exclusiveMinimum", 0}}, meaning); }
Json not_negative(std::string_view meaning) { return described({{"type", "number"}, {"minimum", 0}}, meaning); }
Json count(std::string_view meaning) { return described({{"type", "integer"}, {"minimum", 0}}, meaning); }
Json words(Json list, std::string_view meaning) { return described({{"enum", std::move(list)}}, meaning); }
Json defined(const char* name, std::string_view meaning = {}) {
  return described({{"$ref", std::string("#/$defs/") + name}}, meaning);
}
Json list_of(Json item, std::string_view meaning) {
  return described({{"type", "array"}, {"items", std::move(item)}}, meaning);
}
Json numbers(int n, std::string_view meaning) {
  return described({{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", n}, {"maxItems", n}}, meaning);
}
/// Of these keys and no others.
Json map_of(Json keys, Json required, std::string_view meaning = {}) {
  Json out = described({{"type", "object"}}, meaning);
  out["properties"] = std::move(keys), out["required"] = std::move(required);
  out["additionalProperties"] = false;
  return out;
}
/// "where `key` is here": what then holds.
Json has(const char* key) { return {{"required", Json::array({key})}}; }
Json none_of(std::initializer_list<const char*> keys) {
  Json any = Json::array();
  for (const char* key : keys) any.push_back(has(key));
  return {{"not", {{"anyOf", std::move(any)}}}};
}
Json exactly_one_of(std::initializer_list<const char*> keys) {
  Json one = Json::array();
  for (const char* key : keys) one.push_back(has(key));
  return one;
}

Json pose_keys() {
  return {{"position", with_default(defined("vector", "Where it is [m]."), {0, 0, 0})},
          {"orientation", with_default(defined("quaternion"), {1, 0, 0, 0})}};
}

Json shapes() {
  Json box = pose_keys();
  box["size"] = list_of({{"type", "number"}, {"exclusiveMinimum", 0}}, "Edges along the box's own axes [m].");
  box["size"]["minItems"] = box["size"]["maxItems"] = 3;
  Json cylinder = pose_keys();
  cylinder["radius"] = positive("[m]"), cylinder["length"] = positive("Along the cylinder's own z [m].");
  return {
      {"sphere", map_of({{"centre", with_default(defined("vector", "[m]"), {0, 0, 0})}, {"radius", positive("[m]")}},
                        {"radius"})},
      {"box", map_of(std::move(box), {"size"})},
      {"cylinder", map_of(std::move(cylinder), {"radius", "length"})}};
}

Json part() {
  Json out = map_of(shapes(), Json::array(),
                    "A closed form that stands for the mesh, or a convex part of it, in the validator.");
  out["oneOf"] = exactly_one_of({"sphere", "box", "cylinder"});
  return out;
}

Json mesh_keys() {
  Json keys = {{"mesh", text("OBJ, STL, PLY, glTF/GLB or COLLADA; paths start at the scene file's folder.")},
               {"scale", with_default(positive("Metres for one unit of the file."), 1)}};
  keys.update(pose_keys());
  keys["parts"] =
      list_of(defined("part"), "Closed forms that stand for the mesh in the validator, in its frame after scaling.");
  return keys;
}

Json static_mesh() {
  Json keys = mesh_keys();
  keys["origin"] = defined("vector", "Origin of the ground's voxel grid [m]; on one static mesh at most.");
  keys["object"] = defined("object");
  return map_of(std::move(keys), {"mesh"});
}

Json object() {
  Json made = map_of({{"name", name("Of the object.")},
                      {"stiffness_n_per_m", positive("Of each shell point against it [N/m]; left out: the scene's.")},
                      {"stiffness_n_per_m3", positive("Per area against it [N/m^3]; left out: the scene's.")},
                      {"moves", defined("way")}},
                     {"name"}, "Made here.");
  made["not"] = {{"required", {"stiffness_n_per_m", "stiffness_n_per_m3"}}};
  return described({{"oneOf", {name("Made by an entry above."), std::move(made)}}},
                   "With a material of its own, and a motion if it has one; left out: the ground.");
}

Json dynamic_mesh() {
  Json keys = mesh_keys();
  keys["shell"] =
      with_default(words({"exact", "naive"}, "Shell points on the surface, or in the voxels' centres."), "exact");
  return map_of(std::move(keys), {"mesh"}, "The tool: what the hand moves.");
}

Json contact() {
  Json out = map_of({{"model", with_default(words({"original", "adapted", "clustered", "field"},
                                                  "ContactCase of accuracy: see `voxtouch accuracy`."),
                                            "adapted")},
                     {"stiffness_n_per_m", positive("Of each shell point [N/m]; original and adapted.")},
                     {"stiffness_n_per_m3", positive("Per area of the tool's surface [N/m^3]; any model.")}},
                    Json::array(), "How the tool is pushed out of what it touches.");
  out["oneOf"] = exactly_one_of({"stiffness_n_per_m", "stiffness_n_per_m3"});
  out["if"] = {{"properties", {{"model", {{"enum", {"clustered", "field"}}}}}}, {"required", {"model"}}};
  out["then"] = has("stiffness_n_per_m3");
  return out;
}

Json hand() {
  const auto range = [](std::string_view meaning) {
    Json out = list_of({{"type", "number"}, {"minimum", 0}}, meaning);
    out["minItems"] = out["maxItems"] = 2;
    return out;
  };
  Json given = map_of({{"mass_kg", range("[low, high]")},
                       {"damping_ns_per_m", range("[low, high]")},
                       {"stiffness_n_per_m", range("[low, high]")},
                       {"inertia_kg_m2", range("[low, high]")},
                       {"damping_nms_per_rad", range("[low, high]")},
                       {"stiffness_nm_per_rad", range("[low, high]")}},
                      {"mass_kg", "damping_ns_per_m", "stiffness_n_per_m"}, "Ranges of a hand.");
  Json turning = Json::array({"inertia_kg_m2", "damping_nms_per_rad", "stiffness_nm_per_rad"});
  for (const char* key : {"inertia_kg_m2", "damping_nms_per_rad", "stiffness_nm_per_rad"})
    given["dependentRequired"][key] = turning;
  return described({{"oneOf", {{{"enum", {"pen", "arm", "any_passive"}}}, std::move(given)}}},
                   "Who may hold the device; left out: as the device is held.");
}

Json coupling() {
  Json out = map_of(
      {{"design", words({"auto"}, "The coupling is designed for device, hand and contact.")},
       {"kind", words({"auto", "shaping_filter", "spring_damper", "direct"},
                      "Law; `auto` goes with design. Else the standard is shaping_filter.")},
       {"cutoff_hz", positive("Of the shaping filter, w0/(2 pi); with design a wish, which the designer may raise.")},
       {"damping_ratio", with_default(positive("Of the shaping filter."), 0.7071067811865476)},
       {"gain", with_default(positive("Of the shaping filter, force over force."), 1)},
       {"stiffness_n_per_m", with_default(positive("Of the spring-damper [N/m]."), 500)},
       {"damping_ns_per_m", with_default(not_negative("Of the spring-damper [Ns/m]."), 2)},
       {"stiffness_cap_n_per_m", positive("The contact shows no more than this, in W [N/m].")},
       {"stiffness_cap_nm_per_rad", positive("The contact shows no more than this against rotation [Nm/rad].")},
       {"injected_damping_ns_per_m", with_default(not_negative("While in contact [Ns/m]."), 0)},
       {"injected_damping_nms_per_rad", with_default(not_negative("While in contact [Nms/rad]."), 0)},
       {"velocity_filter_hz", with_default(positive("Of the velocity that is damped."), 100)},
       {"gain_margin", described({{"type", "number"}, {"minimum", 1}, {"default", 2}},
                                 "How much stiffer the worst case may get before it is unstable.")},
       {"hand", hand()},
       {"released", flag(true, "Must be stable with nobody holding it too.")},
       {"inject_damping", flag(true, "The designer may inject damping.")},
       {"run_infeasible", flag(false, "Run what was found even where the design says that it will not do.")}},
      Json::array(), "Between contact and device.");
  Json by_hand = none_of({"gain_margin", "hand", "released", "inject_damping", "run_infeasible"});
  by_hand["properties"]["kind"] = {{"enum", {"shaping_filter", "spring_damper", "direct"}}};
  out["if"] = has("design");
  out["then"] = none_of({"damping_ratio", "gain", "stiffness_n_per_m", "damping_ns_per_m", "injected_damping_ns_per_m",
                         "injected_damping_nms_per_rad", "velocity_filter_hz"});
  out["else"] = std::move(by_hand);
  return out;
}

Json device() {
  Json button = count("While this button is pressed the tool stays and the device moves free.");
  button["maximum"] = 31;
  return map_of({{"position_scale", with_default(positive("Metres of the tool for one metre of the device."), 1)},
                 {"force_scale", with_default(positive("Newtons at the device for one newton of the scene."), 1)},
                 {"pose", defined("pose", "The device's base in the scene.")},
                 {"tool", defined("pose", "The tool in the frame of the device's tip.")},
                 {"clutch_button", std::move(button)}},
                Json::array(), "How the device moves the tool.");
}

/// A motion without what only a hand has.
Json way() {
  Json path = list_of(defined("vector"), "Way points [m], walked in straight pieces.");
  path["minItems"] = 1;
  Json circle = map_of({{"centre", defined("vector", "[m]")}, {"axis", with_default(defined("vector"), {0, 0, 1})}},
                       {"centre"}, "Round and round after the way points, beginning at the last.");
  Json out =
      map_of({{"path", std::move(path)},
              {"speed_m_per_s", with_default(positive("Largest speed of a straight piece [m/s]."), 0.05)},
              {"hold_s", with_default(not_negative("Rest at each way point [s]."), 0)},
              {"repeat_from", count("Back and forth between this point, counted from 0, and the last, for ever.")},
              {"circle", std::move(circle)}},
             {"path"}, "How an object moves: its displacement over the time since the session's begin.");
  out["not"] = {{"required", {"repeat_from", "circle"}}};
  return out;
}

Json motion() {
  Json out = way();
  Json button = count("Counted from 0.");
  button["maximum"] = 31;
  out["description"] = "What a simulated hand does with the tool's origin, in the scene.";
  out["properties"]["orientation"] = with_default(defined("quaternion"), {1, 0, 0, 0});
  out["properties"]["press"] =
      list_of(map_of({{"button", std::move(button)}, {"from_s", not_negative("[s]")}, {"to_s", positive("[s]")}},
                     {"button", "from_s", "to_s"}),
              "Buttons that the hand holds down meanwhile.");
  return out;
}

Json region() {
  Json keys = shapes();
  keys.erase("cylinder");
  // A region has no place of its own to be centred at, where a part of a mesh has.
  keys["sphere"]["required"] = {"centre", "radius"};
  keys["sphere"]["properties"]["centre"].erase("default");
  keys["blend_m"] = with_default(positive("The effect fades out over this length beyond the shape [m]."), 0.002);
  Json out = map_of(std::move(keys), Json::array(), "The effect works in here only.");
  out["oneOf"] = exactly_one_of({"sphere", "box"});
  return out;
}

Json word_list(std::string_view all) {
  Json out = Json::array();
  while (!all.empty()) {
    const std::size_t end = std::min(all.find(' '), all.size());
    out.push_back(all.substr(0, end));
    all.remove_prefix(std::min(end + 1, all.size()));
  }
  return out;
}

Json parameter(const EffectParameter& p) {
  const auto tidy = [](double v) {
    return v == std::floor(v) && std::abs(v) < 1e15 ? Json(static_cast<std::int64_t>(v)) : Json(v);
  };
  Json out;
  if (p.shape == ParameterShape::kNumber) {
    out = {{"type", "number"}, {"minimum", tidy(p.low)}};
    if (!std::isfinite(p.low)) out.erase("minimum");
    if (std::isfinite(p.high)) out["maximum"] = tidy(p.high);
  } else if (p.shape == ParameterShape::kWord) {
    out["enum"] = word_list(p.words);
  } else {
    out = {{"$ref", "#/$defs/vector"}};
  }
  if (p.standard) {
    const std::array<double, 3>& v = *p.standard;
    out["default"] = p.shape == ParameterShape::kNumber ? tidy(v[0])
                     : p.shape == ParameterShape::kWord ? out["enum"].at(static_cast<std::size_t>(v[0]))
                                                        : Json({tidy(v[0]), tidy(v[1]), tidy(v[2])});
  }
  return described(std::move(out), p.meaning);
}

Json effect_kind(const EffectKind& kind) {
  Json keys = Json::object(), required = Json::array();
  for (const EffectParameter& p : kind.parameters) {
    keys[p.name] = parameter(p);
    if (!p.standard) required.push_back(p.name);
  }
  return map_of(std::move(keys), std::move(required), kind.says);
}

Json effect() {
  Json keys = Json::object(), one = Json::array();
  for (const EffectKind* kind : effect_kinds()) {
    keys[kind->name] = effect_kind(*kind);
    one.push_back({{"required", Json::array({kind->name})}});
  }
  keys["name"] = name("Of this one, for the change while running; the kind's where it is left out.");
  keys["region"] = defined("region");
  keys["object"] = name("Feels the contact with this object alone; `ground` for the meshes of none.");
  keys["gain"] =
      described({{"type", "number"}, {"minimum", 0}, {"maximum", 1}, {"default", 1}}, "Share of it that is felt.");
  keys["on"] = flag(true, "false: built and ready, switched off at the start.");
  Json out = map_of(std::move(keys), Json::array(), "One effect.");
  out["oneOf"] = std::move(one);
  for (const EffectKind* kind : effect_kinds()) {
    Json refused = Json::array();
    if (kind->everywhere) refused = {has("region"), has("gain"), has("on")};
    if (!kind->needs(EffectValues(kind->parameters)).contact) refused.push_back(has("object"));
    if (!refused.empty())
      out["allOf"].push_back({{"if", has(kind->name.data())}, {"then", {{"not", {{"anyOf", std::move(refused)}}}}}});
  }
  return out;
}

Json definitions() {
  return {{"vector", numbers(3, "[x, y, z]")},
          {"quaternion", numbers(4, "Unit quaternion [w, x, y, z].")},
          {"pose", map_of(pose_keys(), Json::array())},
          {"part", part()},
          {"object", object()},
          {"static_mesh", static_mesh()},
          {"region", region()},
          {"effect", effect()},
          {"way", way()},
          {"motion", motion()}};
}

}  // namespace

std::string scene_schema() {
  Json fixed = list_of(defined("static_mesh"), "What can be touched.");
  fixed["minItems"] = 1;
  Json keys = {
      {"scene", name("The scene's name.")},
      {"voxel_size", positive("Edge of a voxel [m].")},
      {"static", std::move(fixed)},
      {"dynamic", dynamic_mesh()},
      {"contact", contact()},
      {"effects", list_of(defined("effect"), "What is felt beside the contact; what is not here is not computed.")},
      {"coupling", coupling()},
      {"device", device()},
      {"motions",
       {{"type", "object"},
        {"description", "What simulated hands can do, by name."},
        {"propertyNames", {{"pattern", "^[A-Za-z0-9_-]+$"}}},
        {"additionalProperties", {{"$ref", "#/$defs/motion"}}}}}};
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "voxtouch scene"},
                 {"description", "A scene of voxtouch. Lengths are m, forces N, quaternions w x y z."}};
  schema.update(map_of(std::move(keys), {"scene", "voxel_size", "static", "dynamic", "contact"}));
  schema["$defs"] = definitions();
  return schema.dump(2) + "\n";
}

}  // namespace voxtouch
