#pragma once
/// One file of the cache: head, recipe, content, and a checksum over all of it. What a file holds
/// is not trusted before that is right.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/rendering/scene_store.hpp"

namespace voxtouch::scene_build {

/// SHA-256, 32 bytes. Throws std::runtime_error where the library has none.
std::string sha256(std::initializer_list<std::string_view> parts);
/// Lower case.
std::string hex(std::string_view bytes);

/// Writes a file beside `file` and gives it that name once it is whole, so that whoever reads sees
/// all of it or none. Only this user may read it. Throws std::system_error.
void write_cache_file(const std::filesystem::path& file, std::string_view recipe,
                      std::string_view content);

/// What a file holds for this recipe. Null where there is no such file. Throws std::runtime_error,
/// the reason in words ("it is cut off"), where it is none of this user's alone, larger than
/// `most_bytes`, not whole, or of another layout or recipe. Marks it as used now.
rendering::Kept read_cache_file(const std::filesystem::path& file, std::string_view recipe,
                                std::uint64_t most_bytes);

/// Bytes of a file beside its content.
std::uint64_t overhead_bytes(std::string_view recipe) noexcept;

}  // namespace voxtouch::scene_build
