/// glTF: assimp sees a file that holds nothing but nodes, meshes and the numbers they stand on, each index
/// checked.
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/mesh/import_check.hpp"

namespace voxtouch::import {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse_gltf(const MeshFile& file, const std::string& reason) {
  refuse(file.path, "is not a glTF 2.0 file as the format has it: " + reason, "export it again");
}

std::string bytes_of_u32(std::size_t value) {
  std::string bytes(4, '\0');
  for (std::size_t k = 0; k < 4; ++k) bytes[k] = static_cast<char>((value >> (8 * k)) & 0xff);
  return bytes;
}

/// The JSON chunk, and where the binary chunk's header begins (or the end of the bytes).
struct Chunks { std::string_view json; std::string_view rest; };

Chunks chunks_of_glb(const MeshFile& file) {
  const std::string_view bytes = file.bytes;
  if (bytes.size() < 20 || !bytes.starts_with("glTF")) refuse_truncated(file, "no header of a .glb file");
  if (little_u32(bytes, 4) != 2) refuse_gltf(file, "the version is not 2");
  const std::uint64_t total = little_u32(bytes, 8), json = little_u32(bytes, 12);
  if (total > bytes.size()) {
    refuse_truncated(file, "the header speaks of " + std::to_string(total) + " bytes, and there are " +
                     std::to_string(bytes.size()));
  }
  if (bytes.substr(16, 4) != "JSON" || json > total - 20) {
    refuse_truncated(file, "the JSON chunk does not fit");
  }
  std::string_view rest = bytes.substr(20 + json, total - 20 - json);
  if (rest.size() >= 8 && little_u32(rest, 0) > rest.size() - 8) {
    refuse_truncated(file, "the binary chunk does not fit");
  }
  if (rest.size() < 8) rest = {};
  return {bytes.substr(20, json), rest};
}

/// Brackets, outside of strings. Readers of JSON recurse.
void check_nesting(const MeshFile& file, std::string_view json) {
  constexpr int kDeepest = 64;
  int depth = 0;
  bool in_string = false;
  for (std::size_t k = 0; k < json.size(); ++k) {
    if (in_string) {
      if (json[k] == '\\') ++k;
      else if (json[k] == '"') in_string = false;
    } else if (json[k] == '"') {
      in_string = true;
    } else if (json[k] == '[' || json[k] == '{') {
      if (++depth > kDeepest) {
        refuse_gltf(file, "its JSON is nested more than " + std::to_string(kDeepest) + " deep");
      }
    } else if (json[k] == ']' || json[k] == '}') {
      --depth;
    }
  }
}

/// `from[key]` as a whole number below `limit`.
std::uint64_t number(const MeshFile& file, const Json& from, const char* key, std::uint64_t limit) {
  const auto found = from.find(key);
  if (found == from.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() >= limit) {
    refuse_gltf(file, std::string("'") + key + "' is missing or out of range");
  }
  return found->get<std::uint64_t>();
}

const Json& list(const MeshFile& file, const Json& from, const char* key) {
  static const Json kNone = Json::array();
  const auto found = from.find(key);
  if (found == from.end()) return kNone;
  if (!found->is_array()) refuse_gltf(file, std::string("'") + key + "' is no list");
  for (const Json& entry : *found) {
    if (key != std::string_view("children") && key != std::string_view("nodes") && !entry.is_object()) {
      refuse_gltf(file, std::string("an entry of '") + key + "' is no object");
    }
  }
  return *found;
}

Json keep(const Json& from, std::initializer_list<const char*> keys) {
  Json kept = Json::object();
  for (const char* key : keys) {
    if (const auto found = from.find(key); found != from.end()) kept[key] = *found;
  }
  return kept;
}

void check_numbers(const MeshFile& file, const Json& node, const char* key, std::size_t size) {
  const auto found = node.find(key);
  if (found == node.end()) return;
  bool good = found->is_array() && found->size() == size;
  for (const Json& value : *found) good = good && value.is_number();
  if (!good) {
    refuse_gltf(file, std::string("a node's '") + key + "' is not a list of " + std::to_string(size) +
        " numbers");
  }
}

/// Every node hangs from at most one other, as the format demands: then no cycle and no explosion can be
/// reached from a root.
Json checked_nodes(const MeshFile& file, const Json& doc) {
  constexpr int kDeepest = 128;
  const Json& all = list(file, doc, "nodes");
  std::vector<std::size_t> parent(all.size(), all.size());
  Json kept = Json::array();
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (!all[n].is_object()) refuse_gltf(file, "a node is no object");
    for (const Json& child : list(file, all[n], "children")) {
      if (!child.is_number_unsigned() || child.get<std::uint64_t>() >= all.size()) {
        refuse_gltf(file, "a child is no node");
      }
      std::size_t& its = parent[child.get<std::size_t>()];
      if (its != all.size()) refuse_gltf(file, "a node hangs from two others");
      its = n;
    }
    check_numbers(file, all[n], "matrix", 16);
    check_numbers(file, all[n], "translation", 3);
    check_numbers(file, all[n], "rotation", 4);
    check_numbers(file, all[n], "scale", 3);
    if (all[n].contains("mesh")) number(file, all[n], "mesh", list(file, doc, "meshes").size());
    kept.push_back(keep(all[n], {"children", "matrix", "translation", "rotation", "scale", "mesh"}));
  }
  for (std::size_t n = 0; n < all.size(); ++n) {
    int depth = 0;
    for (std::size_t p = n; p != all.size(); p = parent[p]) {
      if (++depth > kDeepest) {
        refuse_gltf(file, "its nodes hang in a ring, or more than " + std::to_string(kDeepest) + " deep");
      }
    }
  }
  return kept;
}

