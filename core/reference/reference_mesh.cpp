#include "core/reference/reference_mesh.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

namespace voxtouch {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Eigen::Affine3d transform_of(const aiMatrix4x4& m) {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      out.matrix()(row, column) = static_cast<double>(m[static_cast<unsigned>(row)][static_cast<unsigned>(column)]);
  return out;
}

void append(const aiMesh& mesh, const Eigen::Affine3d& to_file, double scale, std::vector<Vec3>& vertices,
            Triangles& triangles) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& p = mesh.mVertices[v];
    vertices.push_back(scale * (to_file * Vec3(p.x, p.y, p.z)));
  }
  const bool mirrored = to_file.linear().determinant() < 0;  // a mirror turns triangles inside out
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) continue;  // lines and points have no inside and no surface
    std::array<std::uint32_t, 3> t{first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]};
    if (mirrored) std::swap(t[1], t[2]);
    triangles.push_back(t);
  }
}

void walk(const aiScene& scene, const aiNode& node, const Eigen::Affine3d& parent, double scale,
          std::vector<Vec3>& vertices, Triangles& triangles) {
  const Eigen::Affine3d to_file = parent * transform_of(node.mTransformation);
  for (unsigned m = 0; m < node.mNumMeshes; ++m)
    append(*scene.mMeshes[node.mMeshes[m]], to_file, scale, vertices, triangles);
  for (unsigned c = 0; c < node.mNumChildren; ++c)
    walk(scene, *node.mChildren[c], to_file, scale, vertices, triangles);
}

struct LessPosition {
  bool operator()(const Vec3& a, const Vec3& b) const {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  }
};

/// The same triangle, whichever corner it starts with.
std::array<std::uint32_t, 3> canonical(std::array<std::uint32_t, 3> t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// True if the boundary of the triangles, as a chain of directed edges, is empty. That is exactly when the winding number is
/// an integer everywhere off the surface.
bool balanced(const Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> walks;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      walks[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return std::all_of(walks.begin(), walks.end(), [](const auto& walk) { return walk.second == 0; });
}

}  // namespace

ReferenceMesh make_reference_mesh(const std::vector<Vec3>& vertices, const Triangles& triangles, const std::string& name) {
  ReferenceMesh out;
  std::map<Vec3, std::uint32_t, LessPosition> ids;
  std::vector<std::uint32_t> joined(vertices.size(), 0);
  std::set<std::array<std::uint32_t, 3>> seen;
  const auto id_of = [&](std::uint32_t vertex) {
    const Vec3 position = vertices.at(vertex) + Vec3::Zero();  // -0 becomes 0: they are the same place
    if (!position.allFinite())
      throw std::runtime_error(name + ": a vertex has a coordinate that is not a finite number; repair the mesh");
    const auto [entry, fresh] = ids.try_emplace(position, static_cast<std::uint32_t>(out.vertices.size()));
    if (fresh) out.vertices.push_back(position);
    return entry->second;
  };
  for (const auto& t : triangles) {
    const std::array<std::uint32_t, 3> welded = canonical({id_of(t[0]), id_of(t[1]), id_of(t[2])});
    const Vec3& a = out.vertices[welded[0]];
    const double doubled_area = (out.vertices[welded[1]] - a).cross(out.vertices[welded[2]] - a).norm();
    if (!(doubled_area > 0) || !seen.insert(welded).second)
      ++out.dropped;
    else
      out.triangles.push_back(welded);
  }
  if (out.triangles.empty())
    throw std::runtime_error(name + ": holds no triangle with an area; check the file and its scale");
  out.closed = balanced(out.triangles);
  return out;
}

ReferenceMesh read_reference_mesh(const MeshSpec& spec) {
  const std::string name = spec.path.string();
  if (!(spec.scale > 0) || !std::isfinite(spec.scale))
    throw std::runtime_error(name + ": scale " + std::to_string(spec.scale) + " is not a positive number; correct the scene");
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw std::runtime_error(name + ": the mesh cannot be read (" + importer.GetErrorString() + "); check path and format");
  std::vector<Vec3> vertices;
  Triangles triangles;
  walk(*scene, *scene->mRootNode, Eigen::Affine3d::Identity(), spec.scale, vertices, triangles);
  return make_reference_mesh(vertices, triangles, name);
}

}  // namespace voxtouch
