#pragma once
/// Objects at rest that touch or overlap are one solid: who owns which voxel of it.
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::rendering {

/// Groups of objects whose meshes' boxes meet, of those that rest; each ascending, without groups
/// of one.
/// `meshes`: of each object, empty ones take no part. Boxes no farther apart than `gap_m` meet.
std::vector<std::vector<std::size_t>> solids_of(std::span<const mesh::TriangleMesh> meshes,
                                                const std::vector<bool>& rests, double gap_m);

/// Of `solid`, the voxels of several objects together, those of one object: `own` are its voxels by
/// itself, and a voxel that one of `others` has as well is theirs. All on one grid. Allocates.
voxmap::Voxmap owned_part(const voxmap::Voxmap& solid, const voxmap::Voxmap& own,
                          std::span<const voxmap::Voxmap* const> others);

}  // namespace voxtouch::rendering
