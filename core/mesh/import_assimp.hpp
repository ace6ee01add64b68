#pragma once
/// What assimp makes of a checked file, as plain triangles. Private to the import.
#include "core/mesh/import_check.hpp"

namespace voxtouch::import {

struct Triangles {
  TriangleMesh mesh;                 ///< nodes applied, in the file's unit (COLLADA: metres); not welded
  std::uint64_t points = 0, lines = 0;  ///< left out
  std::uint64_t uncut = 0;           ///< polygons that could not be cut into triangles completely
  double spacing = 0.0;              ///< widest step of single precision at the coordinates, after nodes
  double largest = 0.0;              ///< the coordinate it belongs to
};

/// Throws MeshError.
Triangles read_triangles(const MeshFile& file, const ImportOptions& options);

}  // namespace voxtouch::import
