/// glTF: checks that positions and indices have the form and range that assimp expects, and that no
/// node occurs twice. Counts the faces, because assimp skips those with invalid indices.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "core/mesh/import_check.hpp"

namespace voxtouch::mesh::import {
namespace {

using Json = nlohmann::json;

/// The JSON chunk of a .glb file. Throws if its length exceeds the file or the chunks together.
std::string_view json_chunk(const MeshFile& file) {
  const std::string_view bytes = file.bytes;
  if (bytes.size() < 20 || !bytes.starts_with("glTF"))
    refuse_truncated(file, "missing .glb header");
  const std::uint64_t total = little_u32(bytes, 8), json = little_u32(bytes, 12);
  if (total > bytes.size() || 20 + json > total)
    refuse_truncated(file, "the header declares " + std::to_string(total) + " bytes, " +
                               std::to_string(json) + " of them JSON; the file has " +
                               std::to_string(bytes.size()));
  return bytes.substr(20, json);
}

/// Number of entries of an accessor, all within their buffer. assimp checks that numbers are 32-bit
/// integers.
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
        "its positions or indices are compressed or of an unsupported type (supported: 32-bit "
        "floats)");
  }
  const Json& view = doc.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  const Json& buffer = doc.at("buffers").at(view.at("buffer").get<std::size_t>());
  const std::uint64_t length = view.at("byteLength"), stride = view.value("byteStride", bytes);
  if (count == 0 || accessor.value("byteOffset", kNone) + (count - 1) * stride + bytes > length ||
      (positions ? stride < bytes : stride != bytes) ||
      view.value("byteOffset", kNone) + length > buffer.at("byteLength").get<std::uint64_t>()) {
    throw std::runtime_error("accessor " + index.dump() + " declares " + std::to_string(count) +
                             " entries, its buffer view has " + std::to_string(length) + " bytes");
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
    throw std::runtime_error(std::to_string(corners) + " corners are not a multiple of 3");
  return mode < 4 ? 0 : mode == 4 ? corners / 3 : corners < 3 ? 0 : corners - 2;
}

/// Extensions that a file may require although they are ignored: light, colour, texture, text. They
/// do not change the shape.
bool leaves_shape(std::string_view extension) {
  for (const std::string_view start : {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                       "KHR_lights_", "EXT_lights_", "KHR_xmp"}) {
    if (extension.starts_with(start))
      return true;
  }
  return false;
}

[[noreturn]] void refuse_shape(const MeshFile& file, const std::string& reason) {
  refuse(file.path, reason + ", which is not supported and changes its shape",
         "export plain meshes, with all modifiers applied");
}

/// Whether a weight is not 0: a morph target then moves vertices.
bool morphs(const Json& of) {
  const Json weights = of.value("weights", Json::array());
  return std::ranges::any_of(weights,
                             [](const Json& weight) { return weight.get<double>() != 0.0; });
}

/// Refuses what would place vertices elsewhere than the nodes' transforms.
void check_shape(const MeshFile& file, const Json& doc) {
  for (const Json& extension : doc.value("extensionsRequired", Json::array())) {
    const auto name = extension.get<std::string>();
    if (!leaves_shape(name))
      refuse_shape(file, "requires the extension '" + printable(name.substr(0, 60)) + "'");
  }
  const Json nodes = doc.value("nodes", Json::array()), meshes = doc.value("meshes", Json::array());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const std::string name = "its node " + std::to_string(n);
    const Json extensions = nodes[n].value("extensions", Json::object());
    for (const char* places : {"EXT_mesh_gpu_instancing", "KHR_node_visibility"}) {
      if (extensions.contains(places))
        refuse_shape(file, name + " uses the extension '" + places + "'");
    }
    if (nodes[n].contains("skin") && nodes[n].contains("mesh"))
      refuse_shape(file, name + " has a skin");
    if (nodes[n].contains("mesh") && morphs(nodes[n]))
      refuse_shape(file, name + " has weights of morph targets");
  }
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (morphs(meshes[m]))
      refuse_shape(file, "its mesh " + std::to_string(m) + " has weights of morph targets");
  }
}

