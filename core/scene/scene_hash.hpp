#pragma once
/// The name of a scene's content: equal where text and meshes are equal byte for byte, wherever the files stand.
#include <cstdint>
#include <string>
#include <string_view>

namespace voxtouch {

/// 64-bit FNV-1a over parts; each part's length goes in after it, so that no byte can wander from one part to the next. It
/// finds changes, it does not stop a forger.
class SceneHash {
 public:
  void add(std::string_view bytes) noexcept;
  std::string hex() const;  ///< 16 digits, lower case

 private:
  void mix(std::string_view bytes) noexcept;
  void close_part(std::uint64_t length) noexcept;
  std::uint64_t state_ = 0xcbf29ce484222325ULL;  // FNV offset basis
};

/// The same of one part alone.
std::string hash_of_bytes(std::string_view bytes);

}  // namespace voxtouch
