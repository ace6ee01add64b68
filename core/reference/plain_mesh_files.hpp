#pragma once
/// The reference's own readers of the formats OBJ and STL.
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Polygons as lists of vertices, in the order of the file. Coordinates are those of the file, in
/// single precision.
struct PlainFile {
  std::vector<Vec3> vertices;
  std::vector<std::vector<std::uint32_t>> faces;  ///< of three or more corners; each index is valid
};

/// Vertices and faces of an OBJ text. Groups, materials, lines and other statements are skipped.
/// Throws std::runtime_error for an invalid number or vertex index.
PlainFile read_obj(std::string_view text);
/// Triangles of an STL, text or binary. Normals, names and bytes after the last triangle are
/// skipped. Throws std::runtime_error for a truncated file.
PlainFile read_stl(std::string_view bytes);

}  // namespace voxtouch::reference
