#include "core/scene/schema.hpp"

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/effects/effect_kind.hpp"
#include "core/scene/keys.hpp"

namespace voxtouch::scene {
namespace {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string_view>;

Json described(Json type, std::string_view meaning) {
  if (!meaning.empty())
    type["description"] = meaning;
  return type;
}
Json defined(std::string_view name) { return {{"$ref", "#/$defs/" + std::string(name)}}; }
Json list_of(Json item) { return {{"type", "array"}, {"items", std::move(item)}}; }
Json numbers(int n, std::string_view meaning) {
  return {{"type", "array"},
          {"items", {{"type", "number"}}},
          {"minItems", n},
          {"maxItems", n},
          {"description", meaning}};
}
/// The reader also accepts words that look like numbers.
Json name() { return {{"type", {"string", "number", "boolean"}}, {"minLength", 1}}; }

/// Whole numbers without a point.
Json tidy(double v) {
  return v == std::floor(v) && std::abs(v) < 1e15 ? Json(static_cast<std::int64_t>(v)) : Json(v);
}
Json number_within(double low, double high) {
  Json out = {{"type", "number"}};
  if (std::isfinite(low))
    out["minimum"] = tidy(low);
  if (std::isfinite(high))
    out["maximum"] = tidy(high);
  return out;
}

/// Condition "`key` is present", and its consequence.
Json has(std::string_view key) { return {{"required", Json::array({key})}}; }
Json each_of(const Names& keys) {
  Json out = Json::array();
  for (const std::string_view key : keys)
    out.push_back(has(key));
  return out;
}
Json none_of(const Names& keys) { return {{"not", {{"anyOf", each_of(keys)}}}}; }

Names keys_with(KeyRule rule, const KeyGroup& group) {
  Names names;
  for (const Key& key : group.keys)
    if (key.rule == rule)
      names.push_back(key.name);
  return names;
}

Json map_of(const KeyGroup& group, Json properties = Json::object());

Json map_in(const Key& key) {
  return key.group->defined.empty() ? map_of(*key.group) : defined(key.group->defined);
}

Json standard_of(const Key& key) {
  return key.kind == KeyKind::kWord ? Json(key.standard()) : Json::parse(key.standard());
}

/// The value's type and its lower limit. Numbers within limits and flags state their default here,
/// as effects do.
Json type_of(const Key& key) {
  Json out;
  switch (key.kind) {
    case KeyKind::kText:
      return {{"type", "string"}, {"minLength", 1}};
    case KeyKind::kName:
      return name();
    case KeyKind::kFlag:
      out = {{"type", "boolean"}};
      break;
    case KeyKind::kPositive:
      return {{"type", "number"}, {"exclusiveMinimum", 0}};
    case KeyKind::kNotNegative:
      return {{"type", "number"}, {"minimum", 0}};
    case KeyKind::kNumber:
      out = number_within(key.low, key.high);
      break;
    case KeyKind::kCount:
    case KeyKind::kButton:
      return {{"type", "integer"}, {"minimum", 0}};
    case KeyKind::kRange:
      return list_of({{"type", "number"}, {"minimum", 0}});
    case KeyKind::kVector:
      return defined("vector");
    case KeyKind::kVectors:
      return list_of(defined("vector"));
    case KeyKind::kSize:
      return list_of({{"type", "number"}, {"exclusiveMinimum", 0}});
    case KeyKind::kQuaternion:
      return defined("quaternion");
    case KeyKind::kWord:
      return {{"enum", words_of(key.words)}};
    case KeyKind::kMap:
      if (key.words.empty())
        return map_in(key);
      return {{"oneOf", {{{"enum", words_of(key.words)}}, map_in(key)}}};
    case KeyKind::kMaps:
      return list_of(map_in(key));
    case KeyKind::kNamedMaps:
      return {{"type", "object"}};
  }
  if (key.standard != nullptr)
    out["default"] = standard_of(key);
  return out;
}

Json value_of(const Key& key) {
  Json out = described(type_of(key), key.meaning);
  if (key.kind == KeyKind::kButton)
    out["maximum"] = kLastButton;
  if (key.kind == KeyKind::kRange)
    out["minItems"] = out["maxItems"] = 2;
  if (key.kind == KeyKind::kSize)
    out["minItems"] = out["maxItems"] = 3;
  if (out.contains("items") && key.low > 0)
    out["minItems"] = static_cast<int>(key.low);
  if (key.kind == KeyKind::kNamedMaps) {
    out["propertyNames"] = {{"pattern", "^[A-Za-z0-9_-]+$"}};
    out["additionalProperties"] = map_in(key);
  }
  if (key.standard != nullptr)
    out["default"] = standard_of(key);
  return out;
}

/// Of these keys and no others; with `properties` before them, which are not in the table.
Json map_of(const KeyGroup& group, Json properties) {
  Json out = described({{"type", "object"}}, group.meaning);
  for (const Key& key : group.keys)
    properties[key.name] = value_of(key);
  out["properties"] = std::move(properties), out["required"] = keys_with(KeyRule::kRequired, group);
  out["additionalProperties"] = false;
  if (const Names one = keys_with(KeyRule::kOneOf, group); !one.empty())
    out["oneOf"] = each_of(one);
  if (const Names two = keys_with(KeyRule::kNotTogether, group); !two.empty())
    out["not"]["required"] = two;
  const Names all = keys_with(KeyRule::kAllOrNone, group);
  for (const std::string_view key : all)
    out["dependentRequired"][key] = all;
  if (const Names with = keys_with(KeyRule::kWithFirst, group); !with.empty()) {
    out["if"] = has(group.keys.front().name);
    out["then"] = none_of(keys_with(KeyRule::kWithoutFirst, group));
    out["else"] = none_of(with);
  }
  return out;
}

Json parameter(const effects::EffectParameter& p) {
  Json out;
  if (p.shape == effects::ParameterShape::kNumber) {
    out = number_within(p.low, p.high);
  } else if (p.shape == effects::ParameterShape::kWord) {
    out["enum"] = words_of(p.words);
  } else if (p.shape == effects::ParameterShape::kText) {
    out = {{"type", "string"}, {"pattern", p.pattern}};
  } else {
    out = {{"$ref", "#/$defs/vector"}};
  }
  if (p.standard && p.shape != effects::ParameterShape::kText) {
    const std::array<double, 3>& v = *p.standard;
    out["default"] = p.shape == effects::ParameterShape::kNumber ? tidy(v[0])
                     : p.shape == effects::ParameterShape::kWord
                         ? out["enum"].at(static_cast<std::size_t>(v[0]))
                         : Json({tidy(v[0]), tidy(v[1]), tidy(v[2])});
  }
  return described(std::move(out), p.meaning);
}

Json effect_kind(const effects::EffectKind& kind) {
  Json out = map_of({.meaning = kind.summary});
  for (const effects::EffectParameter& p : kind.parameters) {
    out["properties"][p.name] = parameter(p);
    if (!p.standard)
      out["required"].push_back(p.name);
  }
  return out;
}

/// The keys that do not go with a kind of effect.
Names refused_by(const effects::EffectKind& kind) {
  Names refused;
  if (kind.everywhere)
    refused = words_of(keys::kNotEverywhere);
  if (!kind.needs(effects::EffectValues(kind.parameters)).contact)
    refused.push_back("object");
  return refused;
}

Json effect() {
  Json kinds = Json::object();
  Names names;
  for (const effects::EffectKind* kind : effects::effect_kinds()) {
    kinds[kind->name] = effect_kind(*kind);
    names.push_back(kind->name);
  }
  Json out = map_of(keys::effect, std::move(kinds));
  out["oneOf"] = each_of(names);
  for (const effects::EffectKind* kind : effects::effect_kinds()) {
    const Names refused = refused_by(*kind);
    if (!refused.empty())
      out["allOf"].push_back({{"if", has(kind->name)}, {"then", none_of(refused)}});
  }
  return out;
}

Json definitions() {
  Json out = {{"vector", numbers(3, "[x, y, z]")},
              {"quaternion", numbers(4, "Unit quaternion [w, x, y, z].")}};
  for (const KeyGroup* group : {&keys::pose, &keys::part, &keys::object, &keys::static_mesh,
                                &keys::region, &keys::effect, &keys::object_motion, &keys::motion})
    out[group->defined] = map_of(*group);
  out["object"] = {
      {"oneOf",
       {described(name(), "Name of an object that an entry above defines."), map_of(keys::object)}},
      {"description",
       "Object that this mesh belongs to. It may have its own material and motion. Default: "
       "`ground`."}};
  out["effect"] = effect();
  return out;
}

}  // namespace

std::string scene_schema() {
  Json schema = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", "voxtouch scene"},
      {"description", "A scene of voxtouch. Lengths are m, forces N, quaternions w x y z."}};
  schema.update(map_of(keys::scene));
  Json& contact = schema["properties"]["contact"];
  contact["if"] = {{"properties", {{"model", {{"enum", words_of(keys::kModelByArea)}}}}},
                   {"required", {"model"}}};
  contact["then"] = none_of({"stiffness_n_per_m"});
  Json by_name = has("rendering"), by_model = has("model");
  by_name["properties"]["rendering"]["enum"] = {"virtual_tool"};
  by_model["properties"]["model"]["enum"] = words_of(keys::kModelByArea);
  by_model.update(none_of({"rendering", "stiffness_n_per_m", "stiffness_n_per_m3"}));
  contact["oneOf"].push_back(std::move(by_name));
  contact["oneOf"].push_back(std::move(by_model));
  Json& by_hand = schema["properties"]["coupling"]["else"];
  by_hand["properties"]["kind"] = {{"enum", words_of(keys::kKindsByHand)}};
  schema["$defs"] = definitions();
  return schema.dump(2) + "\n";
}

}  // namespace voxtouch::scene
