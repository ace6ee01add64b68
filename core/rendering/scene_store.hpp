#pragma once
/// Who keeps what was built, so that it need not be built again. The one on disk is in
/// nodes/scene_build.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace voxtouch::rendering {

/// What was kept. Empty where there is nothing.
struct Kept {
  std::unique_ptr<const char[]> memory;
  std::string_view content;  ///< within `memory`
};

class SceneStore {
 public:
  virtual ~SceneStore() = default;
  /// A name for bytes that nobody can make other bytes for.
  virtual std::string digest(std::string_view bytes) const = 0;
  /// What was kept under exactly this recipe, whole; null where it is not there or cannot be
  /// trusted. Does not throw.
  virtual Kept find(const std::string& recipe) = 0;
  /// `content` was found and is no scene. Does not throw.
  virtual void refuse(const std::string& recipe, const std::string& why) = 0;
  /// Does not throw: what cannot be kept is built again.
  virtual void keep(const std::string& recipe, std::string_view content) = 0;
  /// Larger content need not be offered.
  virtual std::uint64_t most_bytes() const noexcept = 0;
};

}  // namespace voxtouch::rendering
