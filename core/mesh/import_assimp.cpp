#include "core/mesh/import_assimp.hpp"

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace Assimp {
/// Stands in front of the library's own, which ends the process: distributions ship assimp with its
/// assertions on, and some of them check what a file says rather than what assimp did. Thrown inside
/// ReadFile, it comes back as a message.
void aiAssertViolation(const char* expression, const char* file, int line);
void aiAssertViolation(const char* expression, const char*, int) {
  throw std::runtime_error(std::string("it contradicts itself: not ").append(expression));
}
}  // namespace Assimp

namespace voxtouch::import {
namespace {

/// What assimp may open: the mesh file's checked bytes, and for .gltf the regular files it names. Nothing
/// else is geometry.
class MeshFileOnly : public Assimp::DefaultIOSystem {
 public:
  MeshFileOnly(const MeshFile& file, std::uintmax_t most) : file_(file), most_(most) {}

  bool Exists(const char* name) const override { return is_mesh(name) || may_open(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (is_mesh(name)) {
      return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(file_.bytes.data()),
          file_.bytes.size());
    }
    return may_open(name) && mode[0] == 'r' ? DefaultIOSystem::Open(name, mode) : nullptr;
  }

 private:
  bool is_mesh(const char* name) const { return file_.path.string() == name; }
  bool may_open(const char* name) const {
    std::error_code error;
    return file_.extension == "gltf" && std::filesystem::is_regular_file(name, error) &&
           std::filesystem::file_size(name, error) <= most_;
  }

  const MeshFile& file_;
  std::uintmax_t most_;
};

/// One mesh hung from one node.
struct Placed {
  const aiMesh* mesh;
  Eigen::Matrix4d matrix;
};

Eigen::Matrix4d matrix_of(const aiNode& node) {
  const aiMatrix4x4& m = node.mTransformation;
  Eigen::Matrix4d result;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      result(row, column) = m[static_cast<unsigned>(row)][static_cast<unsigned>(column)];
    }
  }
  return result;
}

/// Depth first, children in the file's order. Depth is bounded by the checks of import_check.hpp.
void place(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& outer,
    std::vector<Placed>& placed) {
  const Eigen::Matrix4d matrix = outer * matrix_of(node);
  for (unsigned k = 0; k < node.mNumMeshes; ++k) {
    if (node.mMeshes[k] < scene.mNumMeshes) placed.push_back({scene.mMeshes[node.mMeshes[k]], matrix});
  }
  for (unsigned k = 0; k < node.mNumChildren; ++k) place(scene, *node.mChildren[k], matrix, placed);
}

/// Indices in range, numbers finite, polygons not absurd: before assimp cuts polygons, which trusts all
/// three.
void check_faces(const MeshFile& file, const aiScene& scene) {
  constexpr unsigned kMaxSides = 1024;  // cutting takes time with the square of the sides, or worse
  std::uint64_t number = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f, ++number) {
      const aiFace& face = mesh.mFaces[f];
      const std::string name = "face " + std::to_string(number) + " (counted from 0)";
      if (face.mNumIndices > kMaxSides) {
        refuse(file.path, name + " has " + std::to_string(face.mNumIndices) + " corners, and at most " +
               std::to_string(kMaxSides) + " are read", "triangulate on export");
      }
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        const unsigned v = face.mIndices[k];
        if (v >= mesh.mNumVertices || mesh.mVertices == nullptr) {
          refuse(file.path, name + " names vertex " + std::to_string(v) + " of " +
              std::to_string(mesh.mNumVertices),
                 "export it again");
        }
        const aiVector3D& x = mesh.mVertices[v];
        if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z)) {
          refuse(file.path, "vertex " + std::to_string(v) + ", corner " + std::to_string(k) + " of " + name +
              ", is not finite",
                 "repair the mesh: NaN, Inf and numbers beyond 3.4e38 cannot be placed");
        }
      }
    }
  }
}

struct Counts {
  std::uint64_t points = 0, lines = 0, polygons = 0, triangles = 0;
};

Counts count_faces(const aiMesh& mesh) {
  Counts c;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const unsigned corners = mesh.mFaces[f].mNumIndices;
    c.points += corners < 2;
    c.lines += corners == 2;
    c.polygons += corners > 2;
    c.triangles += corners > 2 ? corners - 2 : 0;
  }
  return c;
}

double single_spacing(double x) {
  const auto single = static_cast<float>(std::abs(x));
  const float next = std::nextafter(single, std::numeric_limits<float>::infinity());
  return static_cast<double>(next) - static_cast<double>(single);
}

