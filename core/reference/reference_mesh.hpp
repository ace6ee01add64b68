#pragma once
/// The reference's own reader of mesh files. It shares nothing with the reader that the voxmap is
/// built from, so that a fault in either shows as a disagreement.
#include <array>
#include <cstdint>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Triangles in the mesh's frame after scaling [m] (the frame of a scene's primitives;
/// MeshSpec::pose is not applied), in double, node transforms applied, without triangles of zero
/// area and without repeated ones.
struct ReferenceMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool closed =
      false;  ///< every edge is walked as often forwards as backwards: inside is well-defined
  std::size_t dropped = 0;  ///< triangles left out: zero area or repeated

  const Vec3& corner(std::size_t triangle, std::size_t k) const {
    return vertices[triangles[triangle][k]];
  }
};

/// Reads the file that `spec` names. Throws std::runtime_error (file and reason) if it cannot be
/// read, holds no triangles or a coordinate that is not finite, or if the scale is not a positive
/// number.
ReferenceMesh read_reference_mesh(const scene::MeshSpec& spec);

/// The same clean-up for triangles that are already in memory: joins positions that are equal to a
/// few single-precision steps, drops what counts for nothing, sets `closed`. Throws
/// std::runtime_error (beginning with `name`) as above.
ReferenceMesh make_reference_mesh(const std::vector<Vec3>& vertices,
                                  const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                  const std::string& name);

}  // namespace voxtouch::reference
