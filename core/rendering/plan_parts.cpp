// The parts of a scene's frames, each with its reason and an upper bound of its cost.
#include <fmt/core.h>

#include <algorithm>

#include "core/contact/contact_model.hpp"
#include "core/contact/contact_query.hpp"
#include "core/exact/work.hpp"
#include "core/rendering/plan.hpp"

namespace voxtouch::rendering {
namespace {

constexpr const char* kRendering = "rendering";
/// Memory of the contact stage for one point: its membership in the surface layer, and three times
/// its latched depth. `field` and memoryless models keep no state.
std::uint64_t stage_bytes_per_point(const scene::ContactSpec& contact) {
  if (contact.rendering == scene::RenderingKind::kMemoryless)
    return 0;
  return contact.model == "original" || contact.model == "adapted" ? 52 : 0;
}

PlanPart effect_part(const effects::EffectSpec& effect, const BuildCounts& n) {
  const std::uint64_t numbers =
      3 * effect.values.size() * sizeof(std::array<double, 3>);  // goal, present value, rate
  return {.name = "effect " + effect.name,
          .node = kRendering,
          .why = fmt::format("The scene lists the effect '{}'{}.", effect.kind->name,
                             effect.on ? "" : ", switched off at the start"),
          .bytes = numbers,
          .expected_ns = expected_ns(effect, n.tool_points)};
}

PlanPart coupling_part(const scene::Scene& scene) {
  return {.name = "coupling",
          .node = "coupling",
          .why = scene.design ? "Designed for the device."
                 : scene.coupling.kind == "direct"
                     ? "The contact force is the command; limits and energy observer stay active."
                     : fmt::format("The scene sets a {}.", scene.coupling.kind == "spring_damper"
                                                               ? "spring-damper"
                                                               : "shaping filter"),
          .expected_ns = kNsPerCoupling};
}

/// The static objects: their voxels and distances.
void add_static_objects(std::vector<PlanPart>& parts, const BuildCounts& n) {
  parts.push_back(
      {.name = "voxmap",
       .node = kRendering,
       .why = "Position of the static scene. Its look-ups are counted with the pointshell.",
       .bytes = n.voxmap_bytes});
  if (n.field_bytes > 0)
    parts.push_back(
        {.name = "distance field",
         .node = kRendering,
         .why = "Depth and direction for the contact model 'field'; counted with the model.",
         .bytes = n.field_bytes});
  if (n.proximity_bytes > 0)
    parts.push_back({.name = "distances round",
                     .node = kRendering,
                     .why = "For the effect 'proximity'; counted with the effect.",
                     .bytes = n.proximity_bytes});
}

/// The tool: its points, of which a frame tests at most `points` with all objects together.
void add_pointshell(std::vector<PlanPart>& parts, const BuildCounts& n, double points) {
  parts.push_back({.name = "pointshell",
                   .node = kRendering,
                   .why = points > 0.0
                              ? "Points of the tool; at most all are transformed and looked up."
                              : "Points of the tool for pictures; the virtual tool uses none.",
                   .bytes = n.shell_bytes,
                   .expected_ns = kNsPerPoint * points});
  parts.push_back({.name = "culling tree",
                   .node = kRendering,
                   .why = "Skips points far from the scene; holds points in single precision.",
                   .bytes = contact::ContactQuery::lookup_bytes(n.shell_points)});
}

/// Processing of the `points` in contact.
void add_contact(std::vector<PlanPart>& parts, const scene::Scene& scene, const BuildCounts& n,
                 double points) {
  parts.push_back(
      {.name = "contact model " + scene.contact.model,
       .node = kRendering,
       .why = stage_bytes_per_point(scene.contact) > 0
                  ? "Set in the scene; includes the memory of points that crossed a wall."
                  : "Set in the scene; without memory of points that crossed a wall.",
       .bytes = n.shell_points * (2 * sizeof(std::uint32_t) + stage_bytes_per_point(scene.contact)),
       .expected_ns = kNsPerFrame + ns_per_contact_point(scene.contact.model) * points});
}

PlanPart virtual_tool_part(const BuildCounts& n) {
  return {.name = "virtual tool",
          .node = kRendering,
          .why = "Set in the scene: the hand feels a spring to a tool that stays outside.",
          .bytes = n.virtual_tool_bytes,
          .expected_ns = kNsPerWork * static_cast<double>(exact::Work::kOfFrame)};
}

}  // namespace

double ns_per_contact_point(std::string_view contact_model) noexcept {
  return contact_model == "field" ? kNsPerFieldPoint : kNsPerPlainPoint;
}

double expected_ns(const effects::EffectSpec& effect, std::uint64_t tool_points) noexcept {
  if (!effect.on)
    return kNsPerEffectOff;
  const bool looks_round = effect.kind->needs(effect.values).proximity_m > 0.0;
  return kNsPerEffect + effect.kind->expected_ns +
         (looks_round ? kNsPerProximityPoint * static_cast<double>(tool_points) : 0.0);
}

std::vector<PlanPart> plan_parts(const scene::Scene& scene, const BuildCounts& n) {
  std::vector<PlanPart> parts;
  add_static_objects(parts, n);
  const bool virtual_tool = n.virtual_tool_lever_m > 0.0;
  const double points = virtual_tool ? 0.0 : static_cast<double>(n.objects * n.shell_points);
  add_pointshell(parts, n, points);
  if (virtual_tool)
    parts.push_back(virtual_tool_part(n));
  else
    add_contact(parts, scene, n, points);
  for (const effects::EffectSpec& effect : scene.effects)
    parts.push_back(effect_part(effect, n));
  parts.push_back(coupling_part(scene));
  return parts;
}

}  // namespace voxtouch::rendering
