#pragma once
/// The name of a scene's content: equal where text and meshes are equal byte for byte, wherever the
/// files stand.
#include <cstdint>
#include <string>
#include <string_view>

#include "core/types/fnv.hpp"

namespace voxtouch::scene {

/// FNV-1a over parts; each part's length goes in after it, so that no byte can wander from one part
/// to the next.
class SceneHash {
 public:
  /// One part more. Real-time safe.
  void add(std::string_view bytes) noexcept;
  std::string hex() const;  ///< 16 digits, lower case

 private:
  void close_part(std::uint64_t length) noexcept;
  Fnv1a hash_;
};

}  // namespace voxtouch::scene
