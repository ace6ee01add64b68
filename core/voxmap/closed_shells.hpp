#pragma once
/// What of a mesh encloses space: triangles judged one by one, then the parts they form.
///
/// Rules. Vertices are one where their grid coordinates are equal. A triangle is zero-area
/// (exactly) or a duplicate (same three corners as an earlier one, either way round). A part is
/// what hangs together by edges. A part closes if each edge is used an even number of times; tried
/// are, in this order: without zero-area triangles and with one triangle of each set of duplicates;
/// with all duplicates (an opposite pair, like the shared wall of two stacked boxes or a two-sided
/// fin, takes nothing from "inside"); with zero-area triangles (which may close a T-junction).
/// Within a closed part, triangles that disagree with their neighbours are turned round, the
/// smaller area giving way; a part that cannot be oriented is judged by parity.
#include <cstdint>
#include <vector>

#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

enum class TriangleState : std::uint8_t { kSound, kZeroArea, kDuplicate };

/// Lowest-numbered vertex with the same grid coordinates, for each vertex.
std::vector<std::uint32_t> weld_vertices(const GridMesh& mesh);

/// State of each triangle; of duplicates the first is sound, the later ones are not.
std::vector<TriangleState> judge_triangles(const GridMesh& mesh,
                                           const std::vector<std::uint32_t>& welded);

/// How a triangle counts for "inside".
enum class ShellRole : std::int8_t {
  kNone = 0,  ///< of a part that encloses no space
  kKept = 1,
  kFlipped = -1,  ///< it disagrees with its neighbours
  kParity = 2,    ///< of a closed part that cannot be oriented (a Klein bottle)
};

struct ClosedShells {
  std::vector<ShellRole> role;  ///< of each triangle
  /// of each triangle with a role: lowest triangle of those that hang together by edges of two,
  /// which turn together
  std::vector<std::uint32_t> patch;
  std::size_t closed_parts = 0;     ///< parts that enclose space
  std::size_t open_parts = 0;       ///< parts that do not: they have a surface, but no interior
  std::vector<std::uint32_t> open;  ///< the sound triangles of those, ascending
};

/// Parts of `mesh` that enclose space. `welded`: the vertex that each vertex is one with; `state`:
/// of each triangle. Allocates.
ClosedShells find_closed_shells(const GridMesh& mesh, const std::vector<std::uint32_t>& welded,
                                const std::vector<TriangleState>& state);
/// The same from the mesh alone.
ClosedShells find_closed_shells(const GridMesh& mesh);
/// Triangles of the parts that enclose space, ascending.
std::vector<std::uint32_t> triangles_of_closed_parts(const ClosedShells& shells);

}  // namespace voxtouch::voxmap
