#pragma once
/// What is measured next to: the same meshes in libraries of others. A file for each, so that one
/// which is missing is left out.
#include <cstddef>
#include <memory>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::bench {

/// A mesh that stands and one that moves, in another library.
class OtherPair {
 public:
  virtual ~OtherPair() = default;
  /// With the second mesh at `pose`: contacts where the library counts them; 1 or 0; or the
  /// distance [m].
  virtual double ask(const Pose& pose) = 0;
};

enum class FclQuestion { kBoolean, kAllContacts, kDistance };
/// FCL, trees of OBBRSS in doubles, as the validator has it. Of contacts it gives point, normal and
/// depth of each pair of triangles.
std::unique_ptr<OtherPair> fcl_pair(const mesh::TriangleMesh& still,
                                    const mesh::TriangleMesh& moving, FclQuestion question);

/// Bullet's GImpact without margins, all contacts: they are counted where it would put four of them
/// into a manifold. Null where Bullet is missing.
std::unique_ptr<OtherPair> gimpact_pair(const mesh::TriangleMesh& still,
                                        const mesh::TriangleMesh& moving);

/// OpenVDB's signed distances of the mesh, single-threaded, to `band` voxels on both sides (its own
/// default is 3): bytes of the grid. 0 where OpenVDB is missing.
std::size_t openvdb_distances(const mesh::TriangleMesh& mesh, double edge_m, double band);

}  // namespace voxtouch::bench
