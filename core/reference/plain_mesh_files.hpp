#pragma once
/// The reference's own readers of the two plain formats, OBJ and STL.
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// Polygons as lists of vertices, in the file's order. Coordinates are the file's, in single
/// precision.
struct PlainFile {
  std::vector<Vec3> vertices;
  std::vector<std::vector<std::uint32_t>>
      faces;  ///< of three corners or more; each names a vertex that is there
};

/// Vertices and faces of an OBJ text. Groups, materials, lines and whatever else stands in it is
/// skipped. Throws std::runtime_error where a number is none or a face names a vertex that is not
/// there.
PlainFile read_obj(std::string_view text);
/// Triangles of an STL, text or binary. Normals, names and bytes behind the last triangle are
/// skipped. Throws std::runtime_error where it is truncated.
PlainFile read_stl(std::string_view bytes);

}  // namespace voxtouch::reference
