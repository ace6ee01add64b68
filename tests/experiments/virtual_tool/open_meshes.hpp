#pragma once
/// Meshes that enclose no space, whole or in part, and a ball that is driven into them.
#include <cstdint>
#include <span>
#include <string>

#include "rig.hpp"

namespace voxtouch::virtual_tool {

/// Names of all shapes: "sheet"; "fold:60", "fold:120", two sheets at that angle; "tee", three with
/// a common edge; "cross", two that intersect; "lidless", a box without its lid; "hole", a box
/// without one triangle; "tube"; "bowl"; "moebius", a strip with half a turn; "shards", a sheet of
/// separate triangles; "fin", a closed block with a sheet on it; "inverted", a closed box inside
/// out; "doubled", a sheet in both orientations.
std::span<const char* const> open_shapes();
/// One of them, some 80 mm large. Throws std::invalid_argument for another name.
mesh::TriangleMesh open_shape(const std::string& name);

/// A ball driven through the mesh at random places from either side, along it, and then wherever
/// chance leads, at each speed.
struct DriveOptions {
  std::string shape = "sheet";
  double edge = 0.002, radius_edges = 5.0;
  bool askew = false;  ///< the mesh, in its grid
  int tries = 5;
  std::vector<double> edges_per_frame = {0.02, 0.1, 0.5, 1.0, 2.0, 4.0};
  std::uint64_t seed = 1;
};
struct DriveFigures {
  int runs = 0, passed = 0,
      rims = 0;  ///< a triangle came nearer to the ball's centre than half of its radius: in a
                 ///< face; at a rim, between points
  double into_worst = 0.0;                 ///< by how much a triangle was inside the exact ball [e]
  double rest_95 = 0.0, rest_worst = 0.0;  ///< |F| from frame to frame, hand still [N]
  int touched = 0;                         ///< runs with a force when the hand rests
};
DriveFigures drive(const DriveOptions& options);

}  // namespace voxtouch::virtual_tool
