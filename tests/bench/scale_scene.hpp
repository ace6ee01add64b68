#pragma once
/// The cup as a mesh at any number of triangles and any resolution, and the counted cost of a
/// frame.
#include <cstddef>

#include "core/voxmap/voxmap.hpp"
#include "tests/bench/bench_scene.hpp"

namespace voxtouch::bench {

/// The grid in which 128 mm, which the cup fits into, are so many voxels.
voxmap::Grid grid_of(int resolution);

/// Of a frame, the mean over the path.
struct FrameCounts {
  double tested = 0.0;     ///< points
  double not_free = 0.0;   ///< points that hit
  double looked_at = 0.0;  ///< groups of sixteen spheres of the culling tree
};

/// The tool has the same size and so many points whatever the resolution.
FrameCounts frame_counts(const voxmap::Voxmap& map, Place place, std::size_t points);

}  // namespace voxtouch::bench
