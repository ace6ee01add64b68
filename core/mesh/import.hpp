#pragma once
/// Meshes from files: OBJ, STL (text, binary), PLY (text, binary), glTF 2.0 (.gltf, .glb) and
/// COLLADA (.dae), read by assimp.
///
/// Triangle k of the result is triangle k of the file: faces in file order (for glTF and COLLADA
/// node by node, depth first), polygons cut into triangles in place (polygon.hpp). Nothing is
/// dropped; zero-area triangles are kept. Groups, materials, normals, textures and animations are
/// ignored. Features that would change the shape and are not supported (skins, morph weights,
/// unknown required extensions, free-form surfaces) are refused. Irregularities that do not change
/// the shape (byte order marks, padding, keywords in capitals) are warnings. Vertices are rounded
/// to single precision by assimp, then double; vertices at one position become one (weld()).
///
/// OBJ, STL and PLY have no unit: metres, unless `scale` is set. glTF is in metres. assimp converts
/// COLLADA's unit to metres, with a single-precision factor, so 1 mm is 0.001 m to about 5e-8. No
/// axes are exchanged: glTF's +Y up stays +Y, and COLLADA's <up_axis> is ignored (assimp's
/// conversion of Z_UP and X_UP is switched off). Coordinates are thus those of the modelling tool;
/// rotate the mesh with `pose`. A node that mirrors (negative determinant) keeps its triangles
/// facing outward.
///
/// Files are not trusted. Content that assimp would read as another shape is refused before assimp
/// gets the bytes. assimp reads only the mesh file and, for .gltf, the buffers that it names. A
/// broken file may still crash it, hang it or fill memory; nodes/mesh_import therefore reads in a
/// separate process.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/mesh/mesh_bytes.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::mesh {

struct ImportOptions {
  double scale =
      1.0;  ///< metres for one unit of the file, > 0; on top of the unit COLLADA declares
  Pose pose = Pose();  ///< after scaling: x -> pose * (scale * x); quaternion within 1e-3 of unit
  double voxel_size_m = 0.0;  ///< voxel edge e, for precision and unit checks; 0: not known
  std::size_t max_triangles = 12'000'000;
  std::uintmax_t max_file_bytes = kLargestMeshFile;
};

/// Content of a file, as found by assimp and the checks before it.
struct FileTriangles {
  TriangleMesh mesh;  ///< nodes applied, in the file's unit (COLLADA: metres); not welded
  std::uint64_t points = 0, lines = 0;  ///< left out
  double spacing = 0.0;  ///< widest step of single precision at the coordinates, after nodes
  double largest = 0.0;  ///< the coordinate it belongs to
  std::vector<std::string> warnings;  ///< skipped content other than points and lines
};

/// Reads triangles from a file's bytes, at most as many as the options permit. Throws MeshError.
/// The result is finite, with valid indices.
using TriangleReader = std::function<FileTriangles(const std::filesystem::path&, std::string bytes,
                                                   const ImportOptions&)>;
/// The reader that does it here and now.
FileTriangles read_triangles(const std::filesystem::path& path, std::string bytes,
                             const ImportOptions& options);

/// Whether the file's format defines or declares the unit of its numbers, by the suffix: true for
/// glTF and COLLADA.
bool has_own_unit(const std::filesystem::path& path);

struct ImportedMesh {
  TriangleMesh mesh;                  ///< scaled and posed [m], welded
  MeshReport report;                  ///< of `mesh`; its sentences() list the faults of the surface
  std::vector<std::string> warnings;  ///< odd about the file: things left out, a doubtful unit
};

/// Reads a mesh. Throws MeshError; allocates; not for the loop. Same file and options give
/// bit-identical results.
ImportedMesh import_mesh(const std::filesystem::path& path, const ImportOptions& options = {},
                         const TriangleReader& read = read_triangles);
/// The same for a caller that has read the bytes.
ImportedMesh import_mesh(const std::filesystem::path& path, std::string bytes,
                         const ImportOptions& options, const TriangleReader& read = read_triangles);

}  // namespace voxtouch::mesh
