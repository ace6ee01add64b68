/// Converts assimp's result for a checked file to plain triangles.
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cmath>
#include <limits>

#include <span>

#include <fmt/format.h>

#include "core/mesh/import_check.hpp"
#include "core/mesh/polygon.hpp"

namespace voxtouch::mesh {
namespace import {
namespace {

/// Limits what assimp may open: the mesh file's checked bytes, and for .gltf the regular files that
/// it names, possibly percent-encoded.
class MeshFileOnly : public Assimp::DefaultIOSystem {
 public:
  explicit MeshFileOnly(const MeshFile& file) : file_(file) {}

  bool Exists(const char* name) const override { return is_mesh(name) || may_open(on_disk(name)); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (is_mesh(name))
      return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(file_.bytes.data()),
                                        file_.bytes.size());
    const std::string there = on_disk(name);
    return may_open(there) && mode[0] == 'r' ? DefaultIOSystem::Open(there.c_str(), mode) : nullptr;
  }

 private:
  bool is_mesh(const char* name) const { return file_.path.string() == name; }
  /// The name itself if such a file exists; otherwise with each %XX after the folder decoded.
  std::string on_disk(const std::string& name) const {
    const std::size_t folder = file_.path.parent_path().string().size();
    if (may_open(name) || name.size() <= folder)
      return name;
    std::string decoded = name.substr(0, folder);
    for (std::size_t k = folder; k < name.size(); ++k) {
      unsigned char character = 0;
      const char* digits = name.c_str() + k + 1;
      const bool encoded = name[k] == '%' && k + 2 < name.size() &&
                           std::from_chars(digits, digits + 2, character, 16).ptr == digits + 2;
      decoded += encoded ? static_cast<char>(character) : name[k];
      if (encoded)
        k += 2;
    }
    return decoded;
  }
  bool may_open(const std::string& name) const {
    std::error_code error;
    return file_.extension == "gltf" && std::filesystem::is_regular_file(name, error);
  }

  const MeshFile& file_;
};

/// One mesh hung from one node.
struct Placed {
  unsigned number;  ///< of the mesh among the scene's
  const aiMesh* mesh;
  Eigen::Matrix4d matrix;
};

/// Depth first, children in the file's order.
void place(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& outer,
           std::vector<Placed>& placed) {
  const Eigen::Map<const Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>> own(
      &node.mTransformation.a1);
  const Eigen::Matrix4d matrix = outer * own.cast<double>();
  for (unsigned k = 0; k < node.mNumMeshes; ++k) {
    if (node.mMeshes[k] < scene.mNumMeshes)
      placed.push_back({node.mMeshes[k], scene.mMeshes[node.mMeshes[k]], matrix});
  }
  for (unsigned k = 0; k < node.mNumChildren; ++k)
    place(scene, *node.mChildren[k], matrix, placed);
}

struct Counts {
  std::uint64_t points = 0, lines = 0, polygons = 0, triangles = 0;
  std::uint64_t astray = 0;  ///< corners at vertices that are not there

  void add(const aiMesh& mesh) {
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      const unsigned corners = face.mNumIndices;
      points += corners<2, lines += corners == 2, polygons += corners> 2;
      triangles += corners > 2 ? corners - 2 : 0;
      for (unsigned k = 0; k < corners; ++k)
        astray += face.mIndices[k] >= mesh.mNumVertices;
    }
  }
};

double single_spacing(double x) {
  const auto single = static_cast<float>(std::abs(x));
  const float next = std::nextafter(single, std::numeric_limits<float>::infinity());
  return static_cast<double>(next) - static_cast<double>(single);
}

/// Records the rounding steps of assimp's numbers: of the transformed vertices, and of the node's
/// position.
void note_spacing(const Placed& placed, FileTriangles& result) {
  double largest = 0.0;
  for (unsigned f = 0; f < placed.mesh->mNumFaces; ++f) {
    const aiFace& face = placed.mesh->mFaces[f];
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      const aiVector3D& x = placed.mesh->mVertices[face.mIndices[k]];
      largest =
          std::max({largest, std::abs(double{x.x}), std::abs(double{x.y}), std::abs(double{x.z})});
    }
  }
  const double stretch = placed.matrix.topLeftCorner<3, 3>().colwise().norm().maxCoeff();
  const double shift = placed.matrix.topRightCorner<3, 1>().cwiseAbs().maxCoeff();
  if (const double s = single_spacing(largest) * stretch; s > result.spacing)
    result.spacing = s, result.largest = largest * stretch;
  if (shift > 0.0 && single_spacing(shift) > result.spacing)
    result.spacing = single_spacing(shift), result.largest = shift;
}

[[noreturn]] void refuse_not_finite(const MeshFile& file, unsigned vertex) {
  refuse(file.path, fmt::format("vertex {} is not finite (after its node's transform)", vertex),
         "repair the mesh: NaN, infinity and numbers beyond 3.4e38 are not supported");
}

/// The faces of every mesh as triangles, in the file's order.
class FaceCutter {
 public:
  FaceCutter(const MeshFile& file, std::uint64_t polygons) : file_(file), polygons_(polygons) {}

