#pragma once
/// Converts a mesh for FCL. Only sources that use FCL include this header; no other header includes
/// FCL.
#include <fcl/geometry/bvh/BVH_model.h>

#include <memory>
#include <vector>

namespace voxtouch::reference {

using FclMesh = fcl::BVHModel<fcl::OBBRSSd>;

/// A tree of bounding volumes over all triangles of a mesh that has `vertices` [m] and `triangles`
/// of three indices each. Allocates.
template <class Mesh>
std::unique_ptr<FclMesh> make_fcl_mesh(const Mesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles.emplace_back(t[0], t[1], t[2]);
  auto made = std::make_unique<FclMesh>();
  made->beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  made->addSubModel(mesh.vertices, triangles);
  made->endModel();
  return made;
}

}  // namespace voxtouch::reference
