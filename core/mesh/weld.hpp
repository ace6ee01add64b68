#pragma once
/// Merges equal vertices, computes extents, and transforms meshes. Loading only: allocates.
#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::mesh {

/// Two to four single-precision steps at the largest coordinate: the distance of both sides of a
/// seam if vertices were moved before rounding to float. Relative to the largest |coordinate| of
/// the used vertices.
inline constexpr double kWeldTolerance = 1.0 / (1 << 22);

/// For each vertex the index of its representative: the lowest-numbered representative within
/// `tolerance` (a fraction of the largest |coordinate| of the used vertices), otherwise itself.
/// Equal positions always have the same one (0 equals -0). A non-finite vertex represents itself.
/// Vertices are processed in order, so the result does not depend on hashing.
std::vector<std::uint32_t> standing_vertices(const TriangleMesh& mesh,
                                             double tolerance = kWeldTolerance);

/// The mesh with vertices at one position made one, which keeps the exact coordinates of the FIRST.
/// Triangles keep number, order and corner order; unused vertices stay. Throws std::runtime_error
/// if a triangle names a vertex that is not there.
TriangleMesh weld(const TriangleMesh& mesh, double tolerance = kWeldTolerance);

/// Removes triangles with two equal vertex indices: they bound nothing, and those that link the
/// parts of a triangle strip may cross its inside. Returns their number. Other triangles without
/// area stay.
std::size_t remove_collapsed(TriangleMesh& welded);

/// x -> pose * (scale * x), in double, for every vertex. `scale` > 0 (otherwise triangles would be
/// inverted), `pose` unit.
TriangleMesh transform(const TriangleMesh& mesh, double scale, const Pose& pose);

/// Axis-aligned box of the vertices that triangles use [m]; `isEmpty()` if there are none. Vertices
/// that are not finite are left out.
Eigen::AlignedBox3d bounds(const TriangleMesh& mesh);

/// 1 for each vertex that a triangle uses. Throws std::runtime_error, naming triangle and vertex,
/// if an index is out of range.
std::vector<std::uint8_t> used_vertices(const TriangleMesh& mesh);

}  // namespace voxtouch::mesh