/// An accessor with as many numbers as its view holds; returns its count.
std::uint64_t check_accessor(const MeshFile& file, const Json& doc, std::uint64_t index, bool positions) {
  constexpr std::uint64_t kHuge = std::uint64_t{1} << 32;
  const Json& accessor = list(file, doc, "accessors")[index];
  const std::uint64_t count = number(file, accessor, "count", kHuge);
  const std::uint64_t type = number(file, accessor, "componentType", 10000);
  if (accessor.contains("sparse")) {
    refuse(file.path, "uses sparse accessors, which are not read", "export without them");
  }
  const std::uint64_t index_bytes = type == 5121 ? 1 : type == 5123 ? 2 : type == 5125 ? 4 : 0;
  const std::uint64_t bytes = positions ? (type == 5126 ? 12 : 0) : index_bytes;
  if (bytes == 0 || accessor.value("type", Json()) != Json(positions ? "VEC3" : "SCALAR")) {
    refuse(file.path, "has positions or indices in a form that is not read",
        "export positions as 32-bit floats");
  }
  const std::uint64_t at = number(file, accessor, "bufferView", list(file, doc, "bufferViews").size());
  const Json& view = list(file, doc, "bufferViews")[at];
  const std::uint64_t length = number(file, view, "byteLength", kHuge);
  const bool moved = accessor.contains("byteOffset");
  const std::uint64_t offset = moved ? number(file, accessor, "byteOffset", kHuge) : 0;
  const std::uint64_t stride = view.contains("byteStride") ? number(file, view, "byteStride", kHuge) : bytes;
  const bool fits = count > 0 && offset + (count - 1) * stride + bytes <= length;
  if (stride < bytes || (!positions && stride != bytes) || !fits) {
    refuse_truncated(file, "accessor " + std::to_string(index) + " speaks of " + std::to_string(count) +
                     " entries, and its buffer view holds " + std::to_string(length) + " bytes");
  }
  const std::uint64_t view_offset = view.contains("byteOffset") ? number(file, view, "byteOffset", kHuge) : 0;
  const std::uint64_t buffer = number(file, view, "buffer", list(file, doc, "buffers").size());
  if (view_offset + length > number(file, list(file, doc, "buffers")[buffer], "byteLength", kHuge)) {
    refuse_truncated(file, "buffer view " + std::to_string(at) + " reaches beyond its buffer");
  }
  return count;
}