/// Replaces the file's JSON.
void put_json(MeshFile& file, const Json& doc) {
  std::string text = doc.dump();
  if (file.extension == "glb") {
    const std::size_t behind = 20 + json_chunk(file).size();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::string rest = file.bytes.substr(std::min(behind, file.bytes.size()));
    const auto word = [](std::size_t value) {
      std::string four;
      for (int k = 0; k < 4; ++k)
        four += static_cast<char>(value >> (8 * k) & 0xff);
      return four;
    };
    text = file.bytes.substr(0, 8) + word(20 + text.size() + rest.size()) + word(text.size()) +
           file.bytes.substr(16, 4) + text + rest;
  }
  file.bytes = std::move(text);
}

/// A file need not list the displayed nodes. If so, these are the nodes without a parent, with
/// their descendants.
void add_scene(MeshFile& file, Json& doc, const std::set<Json>& children) {
  if (!doc.value("scenes", Json::array()).empty())
    return;
  const std::size_t nodes = doc.value("nodes", Json::array()).size();
  const std::size_t meshes = doc.value("meshes", Json::array()).size();
  Json roots = Json::array();
  for (std::size_t n = 0; n < nodes; ++n) {
    if (!children.contains(Json(n)))
      roots.push_back(n);
  }
  if (roots.empty()) {
    for (std::size_t m = 0; m < meshes; ++m) {
      doc["nodes"].push_back({{"mesh", m}});
      roots.push_back(m);
    }
  }
  doc["scenes"] = Json::array({{{"nodes", roots}}});
  doc["scene"] = 0;
  put_json(file, doc);
  file.warnings.push_back("it has no default scene: all its nodes are read");
}

/// Refuses a file whose default scene has no mesh: assimp reads no faces then.
void check_scene(const MeshFile& file, const Json& doc) {
  const std::size_t scene = doc.value("scene", std::size_t{0});
  const Json nodes = doc.value("nodes", Json::array());
  std::vector<std::size_t> open =
      doc.at("scenes").at(scene).value("nodes", std::vector<std::size_t>());
  // A ring of nodes ends after as many steps as there are nodes; assimp refuses it.
  for (std::size_t step = 0; !open.empty(); ++step) {
    if (step > nodes.size())
      return;
    const Json& node = nodes.at(open.back());
    open.pop_back();
    if (node.contains("mesh"))
      return;
    const auto children = node.value("children", std::vector<std::size_t>());
    open.insert(open.end(), children.begin(), children.end());
  }
  refuse(file.path, fmt::format("its default scene, number {}, contains no mesh", scene),
         "set \"scene\" to a scene with meshes, or export it again");
}

}  // namespace

void check_gltf(MeshFile& file) {
  Json doc = Json::parse(file.extension == "glb" ? json_chunk(file) : file.bytes, nullptr, false);
  if (doc.is_discarded())
    refuse_truncated(file, "its JSON is invalid or incomplete");
  if (!doc.at("asset").at("version").get<std::string>().starts_with("2."))
    throw std::runtime_error("its version is not 2.x");
  std::set<Json> children;
  for (const Json& node : doc.value("nodes", Json::array())) {
    for (const Json& child : node.value("children", Json::array())) {
      if (!children.insert(child).second)
        throw std::runtime_error("a node has two parents");
    }
  }
  check_shape(file, doc);
  file.faces = 0;
  for (const Json& mesh : doc.value("meshes", Json::array())) {
    for (const Json& primitive : mesh.at("primitives"))
      *file.faces += faces(doc, primitive);
  }
  add_scene(file, doc, children);
  check_scene(file, doc);
}

}  // namespace voxtouch::mesh::import
