/// The scene's section `coupling`: manual parameters, or the request for a design.
#include <fmt/core.h>

#include <array>

#include "core/coupling/coupling_spec.hpp"
#include "core/scene/scene_file.hpp"
#include "core/scene/scene_sections.hpp"

namespace voxtouch::scene {
namespace {

/// Refuses the keys with this rule, which contradict the scene's request; `why` completes "'key'
/// ...".
void refuse_all(const MapReader& map, KeyRule rule, std::string_view why) {
  for (const Key& key : keys::coupling.keys)
    if (key.rule == rule)
      map.refuse(key.name, why);
}

coupling::design::HandRange axis_range(const MapReader& map, std::string_view mass,
                                       std::string_view damping, std::string_view stiffness) {
  coupling::design::HandRange out;
  const auto read = [&](std::string_view key, double& low, double& high) {
    const auto range = map.get<std::array<double, 2>>(key);
    low = range[0], high = range[1];
  };
  read(mass, out.mass_min, out.mass_max);
  read(damping, out.damping_min, out.damping_max);
  read(stiffness, out.stiffness_min, out.stiffness_max);
  return out;
}

void read_hand(const SceneSource& source, const YamlNode& node, const MapReader& coupling,
               DesignOptions& options) {
  if (node.kind == YamlNode::Kind::kMap) {
    const MapReader map = coupling.inner("hand");
    options.hand = HandOption::kGiven;
    options.given_translation = axis_range(map, "mass_kg", "damping_ns_per_m", "stiffness_n_per_m");
    // A hand that is only half known about its rotation would be completed by guessing.
    if (map.has("inertia_kg_m2") || map.has("damping_nms_per_rad") ||
        map.has("stiffness_nm_per_rad"))
      options.given_rotation =
          axis_range(map, "inertia_kg_m2", "damping_nms_per_rad", "stiffness_nm_per_rad");
    return;
  }
  constexpr std::array kKinds = {HandOption::kPen, HandOption::kArm, HandOption::kAnyPassive};
  if (node.kind != YamlNode::Kind::kScalar)
    source.fail(
        node.place,
        fmt::format("'hand' must be one of: pen, arm, any_passive; or a map of ranges, but is {}.",
                    describe(node)));
  options.hand = kKinds[coupling.choice("hand")];
}

/// Places the findings of `validate` at the keys that they are about.
void judge(SceneSource& source, const YamlNode& node, const MapReader& map,
           const coupling::CouplingSpec& spec) {
  for (const coupling::CouplingIssue& issue : coupling::validate(spec, {}, kSceneSampleTimeS)) {
    const YamlNode* value = map.find(issue.field);
    const SourcePlace place = value ? value->place : node.place;
    if (issue.refuse)
      source.fail(place, issue.sentence);
    source.warn(place, issue.sentence);
  }
}

DesignOptions read_ask(SceneSource& source, const YamlNode& node, const MapReader& map) {
  map.get<std::string>("design");
  refuse_all(map, KeyRule::kWithoutFirst,
             "is set by the designer. Remove it, or set the coupling without 'design'.");
  DesignOptions options;
  map.read("kind", options.kind);
  if (options.kind != "auto" && options.kind != "shaping_filter")
    map.refuse("cutoff_hz",
               fmt::format("requires kind: auto or shaping_filter, not {}.", options.kind));
  map.read("cutoff_hz", options.cutoff_hz);
  coupling::CouplingSpec requested;
  requested.cutoff_hz = options.cutoff_hz;
  judge(source, node, map, requested);
  map.read("gain_margin", options.gain_margin);
  map.read("min_damping_ratio", options.min_damping_ratio);
  map.read("rotation_min_damping_ratio", options.rotation_min_damping_ratio);
  map.read("damping_force_ratio", options.damping_force_ratio);
  map.read("stiffness_cap_n_per_m", options.stiffness_cap_n_per_m);
  map.read("stiffness_cap_nm_per_rad", options.stiffness_cap_nm_per_rad);
  if (const YamlNode* hand = map.find("hand"))
    read_hand(source, *hand, map, options);
  map.read("released", options.released);
  map.read("inject_damping", options.inject_damping);
  map.read("velocity_windows", options.velocity_windows);
  map.read("run_infeasible", options.run_infeasible);
  if (options.hand == HandOption::kAnyPassive && !options.released)
    source.fail(
        map.place_of("released"),
        "'released: false' excludes 'hand: any_passive', which includes a released device.");
  return options;
}

coupling::CouplingSpec read_by_hand(SceneSource& source, const YamlNode& node,
                                    const MapReader& map) {
  refuse_all(map, KeyRule::kWithFirst, "requires 'design: auto'.");
  coupling::CouplingSpec spec;
  if (const YamlNode* kind = map.find("kind")) {
    if (kind->text == "auto")
      source.fail(kind->place, "'kind: auto' requires 'design: auto'.");
    read_choice(source, *kind, "kind", words_of(keys::kKindsByHand));
    map.read("kind", spec.kind);
  }
  const auto belongs = [&](std::string_view key, std::string_view kind) {
    if (spec.kind != kind)
      map.refuse(key, fmt::format("requires kind: {}, not {}.", kind, spec.kind));
  };
  for (const auto key : {"cutoff_hz", "damping_ratio", "gain"})
    belongs(key, "shaping_filter");
  for (const auto key : {"stiffness_n_per_m", "damping_ns_per_m"})
    belongs(key, "spring_damper");
  map.read("cutoff_hz", spec.cutoff_hz);
  map.read("damping_ratio", spec.damping_ratio);
  map.read("gain", spec.gain);
  map.read("stiffness_n_per_m", spec.stiffness_n_per_m);
  map.read("damping_ns_per_m", spec.damping_ns_per_m);
  map.read("stiffness_cap_n_per_m", spec.stiffness_cap_n_per_m);
  map.read("stiffness_cap_nm_per_rad", spec.stiffness_cap_nm_per_rad);
  map.read("injected_damping_ns_per_m", spec.injected_damping_ns_per_m);
  map.read("injected_damping_nms_per_rad", spec.injected_damping_nms_per_rad);
  if (!map.has("injected_damping_ns_per_m") && !map.has("injected_damping_nms_per_rad"))
    for (const auto& [key, job] : {std::pair("velocity_filter_hz", "sets the velocity estimate of"),
                                   {"velocity_window", "sets the velocity estimate of"},
                                   {"slow_velocity_hz", "sets the velocity estimate of"},
                                   {"velocity_band_m_per_s", "sets the velocity estimate of"},
                                   {"damping_force_ratio", "limits"}})
      map.refuse(key, fmt::format("{} injected damping; it requires injected_damping_ns_per_m or "
                                  "injected_damping_nms_per_rad.",
                                  job));
  map.read("velocity_filter_hz", spec.velocity_filter_hz);
  map.read("velocity_window", spec.velocity_window);
  map.read("slow_velocity_hz", spec.slow_velocity_hz);
  map.read("velocity_band_m_per_s", spec.velocity_band_m_per_s);
  map.read("damping_force_ratio", spec.damping_force_ratio);
  judge(source, node, map, spec);
  return spec;
}

}  // namespace

coupling::CouplingSpec read_coupling(SceneSource& source, const YamlNode& node,
                                     std::optional<DesignOptions>& design) {
  const MapReader map(source, node, "coupling", keys::coupling);
  if (!map.has("design"))
    return read_by_hand(source, node, map);
  design = read_ask(source, node, map);
  return {};
}

}  // namespace voxtouch::scene
