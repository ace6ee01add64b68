#include "core/mesh/import_units.hpp"

#include <cmath>
#include <locale>
#include <sstream>

#include "core/mesh/import_check.hpp"

namespace voxtouch::mesh::import {
namespace {

std::string text_of(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(4);
  text << value;
  return text.str();
}

}  // namespace

void check_precision(const std::filesystem::path& path, const FileTriangles& read, const ImportOptions& options) {
  const double e = options.voxel_size_m, spacing = read.spacing * options.scale;
  if (e <= 0.0 || spacing <= kMaxSpacingPerVoxel * e) return;
  refuse(path,
         "its largest coordinate is " + text_of(read.largest * options.scale) +
             " m, where single precision, which the reader holds vertices in, has steps of " + text_of(spacing) +
             " m; a voxel of " + text_of(e) + " m needs steps of at most " + text_of(kMaxSpacingPerVoxel * e) + " m",
         "move the mesh to the origin in the file and give its place as the scene's pose, or take larger voxels");
}

std::string unit_warning(const std::filesystem::path& path, double extent_m, const ImportOptions& options) {
  const double e = options.voxel_size_m;
  if (e <= 0.0 || (extent_m >= kFewestVoxels * e && extent_m <= kMaxVoxels * e)) return {};
  const std::string extension = extension_of(path);
  const bool unitless = extension == "obj" || extension == "stl" || extension == "ply";
  const bool small = extent_m < kFewestVoxels * e;
  const double voxels = extent_m / e;
  std::string text = "the mesh is " + text_of(extent_m) + " m long at scale " + text_of(options.scale) + ", " +
                     (small ? "only " + text_of(voxels) : std::to_string(std::llround(voxels))) + " voxels of " +
                     text_of(e) + " m";
  if (unitless) text += " (." + extension + " carries no unit; its numbers are taken as metres)";
  if (!small) return text + ": is the file in millimetres? Then use scale " + text_of(0.001 * options.scale);
  if (1000.0 * extent_m >= kFewestVoxels * e && options.scale < 1.0) {
    return text + ": is the file in metres, and not in millimetres? Then use scale " +
        text_of(1000.0 * options.scale);
  }
  return text + ": is the unit right, or are the voxels too large for it? Its shape is lost";
}

}  // namespace voxtouch::mesh::import
