#pragma once
/// Meshes from files: OBJ, STL (text, binary), PLY (text, binary), glTF 2.0 (.gltf, .glb) and
/// COLLADA (.dae), read by assimp.
///
/// What comes through
///   Triangle k of the result is triangle k of the file: faces in file order (for glTF and COLLADA
///   node by node, depth first), polygons cut into triangles in place (polygon.hpp), nothing
///   dropped, zero-area triangles kept. Groups, materials, normals, textures and animations are not
///   read. What would change the shape and is not read (skins, morph weights, unknown required
///   extensions, free-form surfaces) is refused. Oddities that leave the shape as it is (byte order
///   marks, padding, keywords in capitals) are warnings. Vertices are the file's numbers rounded to
///   single precision (assimp holds no more), then double throughout; vertices at one position
///   become one (weld()).
/// Units and axes
///   OBJ, STL, PLY carry no unit: the numbers are taken as metres unless `scale` says otherwise.
///   glTF is in metres. COLLADA declares its unit; assimp turns it into metres (with the
///   single-precision factor, so 1 mm is 0.001 m to about 5e-8). No axes are exchanged: glTF's +Y
///   up stays +Y, and COLLADA's <up_axis> is ignored (assimp would turn Z_UP and X_UP files to Y
///   up; that is switched off), so that coordinates read as the modelling tool shows them. Turn the
///   mesh with `pose`. A node that mirrors (negative determinant) keeps its triangles facing
///   outward.
/// Files are not trusted: what assimp would take for another shape is refused before it sees the
/// bytes, and it reads nothing but the mesh file and, for .gltf, the buffers it names. A broken
/// file may still crash it, hang it or fill memory: where that must not be, it reads in a process
/// of its own (nodes/mesh_import).
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

/// What a file holds, as assimp and the checks before it found it.
struct FileTriangles {
  TriangleMesh mesh;  ///< nodes applied, in the file's unit (COLLADA: metres); not welded
  std::uint64_t points = 0, lines = 0;  ///< left out
  double spacing = 0.0;  ///< widest step of single precision at the coordinates, after nodes
  double largest = 0.0;  ///< the coordinate it belongs to
  std::vector<std::string> warnings;  ///< what was skipped in addition to points and lines
};

/// From a file's bytes to triangles, at most as many as the options say. Throws MeshError; what it
/// gives is finite, with every corner there.
using TriangleReader = std::function<FileTriangles(const std::filesystem::path&, std::string bytes,
                                                   const ImportOptions&)>;
/// The reader that does it here and now.
FileTriangles read_triangles(const std::filesystem::path& path, std::string bytes,
                             const ImportOptions& options);

/// Whether the file's format fixes or declares the unit of its numbers, so that they are read as
/// metres. By the ending alone: true for glTF and COLLADA.
bool has_own_unit(const std::filesystem::path& path);

struct ImportedMesh {
  TriangleMesh mesh;  ///< scaled and posed [m], welded
  MeshReport report;  ///< of `mesh`; its sentences() say what is wrong with the surface
  std::vector<std::string> warnings;  ///< odd about the file: things left out, a doubtful unit
};

/// Reads a mesh. Throws MeshError; allocates; not for the loop. Same file and options give
/// bit-identical results.
ImportedMesh import_mesh(const std::filesystem::path& path, const ImportOptions& options = {},
                         const TriangleReader& read = read_triangles);
/// The same from the file's bytes, for those who have looked at them already.
ImportedMesh import_mesh(const std::filesystem::path& path, std::string bytes,
                         const ImportOptions& options, const TriangleReader& read = read_triangles);

}  // namespace voxtouch::mesh
