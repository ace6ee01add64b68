#pragma once
/// The cup, ball and plug of bench_scene.hpp as closed meshes of any number of triangles, for
/// comparisons with mesh libraries.
#include "core/mesh/triangle_mesh.hpp"
#include "core/voxmap/grid.hpp"
#include "tests/bench/bench_scene.hpp"

namespace voxtouch::bench {

/// About so many triangles (a tenth more or less), nearly equilateral but at the axis.
mesh::TriangleMesh cup_mesh(std::size_t triangles);
/// The tool at that place: the ball, or the plug at kHeavy. In the frame of `path`.
mesh::TriangleMesh tool_mesh(Place place, std::size_t triangles);

}  // namespace voxtouch::bench
