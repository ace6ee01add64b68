#pragma once
/// A first scene of a mesh, as `voxtouch new` proposes it.
#include <filesystem>
#include <string>

namespace voxtouch::cli {

/// Writes a scene of `part` and a sphere as the tool, for `device`, to `out`, which must not exist;
/// the reasons go to stderr. Throws std::runtime_error, a sentence.
void write_first_scene(const std::filesystem::path& part, const std::string& device,
                       const std::filesystem::path& out);

}  // namespace voxtouch::cli