/// The steps of the numbers that assimp held: of the vertices, as long as the node makes them, and of the
/// node's own place.
void note_spacing(const Placed& placed, Triangles& result) {
  double largest = 0.0;
  for (unsigned f = 0; f < placed.mesh->mNumFaces; ++f) {
    const aiFace& face = placed.mesh->mFaces[f];
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      const aiVector3D& x = placed.mesh->mVertices[face.mIndices[k]];
      largest = std::max({largest, std::abs(double{x.x}), std::abs(double{x.y}), std::abs(double{x.z})});
    }
  }
  const double stretch = placed.matrix.topLeftCorner<3, 3>().colwise().norm().maxCoeff();
  const double shift = placed.matrix.topRightCorner<3, 1>().cwiseAbs().maxCoeff();
  if (const double s = single_spacing(largest) * stretch; s > result.spacing) {
    result.spacing = s, result.largest = largest * stretch;
  }
  if (shift > 0.0 && single_spacing(shift) > result.spacing) {
    result.spacing = single_spacing(shift), result.largest = shift;
  }
}

void append(const MeshFile& file, const Placed& placed, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const Eigen::Matrix3d linear = placed.matrix.topLeftCorner<3, 3>();
  const Vec3 shift = placed.matrix.topRightCorner<3, 1>();
  const bool as_is = placed.matrix == Eigen::Matrix4d::Identity();  // keeps the bits, also of a zero's sign
  for (unsigned v = 0; v < placed.mesh->mNumVertices; ++v) {
    const aiVector3D& a = placed.mesh->mVertices[v];
    const Vec3 x(a.x, a.y, a.z);
    mesh.vertices.push_back(as_is ? x : Vec3(linear * x + shift));
    if (!mesh.vertices.back().allFinite()) {
      refuse(file.path, "vertex " + std::to_string(v) + " is not finite after its node's transform",
          "repair the node");
    }
  }
  const bool mirrored = linear.determinant() < 0.0;
  for (unsigned f = 0; f < placed.mesh->mNumFaces; ++f) {
    const aiFace& face = placed.mesh->mFaces[f];
    if (face.mNumIndices != 3) continue;
    const std::uint32_t a = first + face.mIndices[0], b = first + face.mIndices[1];
    const std::uint32_t c = first + face.mIndices[2];
    mesh.triangles.push_back(mirrored ? std::array{a, c, b} : std::array{a, b, c});
  }
}

const aiScene& parse(const MeshFile& file, Assimp::Importer& importer) {
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  // Else nodes without meshes become little pyramids.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = importer.ReadFile(file.path.string(), 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    std::string reason = importer.GetErrorString();
    if (reason.empty()) reason = "no reason given";
    refuse(file.path, "cannot be read (" + printable(reason.substr(0, 200)) + ")",
        "check that it is a whole ." + file.extension + " file, or export it again");
  }
  return *scene;
}

Triangles read_unguarded(const MeshFile& file, const ImportOptions& options) {
  Assimp::Importer importer;
  importer.SetIOHandler(new MeshFileOnly(file, options.max_file_bytes));  // the importer owns it
  const aiScene* scene = &parse(file, importer);
  check_faces(file, *scene);
  std::vector<Placed> placed;
  place(*scene, *scene->mRootNode, Eigen::Matrix4d::Identity(), placed);

  Triangles result;
  Counts all, own;
  for (const Placed& p : placed) {
    const Counts c = count_faces(*p.mesh);
    all.points += c.points, all.lines += c.lines, all.polygons += c.polygons, all.triangles += c.triangles;
    if (all.triangles > options.max_triangles) refuse_size(file, all.triangles, options);
  }
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) own.polygons += count_faces(*scene->mMeshes[m]).polygons;
  if (file.faces && own.polygons != *file.faces) {
    refuse_truncated(file, "it speaks of " + std::to_string(*file.faces) + " faces, and " +
        std::to_string(own.polygons) +
                     " can be read");
  }
  result.points = all.points, result.lines = all.lines;
  if (all.triangles == 0) {
    refuse(file.path, "has no triangles (" + std::to_string(all.points) + " points, " +
        std::to_string(all.lines) + " lines)",
           "export the surface, with faces");
  }
  if (all.triangles != all.polygons) {
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    if (scene == nullptr) {
      refuse(file.path, "its polygons cannot be cut into triangles", "triangulate on export");
    }
    placed.clear();
    place(*scene, *scene->mRootNode, Eigen::Matrix4d::Identity(), placed);
  }
  for (const Placed& p : placed) append(file, p, result.mesh), note_spacing(p, result);
  result.uncut = all.triangles - std::min<std::uint64_t>(all.triangles, result.mesh.triangles.size());
  return result;
}

}  // namespace

Triangles read_triangles(const MeshFile& file, const ImportOptions& options) {
  try {
    return read_unguarded(file, options);
  } catch (const MeshError&) {
    throw;
  } catch (const std::bad_alloc&) {
    refuse(file.path, "needs more memory than there is", "reduce the mesh");
  } catch (const std::exception& error) {
    refuse(file.path, std::string("cannot be read (") + error.what() + ")", "export it again");
  }
}

}  // namespace voxtouch::import
