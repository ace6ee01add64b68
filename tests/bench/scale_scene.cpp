#include "tests/bench/scale_scene.hpp"

#include <algorithm>
#include <bit>

#include "core/contact/contact_query.hpp"
#include "core/contact/instructions.hpp"
#include "core/contact/leaf_kernel.hpp"
#include "core/contact/query_kernel.hpp"

namespace voxtouch::bench {
namespace {

/// Groups of spheres that a query visits, from the group of `level` at `first` downwards.
double groups_below(const contact::Lookup& lookup,
                    const std::vector<contact::SphereTree::Level>& levels, std::size_t level,
                    std::size_t first) {
  constexpr std::size_t kNodes = contact::SphereTree::kFanOut;
  const std::size_t count = std::min(levels[level].count - first, kNodes);
  std::uint32_t near =
      contact::leaf_kernel(contact::instructions()).near_spheres(lookup, levels[level], first) &
      ((1U << count) - 1U);
  double groups = 1.0;
  for (; level > 0 && near != 0; near &= near - 1)
    groups += groups_below(lookup, levels, level - 1,
                           kNodes * (first + static_cast<std::size_t>(std::countr_zero(near))));
  return groups;
}

/// Number of groups of spheres that a query visits at this pose.
double looked_at(const contact::ContactQuery& query, const Pose& pose) {
  contact::HitSource source;
  source.edge = query.voxmap().grid().edge;
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      source.r[row][column] = rotation(row, column);
    source.t[row] = pose.position[row] - query.voxmap().grid().origin[row];
  }
  contact::QueryFrame frame;
  if (!contact::make_query_frame(query.voxmap(), source, query.reach_m(), frame))
    return 0.0;
  const contact::QueryData data{&query.voxmap(), query.shell().size(),
                                &query.tree(),   nullptr,
                                nullptr,         nullptr};  // no point is visited
  const auto& levels = query.tree().levels();
  return levels.empty()
             ? 0.0
             : groups_below({data, frame, data.voxmap->arrays()}, levels, levels.size() - 1, 0);
}

}  // namespace

voxmap::Grid grid_of(int resolution) {
  const double edge = kEdge * 256.0 / resolution;
  return {edge * Vec3(0.06, 0.08, 0.1), edge};
}

FrameCounts frame_counts(const voxmap::Voxmap& map, Place place, std::size_t points) {
  const contact::ContactQuery query(map, tool(place, points));
  contact::HitList hits;
  hits.reserve(points);
  FrameCounts sum;
  const std::vector<Pose> poses = path(place);
  for (const Pose& pose : poses) {
    query.find(pose, hits);
    sum.tested += hits.tested,
        sum.not_free += static_cast<double>(hits.surface.size() + hits.interior.size());
    sum.looked_at += looked_at(query, pose);
  }
  const auto frames = static_cast<double>(poses.size());
  return {sum.tested / frames, sum.not_free / frames, sum.looked_at / frames};
}

}  // namespace voxtouch::bench
