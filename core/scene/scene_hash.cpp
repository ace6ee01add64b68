#include "core/scene/scene_hash.hpp"

#include <fmt/core.h>

namespace voxtouch::scene {

void SceneHash::close_part(std::uint64_t length) noexcept {
  char bytes[8];
  for (int i = 0; i < 8; ++i)
    bytes[i] = static_cast<char>((length >> (8 * i)) & 0xFFU);
  hash_.add({bytes, sizeof bytes});
}

void SceneHash::add(std::string_view bytes) noexcept {
  hash_.add(bytes);
  close_part(bytes.size());
}

std::string SceneHash::hex() const { return fmt::format("{:016x}", hash_.value()); }

}  // namespace voxtouch::scene
