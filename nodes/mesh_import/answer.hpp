#pragma once
/// What the reading process hands back, as plain bytes of this machine: a head of fixed size,
/// vertices, triangles, text. It takes the place of the mesh's bytes in the file in memory that
/// both processes have.
#include <string>
#include <string_view>

#include "core/mesh/import.hpp"

namespace voxtouch::mesh_import {

inline constexpr int kSharedFile = 3;  ///< its descriptor in the reading process
inline constexpr const char* kAsItIs =
    "as_it_is";  ///< the file is read without checks, and nothing of it handed back

std::string encode(const mesh::FileTriangles& read);
std::string encode_refusal(const std::string& sentence);

/// Throws MeshError with the refusal's sentence, and std::runtime_error where the bytes are no
/// whole answer, where a vertex is not finite or where a triangle names one that is not there.
mesh::FileTriangles decode(std::string_view answer);

}  // namespace voxtouch::mesh_import
