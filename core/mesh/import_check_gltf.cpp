/// glTF: positions and indices have the form that assimp takes them for, and lie where they are
/// said to; no node is there twice; and how many faces there are, for assimp leaves out those whose
/// indices do not fit.
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "core/mesh/import_check.hpp"

namespace voxtouch::mesh::import {
namespace {

using Json = nlohmann::json;

/// Of a .glb file. Throws where it is longer than the file or than the chunks together.
std::string_view json_chunk(const MeshFile& file) {
  const std::string_view bytes = file.bytes;
  if (bytes.size() < 20 || !bytes.starts_with("glTF"))
    refuse_truncated(file, "no header of a .glb file");
  const std::uint64_t total = little_u32(bytes, 8), json = little_u32(bytes, 12);
  if (total > bytes.size() || 20 + json > total)
    refuse_truncated(file, "the header speaks of " + std::to_string(total) + " bytes, " +
                               std::to_string(json) + " of them JSON, and there are " +
                               std::to_string(bytes.size()));
  return bytes.substr(20, json);
}

/// How many entries an accessor has, all of them in their buffer. That numbers are whole ones of 32
/// bits is looked after by assimp.
std::uint64_t entries(const Json& doc, const Json& index, bool positions) {
  constexpr std::uint64_t kNone = 0;
  const Json& accessor = doc.at("accessors").at(index.get<std::size_t>());
  const std::uint64_t type = accessor.at("componentType"), count = accessor.at("count");
  const std::uint64_t bytes = positions      ? 12 * (type == 5126)
                              : type == 5121 ? 1
                              : type == 5123 ? 2
                                             : 4 * (type == 5125);
  if (bytes == 0 || accessor.at("type") != (positions ? "VEC3" : "SCALAR") ||
      accessor.contains("sparse") || !accessor.contains("bufferView")) {
    throw std::runtime_error(
        "its positions or indices are compressed, or have a form that is not read; 32-bit floats "
        "are");
  }
  const Json& view = doc.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  const Json& buffer = doc.at("buffers").at(view.at("buffer").get<std::size_t>());
  const std::uint64_t length = view.at("byteLength"), stride = view.value("byteStride", bytes);
  if (count == 0 || accessor.value("byteOffset", kNone) + (count - 1) * stride + bytes > length ||
      (positions ? stride < bytes : stride != bytes) ||
      view.value("byteOffset", kNone) + length > buffer.at("byteLength").get<std::uint64_t>()) {
    throw std::runtime_error("accessor " + index.dump() + " speaks of " + std::to_string(count) +
                             " entries, and its buffer view holds " + std::to_string(length) +
                             " bytes");
  }
  return count;
}

/// Lines and points not counted.
std::uint64_t faces(const Json& doc, const Json& primitive) {
  std::uint64_t corners = entries(doc, primitive.at("attributes").at("POSITION"), true);
  if (primitive.contains("indices"))
    corners = entries(doc, primitive.at("indices"), false);
  const int mode = primitive.value("mode", 4);
  if (mode == 4 && corners % 3 != 0)
    throw std::runtime_error(std::to_string(corners) + " corners are no whole triangles");
  return mode < 4 ? 0 : mode == 4 ? corners / 3 : corners < 3 ? 0 : corners - 2;
}

}  // namespace

void check_gltf(MeshFile& file) {
  const Json doc =
      Json::parse(file.extension == "glb" ? json_chunk(file) : file.bytes, nullptr, false);
  if (doc.is_discarded())
    refuse_truncated(file, "its JSON does not end or is none");
  if (!doc.at("asset").at("version").get<std::string>().starts_with("2."))
    throw std::runtime_error("its version is not 2.x");
  std::set<Json> children;
  for (const Json& node : doc.value("nodes", Json::array())) {
    for (const Json& child : node.value("children", Json::array())) {
      if (!children.insert(child).second)
        throw std::runtime_error("a node hangs from two others");
    }
  }
  file.faces = 0;
  for (const Json& mesh : doc.value("meshes", Json::array())) {
    for (const Json& primitive : mesh.at("primitives"))
      *file.faces += faces(doc, primitive);
  }
}

}  // namespace voxtouch::mesh::import
