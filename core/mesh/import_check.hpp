#pragma once
/// Checks a file before assimp reads it: whether its sizes are true, in cases in which assimp 5.2
/// would silently read another shape. It does not guarantee that assimp survives. Private to the
/// import.
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
  std::string bytes;      ///< input of assimp
  std::optional<std::uint64_t>
      faces;  ///< number of faces (of 3 or more corners) that the file must yield, if stated
  std::vector<std::string> warnings;
};

/// Throws MeshError: the file is shorter than it declares; `found` states the actual amount.
[[noreturn]] void refuse_truncated(const MeshFile& file, const std::string& found);

/// The file's `bytes`, checked for its format. Content that does not affect geometry may be
/// removed.
MeshFile open_mesh_file(const std::filesystem::path& path, std::string bytes);

/// Each checks what assimp does not check for its format, and throws MeshError with the remedy.
/// Content of glTF and COLLADA that does not affect geometry is removed.
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
