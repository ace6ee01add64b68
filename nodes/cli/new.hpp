#pragma once
/// A first scene of a mesh, as `voxtouch new` proposes it.
#include <filesystem>
#include <string>

namespace voxtouch::cli {

/// Writes a scene of `part` and a sphere as the tool, for `device`, to `out`, which must not exist;
/// the reasons go to stderr. Throws std::runtime_error, a sentence.
void write_first_scene(const std::filesystem::path& part, const std::string& device,
                       const std::filesystem::path& out);

/// Writes a scene as above for a mesh to try; it replaces the one tried last. Throws as above.
std::string tried_scene(const std::filesystem::path& mesh, const std::string& device);
/// The folder of tried scenes, which is there.
std::filesystem::path tried_folder();

}  // namespace voxtouch::cli
