#include <cmath>

#include "core/rendering/built_parts.hpp"
#include "core/types/stored_bytes.hpp"

namespace voxtouch::rendering {
namespace {

template <class Archive, class Grids>
void grids_of(Archive& archive, Grids& grids) {
  for (auto& [object, origin, at_multiples, given] : grids)
    archive(object), archive(origin), archive(at_multiples), archive(given);
}

/// What is there once the parts are built; the bindings name all members, so that a new one does
/// not compile before it is kept too.
template <class Archive, class Counts>
void counts_of(Archive& archive, Counts& counts) {
  auto& [static_triangles, dynamic_triangles, surface_voxels, interior_voxels, shell_points,
         objects, grids, voxmap_bytes, shell_bytes, field_bytes, field_nodes, field_depth_m,
         thinnest_m, thinnest_mesh, proximity_bytes, proximity_nodes, proximity_m,
         proximity_smoothing_m, tool_points, tool_gap_m, open_meshes, virtual_tool_lever_m,
         budget_points, level_points, level_gap_m, level_bytes, edge_points, edge_bytes,
         edges_left_out, contact, closed, mesh_warnings] = counts;
  archive(static_triangles), archive(dynamic_triangles), archive(surface_voxels),
      archive(interior_voxels), archive(shell_points), archive(objects);
  archive(voxmap_bytes), archive(field_bytes), archive(field_nodes), archive(field_depth_m),
      archive(thinnest_m), archive(thinnest_mesh);
  archive(proximity_bytes), archive(proximity_nodes), archive(proximity_m),
      archive(proximity_smoothing_m), archive(tool_points), archive(tool_gap_m);
  archive(edge_points), archive(edge_bytes), archive(edges_left_out);
  archive(open_meshes), archive(closed), archive(mesh_warnings);
  // Of the contact's law, which is added each time.
  (void)shell_bytes, (void)virtual_tool_lever_m, (void)contact;
  (void)budget_points, (void)level_points, (void)level_gap_m, (void)level_bytes;
  grids_of(archive, grids);  // as many as there are objects
}

template <class Archive, class Tool>
void tool_points_of(Archive& archive, Tool& tool) {
  for (auto& [position, share] : tool.points)
    archive(position), archive(share);
  archive(tool.gap_m), archive(tool.reach_m);
}

void put_object(const StaticObject& object, ByteWriter& out) {
  out(object.id);
  object.voxmap.put(out);
  out(object.field.has_value());
  if (object.field)
    object.field->put(out);
  out(object.edge_points.size() > 0);
  if (object.edge_points.size() > 0)
    put(object.edge_points, out);
}

std::unique_ptr<StaticObject> take_object(ByteReader& in, const PartsRequest& request,
                                          std::uint32_t least_id) {
  const scene::Scene& scene = request.scene;
  std::uint32_t id = 0;
  in(id);
  ByteReader::require(id >= least_id && id <= scene.objects.size(),
                      "an object that the scene does not have");
  voxmap::Voxmap map = voxmap::Voxmap::take(in);
  ByteReader::require(map.grid().edge == scene.voxel_size_m,
                      "voxels of another size than the scene's");
  bool has_field = false;
  in(has_field);
  ByteReader::require(has_field == (request.model == contact::ContactModelKind::kField),
                      "distances that are missing, or not asked for");
  std::optional<voxmap::DistanceField> field;
  if (has_field)
    field = voxmap::DistanceField::take(in);
  ByteReader::require(!field || (field->grid().edge == map.grid().edge &&
                                 field->grid().origin == map.grid().origin),
                      "distances of another grid");
  bool has_edges = false;
  in(has_edges);
  pointshell::Pointshell edge_points;
  if (has_edges)
    edge_points = pointshell::take_shell(in);
  return std::make_unique<StaticObject>(
      StaticObject{.id = id,
                   .name = id == 0 ? "ground" : scene.objects[id - 1].name,
                   .voxmap = std::move(map),
                   .field = std::move(field),
                   .edge_points = std::move(edge_points),
                   .moves = id == 0 ? std::nullopt : scene.objects[id - 1].moves,
                   .renderer = {},
                   .edges = {}});
}

void take_tool_body(ByteReader& in, BuiltParts& parts) {
  bool there = false;
  in(there);
  std::size_t edge_points = 0;
  for (const auto& object : parts.objects)
    edge_points += object->edge_points.size();
  ByteReader::require(there == (edge_points > 0),
                      "edges without a tool to look them up in, or the other way round");
  if (!there)
    return;
  voxmap::Voxmap map = voxmap::Voxmap::take(in);
  voxmap::DistanceField field = voxmap::DistanceField::take(in);
  ByteReader::require(field.grid().edge == map.grid().edge &&
                          field.grid().origin == map.grid().origin && field.has_inside(),
                      "distances to the tool of another grid");
  parts.tool_body = std::make_unique<ToolBody>(std::move(map), std::move(field));
}

effects::BodyShape take_body(ByteReader& in) {
  effects::BodyShape body;
  in(body.centre), in(body.inertia_m2), in(body.reach_m);
  const Eigen::LLT<Mat3> cholesky(body.inertia_m2);
  ByteReader::require(body.centre.allFinite() && body.inertia_m2.allFinite() &&
                          cholesky.info() == Eigen::Success && std::isfinite(body.reach_m) &&
                          body.reach_m >= 0.0,
                      "a body that cannot be moved");
  return body;
}

void take_proximity(ByteReader& in, BuiltParts& parts) {
  parts.proximity.emplace(in);
  std::uint64_t points = 0;
  in(points);
  ByteReader::require(points > 0 && points <= ToolPoints::kMaxPoints,
                      "more points of the tool than are looked up, or none");
  parts.tool_points.points.resize(points);
  tool_points_of(in, parts.tool_points);
  for (const effects::ToolPoint& point : parts.tool_points.points)
    ByteReader::require(
        point.position.allFinite() && point.share >= 0.0 && point.share <= 1.0 + 1e-9,
        "a point of the tool that is none");
  ByteReader::require(
      std::isfinite(parts.tool_points.gap_m) && std::isfinite(parts.tool_points.reach_m),
      "points of the tool without a gap or reach");
}

}  // namespace

std::uint64_t expected_bytes(const BuiltParts& parts) noexcept {
  return parts.counts.voxmap_bytes + parts.counts.field_bytes + parts.counts.proximity_bytes +
         parts.counts.edge_bytes + (parts.shell.size() + parts.counts.edge_points) * 68 + 4096;
}

std::string stored(const BuiltParts& parts) {
  ByteWriter out;
  out.reserve(expected_bytes(parts));
  out(std::uint64_t{parts.objects.size()}), out(std::uint64_t{parts.counts.grids.size()});
  for (const auto& object : parts.objects)
    put_object(*object, out);
  put(parts.shell, out);
  out(parts.largest_gap_m);
  out(parts.tool_body != nullptr);
  if (parts.tool_body)
    parts.tool_body->voxmap.put(out), parts.tool_body->field.put(out);
  if (parts.body)
    out(parts.body->centre), out(parts.body->inertia_m2), out(parts.body->reach_m);
  if (parts.proximity) {
    parts.proximity->put(out);
    out(std::uint64_t{parts.tool_points.points.size()});
    tool_points_of(out, parts.tool_points);
  }
  counts_of(out, parts.counts);
  return out.take();
}

BuiltParts parts_from(std::string_view bytes, const PartsRequest& request) {
  const effects::EffectNeeds needs = effects::needs_of(request.scene.effects);
  ByteReader in(bytes);
  BuiltParts parts;
  std::uint64_t objects = 0, grids = 0;
  in(objects), in(grids);
  ByteReader::require(
      objects >= 1 && objects <= request.scene.objects.size() + 1 && grids == objects,
      "more objects than the scene has, or none");
  for (std::uint32_t least_id = 0; parts.objects.size() < objects;
       least_id = parts.objects.back()->id + 1)
    parts.objects.push_back(take_object(in, request, least_id));
  parts.shell = pointshell::take_shell(in);
  ByteReader::require(parts.shell.size() > 0, "a tool without points");
  in(parts.largest_gap_m);
  ByteReader::require(std::isfinite(parts.largest_gap_m) && parts.largest_gap_m >= 0.0,
                      "a gap that is none");
  take_tool_body(in, parts);
  if (needs.body)
    parts.body = take_body(in);
  if (needs.proximity_m > 0.0)
    take_proximity(in, parts);
  parts.counts.grids.resize(grids);
  counts_of(in, parts.counts);
  in.finish();
  return parts;
}

}  // namespace voxtouch::rendering
