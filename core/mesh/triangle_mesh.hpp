#pragma once
/// Triangles in metres, as every builder takes them.
#include <array>
#include <cstdint>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::mesh {

/// Indexed triangles, counter-clockwise seen from outside. Triangle order is the file's order.
struct TriangleMesh {
  std::vector<Vec3> vertices;                           ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`

  const Vec3& corner(std::size_t triangle, int k) const {
    return vertices[triangles[triangle][static_cast<std::size_t>(k)]];
  }
  bool empty() const noexcept { return triangles.empty(); }
};

}  // namespace voxtouch::mesh
