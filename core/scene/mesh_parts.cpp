#include "core/scene/mesh_parts.hpp"

#include <algorithm>
#include <cctype>

#include <nlohmann/json.hpp>

#include "core/mesh/mesh_bytes.hpp"
#include "core/scene/scene_hash.hpp"

namespace voxtouch::scene {
namespace {

bool is_gltf(const std::filesystem::path& mesh) {
  std::string extension = mesh.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".gltf";
}

}  // namespace

void for_each_mesh_part(const std::filesystem::path& mesh, const std::string& bytes,
                        const std::function<void(std::string_view)>& visit) {
  visit(bytes);
  if (!is_gltf(mesh))
    return;
  const nlohmann::json doc = nlohmann::json::parse(bytes, nullptr, false);
  if (!doc.is_object() || !doc.contains("buffers") || !doc["buffers"].is_array())
    return;
  for (const nlohmann::json& buffer : doc["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string())
      continue;
    const std::filesystem::path file = mesh.parent_path() / buffer["uri"].get<std::string>();
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error))
      visit(mesh::read_mesh_bytes(file));  // "data:..." is none
  }
}

std::string hash_of_mesh(const std::filesystem::path& mesh, const std::string& bytes) {
  SceneHash hash;
  for_each_mesh_part(mesh, bytes, [&](std::string_view part) { hash.add(part); });
  return hash.hex();
}

}  // namespace voxtouch::scene
