#pragma once
/// What a scene that cannot be read says for itself.
#include <filesystem>
#include <stdexcept>
#include <string>

namespace voxtouch::scene {

/// A place in a scene file; line and column count from 1, 0 where the fault has no place in the
/// text.
struct SourcePlace {
  int line = 0, column = 0;
};

/// what() is `file:line:column: sentence`, or `file: sentence` where the file could not be read at
/// all.
class SceneError : public std::runtime_error {
 public:
  /// About `place` of `file`; `sentence` says what is wrong there.
  SceneError(const std::filesystem::path& file, SourcePlace place, const std::string& sentence);
  const SourcePlace& place() const noexcept { return place_; }
  const std::string& sentence() const noexcept { return sentence_; }

 private:
  SourcePlace place_;
  std::string sentence_;
};

/// `file:line:column: sentence`, as SceneError and warnings write it.
std::string at_place(const std::filesystem::path& file, SourcePlace place,
                     const std::string& sentence);

}  // namespace voxtouch::scene