  PolygonCutter::Triangles triangles_of(const aiMesh& mesh) {
    PolygonCutter::Triangles triangles;
    triangles.reserve(mesh.mNumFaces);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3)
        continue;
      ++number_;
      const std::span corners(face.mIndices, face.mNumIndices);
      if (corners.size() == 3)
        triangles.push_back({corners[0], corners[1], corners[2]});
      else
        cut(mesh, corners, triangles);
    }
    return triangles;
  }

 private:
  void cut(const aiMesh& mesh, std::span<const unsigned> corners, PolygonCutter::Triangles& all) {
    std::vector<Vec3> places;
    places.reserve(corners.size());
    for (const unsigned v : corners) {
      const aiVector3D& x = mesh.mVertices[v];
      places.emplace_back(x.x, x.y, x.z);
      if (!places.back().allFinite())
        refuse_not_finite(file_, v);
    }
    const auto triangles = cutter_.cut(places);
    if (!triangles)
      refuse_polygon(corners.size(), triangles.error());
    for (const auto& [a, b, c] : *triangles)
      all.push_back({corners[a], corners[b], corners[c]});
  }
  [[noreturn]] void refuse_polygon(std::size_t corners, const PolygonFault& fault) const {
    std::string where;
    if (fault.crossing) {
      const Vec3& x = *fault.crossing;
      where = fmt::format(" near ({:.6g}, {:.6g}, {:.6g})", x.x(), x.y(), x.z());
    }
    refuse(file_.path,
           fmt::format("polygon {} of {} ({} corners) intersects itself{}", number_, polygons_,
                       corners, where),
           "repair it, or export triangles");
  }

  const MeshFile& file_;
  PolygonCutter cutter_;
  std::uint64_t polygons_, number_ = 0;
};

void append(const MeshFile& file, const Placed& placed, const PolygonCutter::Triangles& triangles,
            TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const Eigen::Matrix3d linear = placed.matrix.topLeftCorner<3, 3>();
  const Vec3 shift = placed.matrix.topRightCorner<3, 1>();
  const bool as_is =
      placed.matrix == Eigen::Matrix4d::Identity();  // keeps the bits, also of a zero's sign
  for (unsigned v = 0; v < placed.mesh->mNumVertices; ++v) {
    const aiVector3D& a = placed.mesh->mVertices[v];
    const Vec3 x(a.x, a.y, a.z);
    mesh.vertices.push_back(as_is ? x : Vec3(linear * x + shift));
    if (!mesh.vertices.back().allFinite())
      refuse_not_finite(file, v);
  }
  const bool mirrored = linear.determinant() < 0.0;
  for (auto [a, b, c] : triangles) {
    if (mirrored)
      std::swap(b, c);
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
}

const aiScene& parse(const MeshFile& file, Assimp::Importer& importer) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  // Else nodes without meshes become little pyramids.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = importer.ReadFile(file.path.string(), 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string reason = importer.GetErrorString();
    if (reason == "std::bad_alloc")
      throw std::bad_alloc();
    if (reason.empty())
      reason = "no reason given";
    refuse(file.path, "cannot be read (" + printable(reason.substr(0, 200)) + ")",
           "check that it is a complete ." + file.extension + " file, or export it again");
  }
  return *scene;
}

FileTriangles read_checked(MeshFile file, const ImportOptions& options) {
  Assimp::Importer importer;
  importer.SetIOHandler(new MeshFileOnly(file));  // the importer owns it
  const aiScene& scene = parse(file, importer);
  std::string().swap(file.bytes);  // no longer needed; frees memory for the next steps
  std::vector<Placed> placed;
  place(scene, *scene.mRootNode, Eigen::Matrix4d::Identity(), placed);

  Counts all, own;
  for (const Placed& p : placed)
    all.add(*p.mesh);
  for (unsigned m = 0; m < scene.mNumMeshes; ++m)
    own.add(*scene.mMeshes[m]);
  if (all.triangles > options.max_triangles)
    refuse(file.path,
           "has " + std::to_string(all.triangles) + " triangles, limit " +
               std::to_string(options.max_triangles),
           "reduce the mesh, or raise max_triangles");
  if (own.astray > 0) {
    refuse(file.path,
           std::to_string(own.astray) + " corners of its faces have invalid vertex indices",
           "export it again");
  }
  if (file.faces && own.polygons != *file.faces)
    refuse_truncated(file, "its header declares " + std::to_string(*file.faces) +
                               " faces, readable: " + std::to_string(own.polygons));
  if (all.triangles == 0)
    refuse(file.path,
           "has no triangles (" + std::to_string(all.points) + " points, " +
               std::to_string(all.lines) + " lines)",
           "export the surface, with faces");
  FaceCutter cutter(file, own.polygons);
  std::vector<PolygonCutter::Triangles> triangles;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    triangles.push_back(cutter.triangles_of(*scene.mMeshes[m]));
  }
  FileTriangles result{
      .mesh = {}, .points = all.points, .lines = all.lines, .warnings = file.warnings};
  std::size_t vertices = 0;
  for (const Placed& p : placed)
    vertices += p.mesh->mNumVertices;
  result.mesh.vertices.reserve(vertices), result.mesh.triangles.reserve(all.triangles);
  for (const Placed& p : placed) {
    append(file, p, triangles[p.number], result.mesh);
    note_spacing(p, result);
  }
  if (result.mesh.triangles.empty())
    refuse(file.path, fmt::format("has {} polygons, all of zero area", own.polygons),
           "export it again, with triangles");
  return result;
}

}  // namespace
}  // namespace import

FileTriangles read_triangles(const std::filesystem::path& path, std::string bytes,
                             const ImportOptions& options) {
  try {
    return import::read_checked(import::open_mesh_file(path, std::move(bytes)), options);
  } catch (const MeshError&) {
    throw;
  } catch (const std::bad_alloc&) {
    import::refuse(path, "out of memory", "reduce the mesh");
  } catch (const std::exception& error) {
    import::refuse(path, "cannot be read (" + import::printable(error.what()) + ")",
                   "export it again");
  }
}

}  // namespace voxtouch::mesh
