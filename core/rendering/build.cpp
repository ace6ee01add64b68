#include "core/rendering/build.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/rendering/built_parts.hpp"
#include "core/rendering/contact_parameters.hpp"
#include "core/rendering/contact_range.hpp"

namespace voxtouch::rendering {
namespace {

/// The force law of one object, with its own material. The stiffness of all objects together is
/// bounded by the sum of theirs.
void add_contact_law(const PartsRequest& request, const pointshell::Pointshell& shell,
                     StaticObject& object, BuildCounts& counts) {
  const scene::Scene& scene = request.scene;
  const scene::ContactSpec& material =
      object.id == 0 ? scene.contact : scene.objects[object.id - 1].contact;
  const contact::ContactParameters parameters =
      contact_parameters(material, request.model, shell, request.choices.weights);
  object.renderer.emplace(object.voxmap, shell, request.model, parameters,
                          object.field ? &*object.field : nullptr);
  counts.shell_bytes += shell.size() * (8 * sizeof(double) + sizeof(std::uint32_t));
  if (request.virtual_tool())
    return;  // one spring for all objects
  const StiffnessBounds contact =
      contact_stiffness(shell, parameters, object.field ? object.field->steepest_gradient() : 1.0);
  const auto add = [](const coupling::design::ContactRange& one,
                      coupling::design::ContactRange& sum) {
    sum.one_point = std::max(sum.one_point, one.one_point);
    sum.all_points += one.all_points;
  };
  add(contact.translation, counts.contact.translation),
      add(contact.rotation, counts.contact.rotation);
}

/// One spring, independent of the touched object.
void add_virtual_tool(const PartsRequest& request, const contact::ContactRenderer& renderer,
                      EffectGround& ground, BuildCounts& counts) {
  if (!ground.bodies)
    return;
  counts.virtual_tool_bytes = ground.bodies->bytes();
  counts.virtual_tool_triangles = ground.bodies->tool().features().faces.size();
  for (const exact::ObjectBody& body : ground.bodies->bodies())
    counts.virtual_tool_scene_triangles += body.features().faces.size();
  const scene::Scene& scene = request.scene;
  const double reach = renderer.query().reach_m(), lever = scene.lever_m.value_or(reach);
  if (!(reach > 0.0))
    throw std::invalid_argument(scene.file.string() +
                                ": the tool is a point; a virtual tool needs a tool with extent");
  counts.contact = spring_of_any_device(lever);
  ground.virtual_tool_lever_m = counts.virtual_tool_lever_m = lever;
}

}  // namespace

BuiltScene::BuiltScene(std::vector<std::unique_ptr<StaticObject>> objects,
                       std::vector<effects::EffectSpec> effects, EffectGround ground, Plan plan,
                       double largest_shell_gap_m)
    : contacts_(std::move(objects)),
      ground_(std::move(ground)),
      scene_(contacts_, std::move(effects),
             {ground_.proximity ? &*ground_.proximity : nullptr, ground_.tool.points, ground_.body,
              ground_.bodies.get(), ground_.virtual_tool_lever_m}),
      plan_(std::move(plan)),
      largest_shell_gap_m_(largest_shell_gap_m) {}

std::unique_ptr<BuiltScene> build_scene(const scene::Scene& scene, const ParallelFor& parallel_for,
                                        const BuildChoices& choices, const Progress& progress) {
  contact::ContactModelKind kind = contact::ContactModelKind::kAdapted;
  if (!choices.model && !contact::parse_contact_model(scene.contact.model, kind))
    throw std::invalid_argument(scene.file.string() + ": unknown contact model '" +
                                scene.contact.model + "'");
  const PartsRequest request{scene, choices, choices.model.value_or(kind)};
  BuiltParts parts = build_parts(request, parallel_for, progress);
  for (auto& object : parts.objects)
    add_contact_law(request, parts.shell, *object, parts.counts);
  EffectGround ground{.proximity = std::move(parts.proximity),
                      .tool = std::move(parts.tool_points),
                      .body = parts.body,
                      .bodies = std::move(parts.bodies)};
  parts.counts.tool_reach_m = parts.objects.front()->renderer->query().reach_m();
  add_virtual_tool(request, *parts.objects.front()->renderer, ground, parts.counts);
  return std::make_unique<BuiltScene>(std::move(parts.objects), scene.effects, std::move(ground),
                                      make_plan(scene, parts.counts), parts.largest_gap_m);
}

}  // namespace voxtouch::rendering
