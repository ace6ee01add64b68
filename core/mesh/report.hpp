#pragma once
/// Faults of a mesh and their consequences for the contact. Loading only: allocates.
#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::mesh {

/// Number of occurrences, and the first ones.
struct Finding {
  static constexpr std::size_t kExamples = 5;
  std::size_t count = 0;
  std::vector<std::uint32_t>
      examples;  ///< the first few, ascending and unique: indices of the affected elements

  void add(std::uint32_t index) {
    ++count;
    if (examples.size() < kExamples && (examples.empty() || examples.back() != index)) {
      examples.push_back(index);
    }
  }
};

/// Vertices at exactly one position count as one point here; weld() first if a file's seams are not
/// bit-identical.
struct MeshReport {
  std::size_t vertices = 0, triangles = 0;
  std::size_t points = 0;       ///< distinct positions among the used vertices
  std::size_t edges = 0;        ///< distinct edges of the sound triangles
  std::size_t parts = 0;        ///< pieces connected by edges of exactly two triangles
  Finding unused_vertices;      ///< vertices
  Finding not_finite_vertices;  ///< vertices
  Finding zero_area;            ///< triangles; they stay in the mesh
  Finding duplicates;           ///< triangles with the corners of a previous one, same orientation
  Finding
      opposite_duplicates;  ///< triangles with the corners of a previous one, opposite orientation
  Finding flipped;          ///< triangles with an orientation opposite to most of their part
  Finding open_edges;       ///< one triangle each; edges that a single triangle has
  Finding non_manifold_edges;  ///< the lowest triangle of each edge with more than two triangles
  Finding inward_parts;  ///< lowest triangle of each closed part that faces inward, if others face
                         ///< outward
  /// Lowest triangle of each closed part that lies in the solid of others and faces outward as they
  /// do: a cavity that was meant would face inward. Sought with a bounded number of steps, largest
  /// parts first.
  Finding nested_parts;
  bool orientable = true;  ///< false: a part has only one side
  bool inverted =
      false;  ///< closed, and the signed volume is negative: the whole mesh faces inward
  /// No edge is open. Zero-area and duplicate triangles are excluded, except zero-area ones that
  /// fill the gap between a long edge and the short ones along it. Only a closed mesh has an
  /// interior.
  bool closed = false;
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  ///< box of the used vertices [m]
  double signed_volume_m3 =
      0.0;  ///< of the valid triangles in their orientation; meaningful for a closed mesh only

  /// Whether there is no finding.
  bool clean() const { return sentences().empty(); }
  /// One sentence per kind of finding: number, first occurrence, consequence. Empty for a clean
  /// mesh.
  std::vector<std::string> sentences() const;
};

/// Checks every triangle and edge; O(n log n). Throws std::runtime_error if a triangle has an
/// invalid vertex index.
MeshReport inspect(const TriangleMesh& mesh);

}  // namespace voxtouch::mesh
