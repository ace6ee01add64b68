#include "core/reference/reference_mesh.hpp"

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <unordered_map>

#include "core/reference/ear_clipping.hpp"
#include "core/reference/plain_mesh_files.hpp"

namespace voxtouch::reference {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Eigen::Affine3d transform_of(const aiMatrix4x4& m) {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      out.matrix()(row, column) =
          static_cast<double>(m[static_cast<unsigned>(row)][static_cast<unsigned>(column)]);
  return out;
}

/// Numbers are vertices, as in `face`. Polygons are cut neither by the reader of the voxmap nor by
/// assimp.
template <class PlaceOf>
Triangles triangles_of(std::span<const std::uint32_t> face, const PlaceOf& place_of) {
  if (face.size() == 3)
    return {{face[0], face[1], face[2]}};
  std::vector<Vec3> corners;
  for (const std::uint32_t vertex : face)
    corners.push_back(place_of(vertex));
  Triangles triangles = clip_ears(corners);
  for (auto& t : triangles) {
    for (std::uint32_t& corner : t)
      corner = face[corner];
  }
  return triangles;
}

void append(const aiMesh& mesh, const Eigen::Affine3d& to_file, double scale,
            std::vector<Vec3>& vertices, Triangles& triangles) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& p = mesh.mVertices[v];
    vertices.push_back(scale * (to_file * Vec3(p.x, p.y, p.z)));
  }
  const bool mirrored = to_file.linear().determinant() < 0;  // a mirror inverts triangles
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices < 3)
      continue;  // lines and points have neither interior nor surface
    const auto place_of = [&mesh](std::uint32_t v) {
      return Vec3(mesh.mVertices[v].x, mesh.mVertices[v].y, mesh.mVertices[v].z);
    };
    for (std::array<std::uint32_t, 3> t :
         triangles_of(std::span(face.mIndices, face.mNumIndices), place_of)) {
      for (std::uint32_t& corner : t)
        corner += first;
      if (mirrored)
        std::swap(t[1], t[2]);
      triangles.push_back(t);
    }
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

/// Merges positions that differ only by the rounding of a single-precision file: within a few float
/// steps of the largest coordinate. An unmerged seam would leave the mesh open, without a defined
/// interior.
class Joiner {
 public:
  explicit Joiner(double largest_coordinate) : step_(kSteps * largest_coordinate) {}

  /// The index of the first vertex at `position`; adds a new one to `vertices` if there is none.
  std::uint32_t id_of(const Vec3& position, std::vector<Vec3>& vertices) {
    const Cell cell = cell_of(position);
    std::uint32_t found = kNone;  // of several the first added, because the table has no order
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y)
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto [first, last] = cells_.equal_range({cell[0] + x, cell[1] + y, cell[2] + z});
          for (auto entry = first; entry != last; ++entry)
            if (entry->second < found &&
                (vertices[entry->second] - position).cwiseAbs().maxCoeff() <= step_)
              found = entry->second;
        }
    if (found != kNone)
      return found;
    const auto id = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(position);
    cells_.emplace(cell, id);
    return id;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& c) const noexcept {
      std::uint64_t all = 0;
      for (const std::int64_t index : c)
        all = (all ^ static_cast<std::uint64_t>(index)) * 0x9e3779b97f4a7c15U, all ^= all >> 32;
      return static_cast<std::size_t>(all);
    }
  };
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr double kSteps = 4.0 / (1 << 23);
  Cell cell_of(const Vec3& p) const {
    const auto index = [this](double x) {
      return step_ > 0 ? static_cast<std::int64_t>(std::floor(x / step_)) : 0;
    };
    return {index(p.x()), index(p.y()), index(p.z())};
  }
  double step_;
  std::unordered_multimap<Cell, std::uint32_t, Hash> cells_;
};

/// Largest absolute coordinate. Throws for a non-finite one.
double largest_coordinate(const std::vector<Vec3>& vertices, const Triangles& triangles,
                          const std::string& name) {
  double largest = 0.0;
  for (const auto& t : triangles)
    for (const std::uint32_t vertex : t) {
      if (!vertices.at(vertex).allFinite())
        throw std::runtime_error(name + ": a vertex has NaN or infinity; repair the mesh");
      largest = std::max(largest, vertices[vertex].cwiseAbs().maxCoeff());
    }
  return largest;
}

