/// The scene's section `coupling`: parameters set by hand, or what a design is asked for.
#include <fmt/core.h>

#include <array>

#include "core/coupling/coupling_spec.hpp"
#include "core/scene/scene_file.hpp"
#include "core/scene/scene_sections.hpp"

namespace voxtouch {
namespace {

constexpr std::array<std::string_view, 5> kOnlyWithDesign = {"gain_margin", "hand", "released", "inject_damping",
                                                             "run_infeasible"};
constexpr std::array<std::string_view, 7> kOnlyByHand = {"damping_ratio",
                                                         "gain",
                                                         "stiffness_n_per_m",
                                                         "damping_ns_per_m",
                                                         "injected_damping_ns_per_m",
                                                         "injected_damping_nms_per_rad",
                                                         "velocity_filter_hz"};

HandRange axis_range(const SceneSource& source, const MapReader& map, std::string_view mass, std::string_view damping,
                     std::string_view stiffness) {
  HandRange out;
  const auto read = [&](std::string_view key, double& low, double& high) {
    const std::array<double, 2> range = read_range(source, map.require(key), key);
    low = range[0], high = range[1];
  };
  read(mass, out.mass_min, out.mass_max);
  read(damping, out.damping_min, out.damping_max);
  read(stiffness, out.stiffness_min, out.stiffness_max);
  return out;
}

void read_hand(const SceneSource& source, const YamlNode& node, DesignOptions& ask) {
  if (node.kind == YamlNode::Kind::kMap) {
    const MapReader map(source, node, "hand",
                        {"mass_kg", "damping_ns_per_m", "stiffness_n_per_m", "inertia_kg_m2", "damping_nms_per_rad",
                         "stiffness_nm_per_rad"});
    ask.hand = HandOption::kGiven;
    ask.given_translation = axis_range(source, map, "mass_kg", "damping_ns_per_m", "stiffness_n_per_m");
    // A hand that is only half known about its rotation would be completed by guessing.
    if (map.has("inertia_kg_m2") || map.has("damping_nms_per_rad") || map.has("stiffness_nm_per_rad"))
      ask.given_rotation = axis_range(source, map, "inertia_kg_m2", "damping_nms_per_rad", "stiffness_nm_per_rad");
    return;
  }
  constexpr std::array kinds = {HandOption::kPen, HandOption::kArm, HandOption::kAnyPassive};
  if (node.kind != YamlNode::Kind::kScalar)
    source.fail(node.place,
                fmt::format("'hand' must be one of: pen, arm, any_passive; or a map of ranges, but here is {}.",
                            describe(node)));
  ask.hand = kinds[read_choice(source, node, "hand", {"pen", "arm", "any_passive"})];
}

double read_gain_margin(const SceneSource& source, const YamlNode& node, std::string_view what) {
  const double value = read_number(source, node, what);
  if (!(value >= 1.0)) source.fail(node.place, fmt::format("'{}' is {}; it must be 1 or above.", what, value));
  return value;
}

/// Places the findings of `validate` at the keys that they are about.
void judge(SceneSource& source, const YamlNode& node, const MapReader& map, const CouplingSpec& spec) {
  for (const CouplingIssue& issue : validate(spec, {}, kSceneSampleTimeS)) {
    const YamlNode* value = map.find(issue.field);
    const SourcePlace place = value ? value->place : node.place;
    if (issue.refuse) source.fail(place, issue.sentence);
    source.warn(place, issue.sentence);
  }
}

DesignOptions read_ask(SceneSource& source, const YamlNode& node, const MapReader& map) {
  read_choice(source, map.require("design"), "design", {"auto"});
  for (const std::string_view key : kOnlyByHand)
    map.refuse(key, "is what the designer chooses; leave it out, or set the coupling by hand without 'design'.");
  DesignOptions ask;
  if (const YamlNode* kind = map.find("kind")) {
    const std::vector<std::string_view> kinds{"auto", "shaping_filter", "spring_damper", "direct"};
    ask.kind = kinds[read_choice(source, *kind, "kind", kinds)];
  }
  if (ask.kind != "auto" && ask.kind != "shaping_filter")
    map.refuse("cutoff_hz", fmt::format("goes with kind: auto or shaping_filter, not with {}.", ask.kind));
  map.optional("cutoff_hz", ask.cutoff_hz, read_positive);
  CouplingSpec wished;
  wished.cutoff_hz = ask.cutoff_hz;
  judge(source, node, map, wished);
  map.optional("gain_margin", ask.gain_margin, read_gain_margin);
  map.optional("stiffness_cap_n_per_m", ask.stiffness_cap_n_per_m, read_positive);
  map.optional("stiffness_cap_nm_per_rad", ask.stiffness_cap_nm_per_rad, read_positive);
  if (const YamlNode* hand = map.find("hand")) read_hand(source, *hand, ask);
  map.optional("released", ask.released, read_flag);
  map.optional("inject_damping", ask.inject_damping, read_flag);
  map.optional("run_infeasible", ask.run_infeasible, read_flag);
  if (ask.hand == HandOption::kAnyPassive && !ask.released)
    source.fail(map.place_of("released"),
                "'released: false' does not go with 'hand: any_passive', among which is no hand at all.");
  return ask;
}

CouplingSpec read_by_hand(SceneSource& source, const YamlNode& node, const MapReader& map) {
  for (const std::string_view key : kOnlyWithDesign) map.refuse(key, "goes with 'design: auto'.");
  CouplingSpec spec;
  if (const YamlNode* kind = map.find("kind")) {
    if (kind->text == "auto") source.fail(kind->place, "'kind: auto' goes with 'design: auto', which is not here.");
    const std::vector<std::string_view> kinds{"shaping_filter", "spring_damper", "direct"};
    spec.kind = kinds[read_choice(source, *kind, "kind", kinds)];
  }
  const auto belongs = [&](std::string_view key, std::string_view kind) {
    if (spec.kind != kind) map.refuse(key, fmt::format("goes with kind: {}, not with {}.", kind, spec.kind));
  };
  for (const auto key : {"cutoff_hz", "damping_ratio", "gain"}) belongs(key, "shaping_filter");
  for (const auto key : {"stiffness_n_per_m", "damping_ns_per_m"}) belongs(key, "spring_damper");
  map.optional("cutoff_hz", spec.cutoff_hz, read_positive);
  map.optional("damping_ratio", spec.damping_ratio, read_positive);
  map.optional("gain", spec.gain, read_positive);
  map.optional("stiffness_n_per_m", spec.stiffness_n_per_m, read_positive);
  map.optional("damping_ns_per_m", spec.damping_ns_per_m, read_not_negative);
  map.optional("stiffness_cap_n_per_m", spec.stiffness_cap_n_per_m, read_positive);
  map.optional("stiffness_cap_nm_per_rad", spec.stiffness_cap_nm_per_rad, read_positive);
  map.optional("injected_damping_ns_per_m", spec.injected_damping_ns_per_m, read_not_negative);
  map.optional("injected_damping_nms_per_rad", spec.injected_damping_nms_per_rad, read_not_negative);
  if (!map.has("injected_damping_ns_per_m") && !map.has("injected_damping_nms_per_rad"))
    map.refuse("velocity_filter_hz",
               "filters the velocity for injected damping; it goes with injected_damping_ns_per_m or "
               "injected_damping_nms_per_rad.");
  map.optional("velocity_filter_hz", spec.velocity_filter_hz, read_positive);
  judge(source, node, map, spec);
  return spec;
}

}  // namespace

CouplingSpec read_coupling(SceneSource& source, const YamlNode& node, std::optional<DesignOptions>& design) {
  std::vector<std::string_view> allowed{"design", "kind", "cutoff_hz", "stiffness_cap_n_per_m",
                                        "stiffness_cap_nm_per_rad"};
  allowed.insert(allowed.end(), kOnlyByHand.begin(), kOnlyByHand.end());
  allowed.insert(allowed.end(), kOnlyWithDesign.begin(), kOnlyWithDesign.end());
  const MapReader map(source, node, "coupling", std::move(allowed));
  if (!map.has("design")) return read_by_hand(source, node, map);
  design = read_ask(source, node, map);
  return {};
}

}  // namespace voxtouch
