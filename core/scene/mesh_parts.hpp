#pragma once
/// The files that a mesh consists of.
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace voxtouch::scene {

/// Calls `visit` with a mesh file's bytes, and then with those of each buffer that a .gltf names,
/// in its order. A buffer that is not a regular file is skipped, since the import refuses the mesh.
/// Throws MeshError for an unreadable one.
void for_each_mesh_part(const std::filesystem::path& mesh, const std::string& bytes,
                        const std::function<void(std::string_view)>& visit);

/// SceneHash over all of them: that of the file if there are no others.
std::string hash_of_mesh(const std::filesystem::path& mesh, const std::string& bytes);

}  // namespace voxtouch::scene