/// Faces (lines and points not counted) of a primitive, which keeps its positions and indices only.
std::uint64_t check_primitive(const MeshFile& file, const Json& doc, const Json& primitive, Json& kept) {
  const std::size_t accessors = list(file, doc, "accessors").size();
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object()) {
    refuse_gltf(file, "a primitive has no attributes");
  }
  const std::uint64_t position = number(file, *attributes, "POSITION", accessors);
  std::uint64_t corners = check_accessor(file, doc, position, true);
  kept = keep(primitive, {"indices", "mode"});
  kept["attributes"] = {{"POSITION", position}};
  if (primitive.contains("indices")) {
    corners = check_accessor(file, doc, number(file, primitive, "indices", accessors), false);
  }
  const std::uint64_t mode = primitive.contains("mode") ? number(file, primitive, "mode", 7) : 4;
  if (mode == 4 && corners % 3 != 0) {
    refuse_truncated(file, std::to_string(corners) + " corners are no whole triangles");
  }
  return mode < 4 ? 0 : mode == 4 ? corners / 3 : corners < 3 ? 0 : corners - 2;
}

Json checked_meshes(MeshFile& file, const Json& doc, const ImportOptions& options) {
  Json kept = Json::array();
  std::uint64_t faces = 0;
  for (const Json& mesh : list(file, doc, "meshes")) {
    Json primitives = Json::array();
    for (const Json& primitive : list(file, mesh, "primitives")) {
      Json reduced;
      faces += check_primitive(file, doc, primitive, reduced);
      if (faces > options.max_triangles) refuse_size(file, faces, options);
      primitives.push_back(std::move(reduced));
    }
    kept.push_back({{"primitives", std::move(primitives)}});
  }
  file.faces = faces;
  return kept;
}

void check_extensions(const MeshFile& file, const Json& doc) {
  const auto required = doc.find("extensionsRequired");
  if (required == doc.end() || !required->is_array()) return;
  for (const Json& name : *required) {
    for (const char* geometry : {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
        "KHR_mesh_quantization"}) {
      if (name == Json(geometry)) {
        refuse(file.path, std::string("needs ") + geometry, "export without compression");
      }
    }
  }
}

Json scene_only(MeshFile& file, const Json& doc, const ImportOptions& options) {
  const auto asset = doc.find("asset");
  const Json version = asset != doc.end() && asset->is_object() ? asset->value("version", Json()) : Json();
  if (!version.is_string() || !version.get<std::string>().starts_with("2.")) {
    refuse_gltf(file, "the version is not 2.x");
  }
  check_extensions(file, doc);
  Json kept = {{"asset", {{"version", "2.0"}}}};
  kept["nodes"] = checked_nodes(file, doc);
  kept["meshes"] = checked_meshes(file, doc, options);
  Json scenes = Json::array();
  for (const Json& scene : list(file, doc, "scenes")) {
    for (const Json& node : list(file, scene, "nodes")) {
      if (!node.is_number_unsigned() || node.get<std::uint64_t>() >= kept["nodes"].size()) {
        refuse_gltf(file, "a scene names a node that is not there");
      }
    }
    scenes.push_back(keep(scene, {"nodes"}));
  }
  if (scenes.empty()) refuse(file.path, "has no scene", "export the mesh as part of a scene");
  kept["scene"] = doc.contains("scene") ? number(file, doc, "scene", scenes.size()) : 0;
  kept["scenes"] = std::move(scenes);
  for (const char* key : {"accessors", "bufferViews", "buffers"}) kept[key] = list(file, doc, key);
  return kept;
}

}  // namespace

void check_gltf(MeshFile& file, const ImportOptions& options) {
  const bool binary = file.extension == "glb";
  const Chunks chunks = binary ? chunks_of_glb(file) : Chunks{file.bytes, {}};
  check_nesting(file, chunks.json);
  const Json doc = Json::parse(chunks.json, nullptr, false);
  if (doc.is_discarded() || !doc.is_object()) refuse_truncated(file, "its JSON does not end or is none");
  std::string json = scene_only(file, doc, options).dump(-1, ' ', true, Json::error_handler_t::replace);
  if (!binary) {
    file.bytes = std::move(json);
    return;
  }
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF" + bytes_of_u32(2) + bytes_of_u32(20 + json.size() + chunks.rest.size()) +
      bytes_of_u32(json.size());
  glb.append("JSON").append(json).append(chunks.rest);
  file.bytes = std::move(glb);
}

}  // namespace voxtouch::import
