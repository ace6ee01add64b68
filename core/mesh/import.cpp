#include "core/mesh/import.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/mesh/import_check.hpp"
#include "core/mesh/weld.hpp"

namespace voxtouch::mesh {
namespace {

/// Largest step of single precision relative to the voxel edge. At a hundredth, rounding moves a
/// shell point by less than one of 100 steps through a voxel.
constexpr double kMaxSpacingPerVoxel = 0.01;
/// The same against the longest side, as if that were a hundred voxels.
constexpr double kMaxSpacingPerExtent = 0.01 * kMaxSpacingPerVoxel;
/// Voxels along the longest side of a mesh: fewer than the first, and its shape is lost; more than
/// the second, and the unit is rarely meant.
constexpr double kFewestVoxels = 4.0, kMaxVoxels = 2000.0;

/// The options with a unit quaternion.
ImportOptions checked(const std::filesystem::path& path, ImportOptions options) {
  if (!(options.scale > 0.0) || !std::isfinite(options.scale))
    import::refuse(path, "the scale is " + std::to_string(options.scale),
                   "choose a scale > 0 (0.001 for millimetres)");
  if (!options.pose.finite() || !normalise_within(options.pose.orientation, 0.999, 1.001))
    import::refuse(path, "its pose is not finite or its quaternion is not of unit norm",
                   "use a unit quaternion w x y z");
  if (!(options.voxel_size_m >= 0.0) || !std::isfinite(options.voxel_size_m))
    import::refuse(path, "the voxel size is " + std::to_string(options.voxel_size_m),
                   "choose a size > 0, in metres");
  return options;
}

std::string skipped(std::uint64_t count, const char* what) {
  return fmt::format("{} {}{} skipped: only faces have contact", count, what,
                     count == 1 ? " is" : "s are");
}

/// Throws MeshError if single precision is too coarse for `options.voxel_size_m` at the file's
/// coordinates.
void check_precision(const std::filesystem::path& path, const FileTriangles& read,
                     const ImportOptions& options) {
  const double e = options.voxel_size_m, spacing = read.spacing * options.scale;
  if (e <= 0.0 || spacing <= kMaxSpacingPerVoxel * e)
    return;
  import::refuse(path,
                 fmt::format("its largest coordinate is {:.4g} m, where single precision has a "
                             "resolution of {:.4g} m; a voxel of {:.4g} m needs at most {:.4g} m",
                             read.largest * options.scale, spacing, e, kMaxSpacingPerVoxel * e),
                 "move the mesh to the origin in the file and set its place with the scene's pose, "
                 "or use larger voxels");
}

/// A warning if single precision, in which vertices are stored, is coarse for a mesh of length
/// `extent_m`; otherwise empty. With a voxel size the mesh is refused instead.
std::string precision_warning(const FileTriangles& read, double extent_m,
                              const ImportOptions& options) {
  const double spacing = read.spacing * options.scale;
  if (options.voxel_size_m > 0.0 || spacing <= kMaxSpacingPerExtent * extent_m)
    return {};
  return fmt::format(
      "its largest coordinate is {:.4g} m, where single precision has a resolution of {:.4g} m; a "
      "mesh of length {:.4g} m needs at most {:.4g} m: move the mesh to the origin in the file",
      read.largest * options.scale, spacing, extent_m, kMaxSpacingPerExtent * extent_m);
}

/// A warning with extent and voxel size if their ratio is unusual, otherwise empty. `extent_m`:
/// longest side.
std::string unit_warning(const std::filesystem::path& path, double extent_m,
                         const ImportOptions& options) {
  const double e = options.voxel_size_m;
  if (e <= 0.0 || (extent_m >= kFewestVoxels * e && extent_m <= kMaxVoxels * e))
    return {};
  const bool small = extent_m < kFewestVoxels * e;
  const double voxels = extent_m / e;
  std::string text = fmt::format(
      "the mesh is {:.4g} m long at scale {:.4g}, {} voxels of {:.4g} m", extent_m, options.scale,
      small ? fmt::format("only {:.4g}", voxels) : fmt::to_string(std::llround(voxels)), e);
  if (!has_own_unit(path))
    text += " (." + import::extension_of(path) + " has no unit; its numbers are read as metres)";
  if (!small)
    return fmt::format("{}: if the file is in millimetres, use scale {:.4g}", text,
                       0.001 * options.scale);
  if (1000.0 * extent_m >= kFewestVoxels * e && options.scale < 1.0)
    return fmt::format("{}: if the file is in metres, not in millimetres, use scale {:.4g}", text,
                       1000.0 * options.scale);
  return text + ": its shape is lost. Check the unit, or use smaller voxels";
}

}  // namespace

bool has_own_unit(const std::filesystem::path& path) {
  const std::string extension = import::extension_of(path);
  return extension == "gltf" || extension == "glb" || extension == "dae";
}

ImportedMesh import_mesh(const std::filesystem::path& path, const ImportOptions& given,
                         const TriangleReader& reader) {
  const ImportOptions options = checked(path, given);
  return import_mesh(path, read_mesh_bytes(path, options.max_file_bytes), options, reader);
}

ImportedMesh import_mesh(const std::filesystem::path& path, std::string bytes,
                         const ImportOptions& given, const TriangleReader& reader) {
  const ImportOptions options = checked(path, given);
  FileTriangles read = reader(path, std::move(bytes), options);
  check_precision(path, read, options);

  ImportedMesh result;
  result.warnings = std::move(read.warnings);
  if (read.points > 0)
    result.warnings.push_back(skipped(read.points, "point"));
  if (read.lines > 0)
    result.warnings.push_back(skipped(read.lines, "line"));
  // Welded before scaling, because only the file's numbers coincide exactly.
  TriangleMesh welded = weld(read.mesh);
  if (const std::size_t count = remove_collapsed(welded))
    result.warnings.push_back(fmt::format(
        "{} with two equal corners {} skipped",
        count == 1 ? "1 triangle" : fmt::format("{} triangles", count), count == 1 ? "is" : "are"));
  if (welded.empty())
    import::refuse(path, "has only triangles with two equal corners",
                   "export the surface, with faces");
  const Eigen::AlignedBox3d box = bounds(welded);
  const double extent_m = options.scale * box.sizes().maxCoeff();
  for (const std::string& warning :
       {precision_warning(read, extent_m, options), unit_warning(path, extent_m, options)}) {
    if (!warning.empty())
      result.warnings.push_back(warning);
  }
  result.mesh = transform(welded, options.scale, options.pose);
  result.report = inspect(result.mesh);
  if (result.report.not_finite_vertices.count > 0)
    import::refuse(path,
                   "vertex " + std::to_string(result.report.not_finite_vertices.examples.front()) +
                       " is not finite after scale and pose",
                   "use a smaller scale");
  return result;
}

}  // namespace voxtouch::mesh
