#pragma once
/// What is made sure of before assimp sees a file: that what it says of its own size is true, where
/// assimp 5.2 would make another shape of it without a word. Not that assimp survives it. Private
/// to the import.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/import.hpp"

namespace voxtouch::mesh::import {

struct MeshFile {
  std::filesystem::path path;
  std::string extension;  ///< lower case, without the dot
  std::string bytes;      ///< what assimp will see
  std::optional<std::uint64_t>
      faces;  ///< faces (of 3 or more corners) that the file must yield, where it says so
  std::vector<std::string> warnings;
};

/// Throws MeshError: the file ends before what it announces; `found` says how much there is.
[[noreturn]] void refuse_truncated(const MeshFile& file, const std::string& found);

/// The file's `bytes`, checked for its format. What plays no part in geometry may be left out of
/// them.
MeshFile open_mesh_file(const std::filesystem::path& path, std::string bytes);

/// Each checks what assimp does not for its format, and throws MeshError with the remedy. glTF and
/// COLLADA lose what plays no part in geometry.
void check_ply(const MeshFile& file);
void check_gltf(MeshFile& file);
void check_collada(MeshFile& file);

/// White space of the C locale, whatever the process's locale is.
inline bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
/// Splits at white space. `position` moves behind the word; empty at the end.
std::string_view next_word(std::string_view text, std::size_t& position);
/// Four bytes at `at`, lowest first; they must be there.
std::uint32_t little_u32(std::string_view bytes, std::size_t at);
/// The text with '?' for everything that is no plain character, for messages.
std::string printable(std::string_view text);
/// A whole number without sign; nothing else.
std::optional<std::uint64_t> whole_number(std::string_view word);

}  // namespace voxtouch::mesh::import
