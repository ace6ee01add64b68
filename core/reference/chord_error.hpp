#pragma once
/// How far a mesh is from the primitives that a scene declares for it.
#include <algorithm>

#include "core/reference/mesh_distance.hpp"
#include "core/reference/reference_mesh.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::reference {

struct ChordError {
  double mesh_to_primitives_m =
      0.0;  ///< largest |signed distance| over corners, edge midpoints and centroids
  double primitives_to_mesh_m =
      0.0;  ///< largest distance from points spread over the primitives to the mesh
  double value_m() const noexcept { return std::max(mesh_to_primitives_m, primitives_to_mesh_m); }
};

/// Both directions are looked at: a mesh with a part missing lies on its primitive everywhere, but
/// does not cover it. Parts of a primitive that lie inside another one are not part of the surface
/// and do not count. `primitives` must not be empty.
ChordError chord_error(const ReferenceMesh& mesh, const MeshDistance& distance,
                       const std::vector<scene::Primitive>& primitives);

}  // namespace voxtouch::reference
