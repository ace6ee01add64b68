#pragma once
/// The open parts of a mesh as walls: their triangles, and the rims where these end.
#include "core/voxmap/closed_mesh.hpp"

namespace voxtouch::voxmap {

/// Trees over them in grid coordinates, for building only; empty where the mesh has no open part, or they are not `wanted`.
class OpenWalls {
 public:
  OpenWalls(const ClosedMesh& mesh, bool wanted);

  bool any() const noexcept { return any_; }
  /// Over the triangles.
  const DistanceTree& faces() const noexcept { return faces_; }
  /// Over the edges that one triangle alone has and beyond which no surface goes on, neither a closed part's: a crack in a surface is no rim, nor is the
  /// foot of a sheet on a block.
  const DistanceTree& rims() const noexcept { return rims_; }

 private:
  bool any_;
  DistanceTree faces_, rims_;  ///< of rims each edge is a triangle without area
};

}  // namespace voxtouch::voxmap
