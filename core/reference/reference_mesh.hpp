#pragma once
/// The reference's own reader of mesh files. It shares no code with the reader of the voxmap, so
/// that a fault in either appears as a disagreement.
#include <array>
#include <cstdint>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Triangles in the mesh's frame after scaling [m] (the frame of a scene's primitives;
/// MeshSpec::pose is not applied), in double precision. Node transforms are applied; triangles of
/// zero area and duplicates are removed.
struct ReferenceMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool closed = false;  ///< Every edge is traversed equally often in both directions: the interior
                        ///< is well-defined.
  std::size_t dropped = 0;  ///< removed triangles: zero area or duplicates

  const Vec3& corner(std::size_t triangle, std::size_t k) const {
    return vertices[triangles[triangle][k]];
  }
};

/// Reads the file of `spec`. Throws std::runtime_error (file and reason) if it is unreadable, has
/// no triangles or has a non-finite coordinate, or if the scale is not a positive number.
ReferenceMesh read_reference_mesh(const scene::MeshSpec& spec);

/// The same clean-up for triangles in memory: merges positions that are equal to a few
/// single-precision steps, removes irrelevant triangles, sets `closed`. Throws std::runtime_error
/// (beginning with `name`) as above.
ReferenceMesh make_reference_mesh(const std::vector<Vec3>& vertices,
                                  const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                  const std::string& name);

}  // namespace voxtouch::reference
