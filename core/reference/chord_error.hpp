#pragma once
/// How far a mesh is from the primitives that a scene declares for it.
#include <algorithm>
#include <optional>
#include <string>

#include "core/reference/mesh_distance.hpp"
#include "core/reference/reference_mesh.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch {

/// A declared primitive may differ from its mesh by this share of a voxel edge. A chord error widens the band in which
/// nothing is decided, on both sides; a quarter of an edge costs about a tenth of it.
inline constexpr double kChordShareOfEdge = 0.25;

struct ChordError {
  double mesh_to_primitives_m = 0.0;  ///< largest |signed distance| over corners, edge midpoints and centroids
  double primitives_to_mesh_m = 0.0;  ///< largest distance from points spread over the primitives to the mesh
  Vec3 worst = Vec3::Zero();          ///< where the larger of both is, in the mesh's frame
  double value_m() const noexcept { return std::max(mesh_to_primitives_m, primitives_to_mesh_m); }
};

/// Both directions are looked at: a mesh with a part missing lies on its primitive everywhere, but does not cover it. Parts of
/// a primitive that lie inside another one are not part of the surface and do not count. `primitives` must not be empty.
ChordError chord_error(const ReferenceMesh& mesh, const MeshDistance& distance, const std::vector<Primitive>& primitives);

/// Checks the primitives of one mesh against its file: nothing if they agree within kChordShareOfEdge of `edge_m` or none are
/// declared, else a sentence that names file, error, place and limit. Throws what read_reference_mesh throws.
std::optional<std::string> primitives_problem(const MeshSpec& spec, double edge_m);

}  // namespace voxtouch
