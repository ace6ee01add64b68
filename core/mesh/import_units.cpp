#include "core/mesh/import_units.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/mesh/import_check.hpp"

namespace voxtouch::mesh::import {
void check_precision(const std::filesystem::path& path, const FileTriangles& read, const ImportOptions& options) {
  const double e = options.voxel_size_m, spacing = read.spacing * options.scale;
  if (e <= 0.0 || spacing <= kMaxSpacingPerVoxel * e) return;
  refuse(path,
         fmt::format("its largest coordinate is {:.4g} m, where single precision, which the reader holds vertices in, has steps of "
                     "{:.4g} m; a voxel of {:.4g} m needs steps of at most {:.4g} m",
                     read.largest * options.scale, spacing, e, kMaxSpacingPerVoxel * e),
         "move the mesh to the origin in the file and give its place as the scene's pose, or take larger voxels");
}

std::string unit_warning(const std::filesystem::path& path, double extent_m, const ImportOptions& options) {
  const double e = options.voxel_size_m;
  if (e <= 0.0 || (extent_m >= kFewestVoxels * e && extent_m <= kMaxVoxels * e)) return {};
  const std::string extension = extension_of(path);
  const bool unitless = extension == "obj" || extension == "stl" || extension == "ply";
  const bool small = extent_m < kFewestVoxels * e;
  const double voxels = extent_m / e;
  std::string text = fmt::format("the mesh is {:.4g} m long at scale {:.4g}, {} voxels of {:.4g} m", extent_m, options.scale,
                                 small ? fmt::format("only {:.4g}", voxels) : fmt::to_string(std::llround(voxels)), e);
  if (unitless) text += " (." + extension + " carries no unit; its numbers are taken as metres)";
  if (!small) return fmt::format("{}: is the file in millimetres? Then use scale {:.4g}", text, 0.001 * options.scale);
  if (1000.0 * extent_m >= kFewestVoxels * e && options.scale < 1.0)
    return fmt::format("{}: is the file in metres, and not in millimetres? Then use scale {:.4g}", text, 1000.0 * options.scale);
  return text + ": is the unit right, or are the voxels too large for it? Its shape is lost";
}

}  // namespace voxtouch::mesh::import
