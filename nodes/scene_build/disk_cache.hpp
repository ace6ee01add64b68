#pragma once
/// Built scenes in a folder of the user's, each a file under a name made of all that it depends on.
/// Several programs may use it at once: a file is there as a whole or not at all, and which of two
/// that build the same comes last is the same.
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/rendering/scene_store.hpp"

namespace voxtouch::scene_build {

/// `$XDG_CACHE_HOME/voxtouch/scenes`, else `~/.cache/voxtouch/scenes`; empty where there is
/// neither.
std::filesystem::path cache_folder();

/// One thread at a time. Whatever goes wrong is told once and costs no more than building.
class DiskCache final : public rendering::SceneStore {
 public:
  /// `who` begins what is told. `most_bytes`: of all files together; where they are more, those
  /// used longest ago go.
  DiskCache(std::filesystem::path folder, std::uint64_t most_bytes, std::string who);

  std::string digest(std::string_view bytes) const override;
  rendering::Kept find(const std::string& recipe) override;
  void refuse(const std::string& recipe, const std::string& why) override;
  void keep(const std::string& recipe, std::string_view content) override;
  std::uint64_t most_bytes() const noexcept override { return most_bytes_; }

  /// Where what was built by `recipe` is kept, or would be.
  std::filesystem::path file_of(const std::string& recipe) const;

 private:
  /// Leaves `newest` alone.
  void forget_oldest(const std::filesystem::path& newest) const;

  std::filesystem::path folder_;
  std::uint64_t most_bytes_;
  std::string who_;
};

}  // namespace voxtouch::scene_build
