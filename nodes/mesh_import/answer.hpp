#pragma once
/// The result of the reading process, as plain bytes of this machine: a head of fixed size,
/// vertices, triangles, text. It replaces the mesh's bytes in the memory file that both processes
/// map.
#include <string>
#include <string_view>

#include "core/mesh/import.hpp"

namespace voxtouch::mesh_import {

inline constexpr int kSharedFile = 3;  ///< its descriptor in the reading process
inline constexpr const char* kAsItIs =
    "as_it_is";  ///< reads the file without checks and returns nothing

std::string encode(const mesh::FileTriangles& read);
std::string encode_refusal(const std::string& sentence);

/// Throws MeshError with the refusal's sentence, and std::runtime_error if the bytes are
/// incomplete, a vertex is not finite or a triangle has an invalid index.
mesh::FileTriangles decode(std::string_view answer);

}  // namespace voxtouch::mesh_import
