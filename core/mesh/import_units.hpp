#pragma once
/// Whether a file's numbers are fine enough, and of a size that makes sense, for a voxel size. Private to the
/// import.
#include "core/mesh/import.hpp"

namespace voxtouch::mesh::import {

/// Largest step of single precision against the voxel edge. At a hundredth, rounding moves a shell point by
/// less than what one of 100 steps through a voxel does.
inline constexpr double kMaxSpacingPerVoxel = 0.01;
/// Voxels along the longest side of a mesh: fewer than the first, and its shape is lost; more than the
/// second, and the unit is rarely meant.
inline constexpr double kFewestVoxels = 4.0, kMaxVoxels = 2000.0;

/// Throws MeshError if single precision is too coarse for `options.voxel_size_m` where the file's coordinates
/// lie.
void check_precision(const std::filesystem::path& path, const FileTriangles& read, const ImportOptions& options);

/// A warning that names extent and voxel size where their ratio is odd, else empty. `extent_m`: longest side.
std::string unit_warning(const std::filesystem::path& path, double extent_m, const ImportOptions& options);

}  // namespace voxtouch::mesh::import
