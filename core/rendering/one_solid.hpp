#pragma once
/// Resting objects that touch or overlap form one solid; this file assigns its voxels to the
/// objects.
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::rendering {

/// Groups of resting objects whose mesh boxes meet; each ascending, without groups of one.
/// `meshes`: of each object; empty ones are ignored. Boxes up to `gap_m` apart count as meeting.
std::vector<std::vector<std::size_t>> solids_of(std::span<const mesh::TriangleMesh> meshes,
                                                const std::vector<bool>& rests, double gap_m);

/// The voxels of one object among those of `solid`, the combined voxels of several objects. `own`
/// are its voxels alone; a voxel that one of `others` also has belongs to that one. All on one
/// grid. Allocates.
voxmap::Voxmap owned_part(const voxmap::Voxmap& solid, const voxmap::Voxmap& own,
                          std::span<const voxmap::Voxmap* const> others);

}  // namespace voxtouch::rendering
