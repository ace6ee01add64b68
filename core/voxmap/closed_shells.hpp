#pragma once
/// Finds the parts of a mesh that enclose space: triangles are classified individually, then
/// grouped into parts.
///
/// Rules. Vertices with equal grid coordinates are merged. A triangle is zero-area (exactly), or a
/// duplicate of an earlier one with the same three corners in either orientation. A part is
/// connected by edges. A part closes if each edge is used an even number of times. Three attempts
/// are made in this order:
///   1. without zero-area triangles and with one triangle of each set of duplicates;
///   2. with all duplicates (an opposite pair, like the shared wall of two stacked boxes or a
///   two-sided fin, does not change the interior);
///   3. with zero-area triangles (which may close a T-junction).
/// Within a closed part, triangles that disagree with their neighbours are flipped, the smaller
/// area first. The interior of a part that cannot be oriented follows from parity.
#include <cstdint>
#include <vector>

#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

enum class TriangleState : std::uint8_t { kSound, kZeroArea, kDuplicate };

/// Lowest-numbered vertex with the same grid coordinates, for each vertex.
std::vector<std::uint32_t> weld_vertices(const GridMesh& mesh);

/// State of each triangle; the first of a set of duplicates is valid, the later ones are not.
std::vector<TriangleState> judge_triangles(const GridMesh& mesh,
                                           const std::vector<std::uint32_t>& welded);

/// Contribution of a triangle to the interior.
enum class ShellRole : std::int8_t {
  kNone = 0,  ///< of a part that encloses no space
  kKept = 1,
  kFlipped = -1,  ///< it disagrees with its neighbours
  kParity = 2,    ///< of a closed part that cannot be oriented (a Klein bottle)
};

struct ClosedShells {
  std::vector<ShellRole> role;  ///< of each triangle
  /// Of each triangle with a role: lowest triangle of those connected by edges of two triangles,
  /// which are flipped together.
  std::vector<std::uint32_t> patch;
  std::size_t closed_parts = 0;     ///< parts that enclose space
  std::size_t open_parts = 0;       ///< parts that do not: they have a surface but no interior
  std::vector<std::uint32_t> open;  ///< the valid triangles of those, ascending
};

/// Parts of `mesh` that enclose space. `welded`: representative vertex of each vertex; `state`: of
/// each triangle. Allocates.
ClosedShells find_closed_shells(const GridMesh& mesh, const std::vector<std::uint32_t>& welded,
                                const std::vector<TriangleState>& state);
/// The same from the mesh alone.
ClosedShells find_closed_shells(const GridMesh& mesh);
/// Triangles of the parts that enclose space, ascending.
std::vector<std::uint32_t> triangles_of_closed_parts(const ClosedShells& shells);

}  // namespace voxtouch::voxmap
