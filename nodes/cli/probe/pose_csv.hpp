#pragma once
/// Poses from a CSV file.
#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch::cli {

/// Reads the columns qw qx qy qz tx ty tz, found by the header's names in any order; other columns
/// are left alone. Quaternions with a finite norm in [1e-3, 1e3] are normalised. Throws
/// std::runtime_error "file:line: sentence".
std::vector<Pose> read_poses(std::istream& in, const std::string& name);
std::vector<Pose> read_poses(const std::filesystem::path& file);  ///< "-": standard input

}  // namespace voxtouch::cli
