#include "core/scene/scene_hash.hpp"

#include <fmt/core.h>

#include <fstream>
#include <vector>

namespace voxtouch {

void SceneHash::mix(std::string_view bytes) noexcept {
  constexpr std::uint64_t kPrime = 0x100000001b3ULL;
  for (const char c : bytes) state_ = (state_ ^ static_cast<unsigned char>(c)) * kPrime;
}

void SceneHash::close_part(std::uint64_t length) noexcept {
  char bytes[8];
  for (int i = 0; i < 8; ++i) bytes[i] = static_cast<char>((length >> (8 * i)) & 0xFFU);
  mix({bytes, sizeof bytes});
}

void SceneHash::add(std::string_view bytes) noexcept {
  mix(bytes);
  close_part(bytes.size());
}

bool SceneHash::add_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return false;
  std::vector<char> block(std::size_t{1} << 16);
  std::uint64_t length = 0;
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    mix({block.data(), static_cast<std::size_t>(in.gcount())});
    length += static_cast<std::uint64_t>(in.gcount());
  }
  close_part(length);
  return in.eof() && !in.bad();
}

std::string SceneHash::hex() const { return fmt::format("{:016x}", state_); }

}  // namespace voxtouch
