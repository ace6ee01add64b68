// The `effects` of a scene; core/effects defines the kinds and their keys.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/effects/effect_change.hpp"
#include "core/scene/scene_sections.hpp"

namespace voxtouch::scene {
namespace {

std::array<double, 3> read_value(const SceneSource& source, const YamlNode& node,
                                 const effects::EffectParameter& parameter) {
  const auto three = [](const Vec3& v) { return std::array{v.x(), v.y(), v.z()}; };
  switch (parameter.shape) {
    case effects::ParameterShape::kNumber:
      return {read_number(source, node, parameter.name), 0.0, 0.0};
    case effects::ParameterShape::kVector:
      return three(read_vec3(source, node, parameter.name));
    case effects::ParameterShape::kDirection: {
      const Vec3 v = read_vec3(source, node, parameter.name);
      if (!(v.norm() > 0.0))
        source.fail(node.place,
                    fmt::format("'{}' is a direction and must not be zero.", parameter.name));
      return three(v.normalized());
    }
    case effects::ParameterShape::kWord:
      return {
          static_cast<double>(read_choice(source, node, parameter.name, words_of(parameter.words))),
          0.0, 0.0};
    case effects::ParameterShape::kText:
      return {};
  }
  return {};
}

std::string read_text_of(const SceneSource& source, const YamlNode& node,
                         const effects::EffectKind& kind, std::string_view parameter) {
  std::string text = read_text(source, node, parameter);
  if (const std::string why = kind.check_text(text); !why.empty())
    source.fail(node.place, fmt::format("'{}' {}.", effects::quotable(text), why));
  return text;
}

/// `text`: of its kText parameter.
effects::EffectValues read_values(const SceneSource& source, const YamlNode& node,
                                  const effects::EffectKind& kind, std::string& text) {
  std::vector<std::string_view> keys;
  for (const effects::EffectParameter& parameter : kind.parameters)
    keys.push_back(parameter.name);
  const MapReader map(source, node, kind.name, keys);
  effects::EffectValues values(kind.parameters);
  for (std::size_t n = 0; n < kind.parameters.size(); ++n) {
    const effects::EffectParameter& parameter = kind.parameters[n];
    const YamlNode* value =
        parameter.standard ? map.find(parameter.name) : &map.require(parameter.name);
    if (value == nullptr)
      continue;
    if (parameter.shape == effects::ParameterShape::kText)
      text = read_text_of(source, *value, kind, parameter.name);
    values.at(n) = read_value(source, *value, parameter);
    effects::EffectValues alone = values;
    if (const std::string why = effects::check_value(parameter, alone.at(n)); !why.empty())
      source.fail(value->place, why + ".");
  }
  if (const std::string why = effects::check_values(kind, values); !why.empty())
    source.fail(node.place, why + ".");
  return values;
}

effects::Region read_region(const SceneSource& source, const YamlNode& node, const MapReader& map) {
  effects::Region region;
  map.read("blend_m", region.blend_m);
  if (map.has("sphere") == map.has("box"))
    source.fail(node.place, "'region' needs one of: sphere, box.");
  if (map.has("sphere")) {
    const MapReader sphere = map.inner("sphere");
    region.shape = effects::SphereRegion{sphere.get<Vec3>("centre"), sphere.get<double>("radius")};
  } else {
    const MapReader box = map.inner("box");
    region.shape = effects::BoxRegion{read_pose(box), box.get<Vec3>("size")};
  }
  return region;
}

/// "ground", or one of the scene's objects.
std::uint32_t read_object_name(const SceneSource& source, const YamlNode& node,
                               const Scene& scene) {
  std::vector<std::string_view> names{"ground"};
  for (const ObjectSpec& object : scene.objects)
    names.push_back(object.name);
  return static_cast<std::uint32_t>(read_choice(source, node, "object", names));
}

effects::EffectSpec read_effect(const SceneSource& source, const YamlNode& node,
                                const Scene& scene) {
  std::vector<std::string_view> kinds;
  for (const effects::EffectKind* kind : effects::effect_kinds())
    kinds.push_back(kind->name);
  if (node.kind != YamlNode::Kind::kMap || node.entries.empty())
    source.fail(
        node.place,
        fmt::format(
            "An effect must be a map such as {{viscosity: {{damping_ns_per_m: 1}}}}, but is {}.",
            describe(node)));
  const MapReader map(source, node, "an effect", keys::effect, kinds);
  effects::EffectSpec spec;
  for (const effects::EffectKind* kind : effects::effect_kinds()) {
    const YamlNode* values = map.find(kind->name);
    if (values == nullptr)
      continue;
    if (spec.kind != nullptr)
      source.fail(
          map.place_of(kind->name),
          fmt::format("An entry has one effect; '{}' is already in it. Add another entry for '{}'.",
                      spec.kind->name, kind->name));
    spec.kind = kind;
    spec.values = read_values(source, *values, *kind, spec.text);
  }
  if (spec.kind == nullptr)
    source.fail(node.place,
                fmt::format("The entry has no effect. Valid effects: {}.", listed(kinds)));
  spec.name = spec.kind->name;
  spec.place = fmt::format("{}:{}:{}", source.file.string(), node.place.line, node.place.column);
  if (spec.kind->everywhere)
    for (const std::string_view key : words_of(keys::kNotEverywhere))
      map.refuse(key, fmt::format("is not allowed with '{}', which has no region and no gain.",
                                  spec.kind->name));
  if (!spec.kind->needs(spec.values).contact)
    map.refuse("object", fmt::format("is not allowed with '{}', which does not use contacts.",
                                     spec.kind->name));
  if (const YamlNode* object = map.find("object"))
    spec.object = read_object_name(source, *object, scene);
  map.read("name", spec.name);
  map.read("on", spec.on);
  if (const YamlNode* region = map.find("region")) {
    spec.region = read_region(source, *region, map.inner("region"));
    if (!std::isfinite(effects::bound_of(spec).stiffness_n_per_m))
      source.fail(region->place,
                  fmt::format("'{}' has no force limit with these values, so its stiffness at the "
                              "region's edge is unbounded. Remove the region, or limit the effect.",
                              spec.kind->name));
  }
  map.read("gain", spec.gain);
  return spec;
}

}  // namespace

std::vector<effects::EffectSpec> read_effects(SceneSource& source, const YamlNode& node,
                                              const Scene& scene) {
  std::vector<effects::EffectSpec> effects;
  for (const YamlNode& item : read_list(source, node, "effects")) {
    effects::EffectSpec spec = read_effect(source, item, scene);
    for (const effects::EffectSpec& other : effects) {
      if (other.name != spec.name)
        continue;
      source.fail(item.place,
                  spec.kind->alone && other.kind == spec.kind
                      ? fmt::format("Second '{}'; limit 1 per scene.", spec.kind->name)
                      : fmt::format("Duplicate effect name '{}'. Set another name (name: ...).",
                                    spec.name));
    }
    if (spec.kind->alone &&
        std::any_of(effects.begin(), effects.end(),
                    [&](const effects::EffectSpec& e) { return e.kind == spec.kind; }))
      source.fail(item.place, fmt::format("Second '{}'; limit 1 per scene.", spec.kind->name));
    effects.push_back(std::move(spec));
  }
  return effects;
}

}  // namespace voxtouch::scene