/// The same triangle for any starting corner.
std::array<std::uint32_t, 3> canonical(std::array<std::uint32_t, 3> t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// Returns true if the boundary of the triangles, as a chain of directed edges, is empty. This is
/// equivalent to an integer winding number everywhere off the surface.
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

ReferenceMesh make_reference_mesh(const std::vector<Vec3>& vertices, const Triangles& triangles,
                                  const std::string& name) {
  ReferenceMesh out;
  Joiner joiner(largest_coordinate(vertices, triangles, name));
  std::set<std::array<std::uint32_t, 3>> seen;
  const auto id_of = [&](std::uint32_t vertex) {
    return joiner.id_of(vertices[vertex], out.vertices);
  };
  for (const auto& t : triangles) {
    const std::array<std::uint32_t, 3> welded = canonical({id_of(t[0]), id_of(t[1]), id_of(t[2])});
    const Vec3& a = out.vertices[welded[0]];
    const double doubled_area =
        (out.vertices[welded[1]] - a).cross(out.vertices[welded[2]] - a).norm();
    const bool collapsed =
        welded[0] == welded[1] || welded[1] == welded[2] || welded[0] == welded[2];
    if (collapsed || !(doubled_area > 0) || !seen.insert(welded).second)
      ++out.dropped;
    else
      out.triangles.push_back(welded);
  }
  if (out.triangles.empty())
    throw std::runtime_error(name + ": has no triangle with an area; check the file and its scale");
  out.closed = balanced(out.triangles);
  return out;
}

namespace {

/// Reads the file if it is an OBJ or an STL.
std::optional<PlainFile> read_plain(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending != ".obj" && ending != ".stl")
    return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (!in)
    throw std::runtime_error("the file does not exist or is not readable");
  return ending == ".obj" ? read_obj(bytes) : read_stl(bytes);
}

/// File access for assimp: without a byte order mark, and with percent-encoded names.
class FilesOfTheMesh : public Assimp::DefaultIOSystem {
 public:
  bool Exists(const char* name) const override {
    return DefaultIOSystem::Exists(found(name).c_str());
  }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    Assimp::IOStream* stream = DefaultIOSystem::Open(found(name).c_str(), mode);
    std::array<char, 3> start{};
    const bool whole =
        stream != nullptr && stream->Read(start.data(), 1, start.size()) == start.size();
    const bool marked = whole && std::string_view(start.data(), start.size()) == "\xef\xbb\xbf";
    if (stream != nullptr && !marked)
      stream->Seek(0, aiOrigin_SET);
    return marked ? rest_of(stream) : stream;
  }

 private:
  static Assimp::IOStream* rest_of(Assimp::IOStream* stream) {
    const std::unique_ptr<Assimp::IOStream> file(stream);
    const std::size_t size = file->FileSize() - file->Tell();
    auto bytes = std::make_unique<std::uint8_t[]>(size);
    file->Read(bytes.get(), 1, size);
    constexpr bool kOwned = true;
    return new Assimp::MemoryIOStream(bytes.release(), size, kOwned);
  }
  static std::string found(const std::string& name) {
    const std::filesystem::path path(name);
    const std::string plain = (path.parent_path() / decoded(path.filename().string())).string();
    return !std::filesystem::exists(path) && std::filesystem::exists(plain) ? plain : name;
  }
  static std::string decoded(std::string name) {
    for (std::size_t at = 0; (at = name.find('%', at)) != std::string::npos; ++at) {
      unsigned char character = 0;
      const char* digits = name.c_str() + at + 1;
      if (name.size() < at + 3 ||
          std::from_chars(digits, digits + 2, character, 16).ptr != digits + 2)
        continue;
      name.replace(at, 3, 1, static_cast<char>(character));
    }
    return name;
  }
};

void read_by_assimp(const std::string& name, double scale, std::vector<Vec3>& vertices,
                    Triangles& triangles) {
  Assimp::Importer importer;
  importer.SetIOHandler(new FilesOfTheMesh);  // the importer owns it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION,
                           true);  // axes as in the file
  const aiScene* scene = importer.ReadFile(name, 0);
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw std::runtime_error(importer.GetErrorString());
  walk(*scene, *scene->mRootNode, Eigen::Affine3d::Identity(), scale, vertices, triangles);
}

}  // namespace

ReferenceMesh read_reference_mesh(const scene::MeshSpec& spec) {
  const std::string name = spec.path.string();
  if (!(spec.scale > 0) || !std::isfinite(spec.scale))
    throw std::runtime_error(name + ": scale " + std::to_string(spec.scale) +
                             " is not a positive number; correct the scene");
  std::vector<Vec3> vertices;
  Triangles triangles;
  try {
    if (const auto plain = read_plain(spec.path)) {
      for (const Vec3& v : plain->vertices)
        vertices.push_back(spec.scale * v);
      for (const auto& face : plain->faces) {
        const Triangles cut =
            triangles_of(face, [&](std::uint32_t v) { return plain->vertices[v]; });
        triangles.insert(triangles.end(), cut.begin(), cut.end());
      }
    } else {
      read_by_assimp(name, spec.scale, vertices, triangles);
    }
  } catch (const std::runtime_error& fault) {
    throw std::runtime_error(name + ": the mesh cannot be read (" + fault.what() +
                             "); check path and format");
  }
  return make_reference_mesh(vertices, triangles, name);
}

}  // namespace voxtouch::reference
