#pragma once
/// Mass properties of a solid body, from its surface.
#include "core/mesh/triangle_mesh.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::mesh {

/// Of a closed mesh filled evenly, at a mass of 1 kg. Its frame; [m], [m^2], [m^3].
struct MassProperties {
  double volume_m3 = 0.0;
  Vec3 centre = Vec3::Zero();          ///< of mass
  Mat3 inertia_m2 = Mat3::Identity();  ///< about the centre of mass, over the mass
};

/// Integrals over the tetrahedra between the origin and each triangle (Mirtich 1996). Throws
/// std::invalid_argument if the surface bounds no volume: open, flat, or with contradictory
/// orientations.
MassProperties mass_properties(const TriangleMesh& mesh);

}  // namespace voxtouch::mesh
