#pragma once
/// What a mesh is read from in addition to its own file.
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace voxtouch::scene {

/// Calls `visit` with a mesh file's bytes, and then with those of each file that it names as a
/// buffer, in its order: a .gltf may have such. A buffer that is no regular file is left out, since
/// the import refuses the mesh. Throws MeshError for one that cannot be read.
void for_each_mesh_part(const std::filesystem::path& mesh, const std::string& bytes,
                        const std::function<void(std::string_view)>& visit);

/// SceneHash over all of them: that of the file alone where there are no others.
std::string hash_of_mesh(const std::filesystem::path& mesh, const std::string& bytes);

}  // namespace voxtouch::scene
