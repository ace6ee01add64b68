#pragma once
/// The same meshes in other libraries, for comparison. One file each, so that a missing library is
/// skipped.
#include <cstddef>
#include <memory>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::bench {

/// A static and a moving mesh in another library.
class OtherPair {
 public:
  virtual ~OtherPair() = default;
  /// With the second mesh at `pose`: the number of contacts if the library counts them; or 1 or 0;
  /// or the distance [m].
  virtual double ask(const Pose& pose) = 0;
};

enum class FclQuestion { kBoolean, kAllContacts, kDistance };
/// FCL, trees of OBBRSS in doubles, as the validator has it. Of contacts it gives point, normal and
/// depth of each pair of triangles.
std::unique_ptr<OtherPair> fcl_pair(const mesh::TriangleMesh& still,
                                    const mesh::TriangleMesh& moving, FclQuestion question);

/// Bullet's GImpact without margins, with all contacts: counted before it reduces them to manifolds
/// of four. Null without Bullet.
std::unique_ptr<OtherPair> gimpact_pair(const mesh::TriangleMesh& still,
                                        const mesh::TriangleMesh& moving);

/// OpenVDB's signed distances of the mesh, single-threaded, to `band` voxels on both sides (default
/// 3): bytes of the grid. 0 without OpenVDB.
std::size_t openvdb_distances(const mesh::TriangleMesh& mesh, double edge_m, double band);

}  // namespace voxtouch::bench
