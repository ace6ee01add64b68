#include "tests/bench/others.hpp"

#if VOXTOUCH_OPENVDB
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>
#endif

namespace voxtouch::bench {

#if VOXTOUCH_OPENVDB
namespace {

/// The mesh in OpenVDB's interface, in voxels.
struct MeshOfVoxels {
  const mesh::TriangleMesh& mesh;
  double edge_m;
  std::size_t polygonCount() const { return mesh.triangles.size(); }
  std::size_t pointCount() const { return mesh.vertices.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t polygon, std::size_t corner, openvdb::Vec3d& out) const {
    const Vec3 at = mesh.corner(polygon, static_cast<int>(corner)) / edge_m;
    out = {at.x(), at.y(), at.z()};
  }
};

}  // namespace

std::size_t openvdb_distances(const mesh::TriangleMesh& mesh, double edge_m, double band) {
  openvdb::initialize();
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      MeshOfVoxels{mesh, edge_m}, *openvdb::math::Transform::createLinearTransform(edge_m),
      static_cast<float>(band), static_cast<float>(band));
  return static_cast<std::size_t>(grid->memUsage());
}
#else
std::size_t openvdb_distances(const mesh::TriangleMesh&, double, double) { return 0; }
#endif

}  // namespace voxtouch::bench
