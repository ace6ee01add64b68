#pragma once
/// A hash of a scene's content: equal if text and meshes are equal byte for byte, at any path.
#include <cstdint>
#include <string>
#include <string_view>

#include "core/types/fnv.hpp"

namespace voxtouch::scene {

/// FNV-1a over parts. Each part is followed by its length, so that the split into parts matters.
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
