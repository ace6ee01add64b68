#pragma once
/// What is made sure of before assimp sees a file: assimp 5.2 trusts counts, strides and nesting, and reads
/// past its buffers or overruns the stack where they lie. Private to the import.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/import.hpp"

namespace voxtouch::import {

struct MeshFile {
  std::filesystem::path path;
  std::string extension;                ///< lower case, without the dot
  std::string bytes;                    ///< what assimp will see
  std::optional<std::uint64_t> faces;   ///< faces (of 3 or more corners) that the file must yield, where it says so
  std::vector<std::string> warnings;
};

[[noreturn]] void refuse_size(const MeshFile& file, std::uint64_t triangles, const ImportOptions& options);
[[noreturn]] void refuse_truncated(const MeshFile& file, const std::string& found);

/// The file's `bytes`, checked for its format. Elements that play no part in geometry may be blanked out.
MeshFile open_mesh_file(const std::filesystem::path& path, std::string bytes, const ImportOptions& options);

void check_obj(MeshFile& file);
void check_stl(MeshFile& file, const ImportOptions& options);
void check_ply(MeshFile& file, const ImportOptions& options);
void check_gltf(MeshFile& file, const ImportOptions& options);
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

}  // namespace voxtouch::import
