#pragma once
/// The bytes of a mesh file, read once and no more of them than there may be.
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace voxtouch::mesh {

/// A mesh that cannot be used. The sentence names the file, the reason and the remedy.
struct MeshError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline constexpr std::uintmax_t kLargestMeshFile = std::uintmax_t{512} << 20;  ///< [bytes]

/// The whole file. Throws MeshError if it is not a regular file, is empty, cannot be read or has
/// more than `most` bytes, which is checked before reading.
std::string read_mesh_bytes(const std::filesystem::path& path,
                            std::uintmax_t most = kLargestMeshFile);

/// Whether the name ends like those of mesh files that can be read, in small or capital letters.
bool names_mesh(const std::filesystem::path& path);

namespace import {
/// In lower case, without the dot.
std::string extension_of(const std::filesystem::path& path);
/// Throws MeshError("<path>: <reason>; <remedy>").
[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& reason,
                         const std::string& remedy);
}  // namespace import

}  // namespace voxtouch::mesh
