#include "core/rendering/voxel_tool.hpp"

#include <algorithm>

namespace voxtouch::rendering {
namespace {

contact::VirtualToolOptions options_of(const ObjectContacts& objects, double lever_m) {
  const contact::ContactQuery& query = objects.object(0).renderer->query();
  contact::VirtualToolOptions options{.points = query.shell().size(),
                                      .objects = objects.size(),
                                      .reach_m = query.reach_m(),
                                      .edge_m = query.voxmap().grid().edge,
                                      .lever_m = lever_m};
  for (std::size_t n = 0; n < objects.size(); ++n) {
    options.edge_m = std::min(options.edge_m, objects.object(n).voxmap.grid().edge);
    if (const auto& edges = objects.object(n).edges)
      options.edge_points += edges->query.shell().size();
  }
  return options;
}

}  // namespace

VoxelTool::VoxelTool(const ObjectContacts& objects, double lever_m)
    : tool_(options_of(objects, lever_m)) {
  for (std::size_t n = 0; n < objects.size(); ++n) {
    const StaticObject& object = objects.object(n);
    grounds_.push_back({.query = &object.renderer->query(), .field = &*object.field});
    if (!object.edges)
      continue;
    grounds_.back().edges = &object.edges->query;
    grounds_.back().tool_field = object.edges->tool_field;
  }
}

void VoxelTool::put(std::span<const Vec3> displacements) noexcept {
  for (std::size_t n = 0; n < grounds_.size(); ++n)
    grounds_[n].displacement = displacements[n];
}

contact::VirtualToolFrame VoxelTool::frame(const contact::HandSample& hand,
                                           std::span<const Vec3> displacements) noexcept {
  put(displacements);
  const contact::VirtualToolFrame found = tool_.frame(hand, grounds_);
  last_ = found.tool;
  return found;
}

void VoxelTool::relocate(const Pose& hand, std::span<const Vec3> displacements) noexcept {
  put(displacements);
  if (!tool_.place(hand, grounds_))
    tool_.place(last_, grounds_);
}

void VoxelTool::start_at(const Pose& tool, std::span<const Vec3> displacements) noexcept {
  put(displacements);
  tool_.place(tool, grounds_);
  last_ = tool;
}

}  // namespace voxtouch::rendering
