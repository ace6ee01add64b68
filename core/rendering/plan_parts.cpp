// What the frames of a scene are made of, each with what calls for it and what it costs at most.
#include <fmt/core.h>

#include <algorithm>

#include "core/contact/constraint_rows.hpp"
#include "core/contact/contact_model.hpp"
#include "core/contact/contact_query.hpp"
#include "core/contact/limits.hpp"
#include "core/rendering/plan.hpp"

namespace voxtouch::rendering {
namespace {

constexpr const char* kRendering = "rendering";
/// What the stage behind the contact model may remember of a point: that it was in the surface
/// layer, and thrice the depth it is retained with. `field` remembers nothing, nor does a model
/// alone.
std::uint64_t stage_bytes_per_point(const scene::ContactSpec& contact) {
  if (contact.rendering == scene::RenderingKind::kMemoryless)
    return 0;
  return contact.model == "original" || contact.model == "adapted" ? 52 : 0;
}

PlanPart effect_part(const effects::EffectSpec& effect, const BuildCounts& n) {
  const std::uint64_t numbers =
      3 * effect.values.size() * sizeof(std::array<double, 3>);  // goal, now, rate
  return {.name = "effect " + effect.name,
          .node = kRendering,
          .why = fmt::format("The scene's list of effects names '{}'{}.", effect.kind->name,
                             effect.on ? "" : "; it is off at the start, ready to be switched on"),
          .bytes = numbers,
          .expected_ns = expected_ns(effect, n.tool_points)};
}

PlanPart coupling_part(const scene::Scene& scene) {
  return {.name = "coupling",
          .node = "coupling",
          .why = scene.design ? "The scene asks for a coupling that is designed for its device."
                 : scene.coupling.kind == "direct"
                     ? "The contact goes straight to the device; limits and the energy observer "
                       "are kept all the same."
                     : fmt::format("The scene sets a {} by hand.",
                                   scene.coupling.kind == "spring_damper" ? "spring-damper"
                                                                          : "shaping filter"),
          .expected_ns = kNsPerCoupling};
}

/// The static objects: their voxels and distances.
void add_static_objects(std::vector<PlanPart>& parts, const BuildCounts& n) {
  parts.push_back({.name = "voxmap",
                   .node = kRendering,
                   .why = "Every contact model asks it where the static objects are; asking is "
                          "counted with the pointshell.",
                   .bytes = n.voxmap_bytes});
  if (n.field_bytes > 0)
    parts.push_back({.name = "distance field",
                     .node = kRendering,
                     .why = "The contact model 'field' reads depth and direction from it; reading "
                            "is counted with the model.",
                     .bytes = n.field_bytes});
  if (n.proximity_bytes > 0)
    parts.push_back({.name = "distances round",
                     .node = kRendering,
                     .why = "The effect 'proximity' looks them up for points of the tool; that is "
                            "counted with the effect.",
                     .bytes = n.proximity_bytes});
}

/// The tool: its points, of which a frame tests at most `points` with all objects together.
void add_pointshell(std::vector<PlanPart>& parts, const BuildCounts& n, double points) {
  parts.push_back(
      {.name = "pointshell",
       .node = kRendering,
       .why = "The tool touches with its points; at most all of them are turned and looked up.",
       .bytes = n.shell_bytes,
       .expected_ns = kNsPerPoint * points});
  parts.push_back({.name = "culling tree",
                   .node = kRendering,
                   .why = "Leaves out the points that are far from everything; with it, the points "
                          "in single precision, which decide most.",
                   .bytes = contact::ContactQuery::lookup_bytes(n.shell_points)});
}

/// Of a look-up of all edge points of all objects in the tool [ns], as many of them in contact as a
/// step has rows.
double edge_ns(std::uint64_t objects, std::uint64_t edge_points) {
  const auto touching =
      static_cast<double>(std::min<std::uint64_t>(edge_points, contact::limits::kMaxRows));
  return static_cast<double>(objects) * kNsPerFrame +
         kNsPerPoint * static_cast<double>(edge_points) + kNsPerFieldPoint * touching;
}

/// What becomes of the `points` that touch.
void add_contact(std::vector<PlanPart>& parts, const scene::Scene& scene, const BuildCounts& n,
                 double points) {
  parts.push_back(
      {.name = "contact model " + scene.contact.model,
       .node = kRendering,
       .why = stage_bytes_per_point(scene.contact) > 0
                  ? "The scene's contact section names it; with it goes the memory of points that "
                    "have gone through."
                  : "The scene's contact section names it; it remembers no points that have gone "
                    "through.",
       .bytes = n.shell_points * (2 * sizeof(std::uint32_t) + stage_bytes_per_point(scene.contact)),
       .expected_ns = kNsPerFrame + ns_per_contact_point(scene.contact.model) * points});
  if (n.virtual_tool_lever_m > 0.0)
    parts.push_back(
        {.name = "virtual tool",
         .node = kRendering,
         .why = "The scene's contact section asks for it: the hand feels the spring to a tool that "
                "stays outside.",
         .bytes = 2 * (n.objects * n.shell_points + n.edge_points) * sizeof(contact::ConstraintRow),
         .expected_ns = contact::limits::kMaxQueries *
                        (kNsPerFrame + (kNsPerPoint + kNsPerFieldPoint) * points +
                         contact::limits::kMaxIterations * kNsPerIteration)});
  if (n.edge_points > 0)
    parts.push_back(
        {.name = "sharp edges",
         .node = kRendering,
         .why = "A virtual tool is asked for them: between its points it would go deeper over an "
                "edge than the tool itself.",
         .bytes = n.edge_bytes + edge_lookup_bytes(n.edge_points),
         .expected_ns = contact::limits::kMaxQueries * edge_ns(n.objects, n.edge_points)});
}

}  // namespace

std::uint64_t edge_lookup_bytes(std::uint64_t edge_points) noexcept {
  return edge_points * (8 * sizeof(double) + sizeof(std::uint32_t)) +
         contact::ContactQuery::lookup_bytes(edge_points);
}

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
  const double points = static_cast<double>(n.objects * n.shell_points);
  add_pointshell(parts, n, points);
  add_contact(parts, scene, n, points);
  for (const effects::EffectSpec& effect : scene.effects)
    parts.push_back(effect_part(effect, n));
  parts.push_back(coupling_part(scene));
  return parts;
}

}  // namespace voxtouch::rendering
