#pragma once
/// Distance between a mesh and the primitives that a scene declares for it.
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

/// Computes both directions, because a mesh with a missing part lies on its primitive but does not
/// cover it. Parts of a primitive inside another one do not belong to the surface and are ignored.
/// `primitives` must not be empty.
ChordError chord_error(const ReferenceMesh& mesh, const MeshDistance& distance,
                       const std::vector<scene::Primitive>& primitives);

}  // namespace voxtouch::reference
