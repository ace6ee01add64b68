#include "core/mesh/import.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/mesh/import_units.hpp"
#include "core/mesh/weld.hpp"

namespace voxtouch::mesh {
namespace {

/// The options with a unit quaternion.
ImportOptions checked(const std::filesystem::path& path, ImportOptions options) {
  if (!(options.scale > 0.0) || !std::isfinite(options.scale))
    import::refuse(path, "the scale is " + std::to_string(options.scale), "give one above 0 (0.001 for millimetres)");
  if (!options.pose.finite() || !normalise_within(options.pose.orientation, 0.999, 1.001))
    import::refuse(path, "its pose is not finite or its quaternion not of length one", "give a unit quaternion w x y z");
  if (!(options.voxel_size_m >= 0.0) || !std::isfinite(options.voxel_size_m))
    import::refuse(path, "the voxel size is " + std::to_string(options.voxel_size_m), "give one above 0, in metres");
  return options;
}

std::string left_out(std::uint64_t count, const char* what) {
  return fmt::format("{} {}{} left out: only faces can be felt", count, what, count == 1 ? " is" : "s are");
}

}  // namespace

ImportedMesh import_mesh(const std::filesystem::path& path, const ImportOptions& given, const TriangleReader& reader) {
  const ImportOptions options = checked(path, given);
  return import_mesh(path, read_mesh_bytes(path, options.max_file_bytes), options, reader);
}

ImportedMesh import_mesh(const std::filesystem::path& path, std::string bytes, const ImportOptions& given,
                         const TriangleReader& reader) {
  const ImportOptions options = checked(path, given);
  FileTriangles read = reader(path, std::move(bytes), options);
  import::check_precision(path, read, options);

  ImportedMesh result;
  result.warnings = std::move(read.warnings);
  if (read.points > 0) result.warnings.push_back(left_out(read.points, "point"));
  if (read.lines > 0) result.warnings.push_back(left_out(read.lines, "line"));
  if (read.uncut > 0)
    result.warnings.push_back(fmt::format(
        "polygons that cross themselves could not be cut: {} triangles are missing; triangulate on export", read.uncut));
  // Welded before scaling: the file's own numbers say what coincides.
  const TriangleMesh welded = weld(read.mesh);
  const Eigen::AlignedBox3d box = bounds(welded);
  const std::string unit = import::unit_warning(path, options.scale * box.sizes().maxCoeff(), options);
  if (!unit.empty()) result.warnings.push_back(unit);
  result.mesh = transform(welded, options.scale, options.pose);
  result.report = inspect(result.mesh);
  if (result.report.not_finite_vertices.count > 0)
    import::refuse(path, "vertex " + std::to_string(result.report.not_finite_vertices.examples.front()) +
                   " is not finite after scale and pose", "give a smaller scale");
  return result;
}

}  // namespace voxtouch::mesh
