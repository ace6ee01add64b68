#pragma once
/// Which vertices are the same point, where a mesh lies, and how it is moved. Loading only:
/// allocates.
#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::mesh {

/// Two to four single-precision steps at the largest coordinate: as far as the two sides of a seam
/// come apart when a file's vertices were moved before they were rounded to float. Relative to the
/// largest |coordinate| of the used vertices.
inline constexpr double kWeldTolerance = 1.0 / (1 << 22);

/// For each vertex the index of the vertex that stands for it: the lowest-numbered standing vertex
/// within `tolerance` (a fraction of the largest |coordinate| of the used vertices), else itself.
/// Equal positions always share one (0 equals -0); a vertex that is not finite stands for itself.
/// Vertices are visited in order, so nothing depends on hashing.
std::vector<std::uint32_t> standing_vertices(const TriangleMesh& mesh,
                                             double tolerance = kWeldTolerance);

/// The mesh with vertices at one position made one, which keeps the exact coordinates of the FIRST.
/// Triangles keep number, order and corner order; unused vertices stay. Throws std::runtime_error
/// if a triangle names a vertex that is not there.
TriangleMesh weld(const TriangleMesh& mesh, double tolerance = kWeldTolerance);

/// x -> pose * (scale * x), in double, for every vertex. `scale` > 0 (else triangles would turn
/// inside out), `pose` unit.
TriangleMesh transform(const TriangleMesh& mesh, double scale, const Pose& pose);

/// Axis-aligned box of the vertices that triangles use [m]; `isEmpty()` if there are none. Vertices
/// that are not finite are left out.
Eigen::AlignedBox3d bounds(const TriangleMesh& mesh);

/// 1 for each vertex that a triangle uses. Throws std::runtime_error, naming triangle and vertex,
/// if an index is out of range.
std::vector<std::uint8_t> used_vertices(const TriangleMesh& mesh);

}  // namespace voxtouch::mesh
