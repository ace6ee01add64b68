#pragma once
/// Boxes for the tests of first scenes.
#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::scene_proposal::test {

/// Adds a box, facing outward, or inward for a cavity.
inline void add_box(mesh::TriangleMesh& mesh, const Vec3& low, const Vec3& high,
                    bool inward = false) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int k = 0; k < 8; ++k)
    mesh.vertices.emplace_back(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(),
                               k & 4 ? high.z() : low.z());
  constexpr std::uint32_t kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : kFaces)
    for (const auto& [a, b, c] : {std::array{f[0], f[1], f[2]}, std::array{f[0], f[2], f[3]}})
      mesh.triangles.push_back(inward ? std::array{first + a, first + c, first + b}
                                      : std::array{first + a, first + b, first + c});
}

inline mesh::TriangleMesh box(const Vec3& low, const Vec3& high) {
  mesh::TriangleMesh mesh;
  add_box(mesh, low, high);
  return mesh;
}

}  // namespace voxtouch::scene_proposal::test
