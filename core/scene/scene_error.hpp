#pragma once
/// Error of a scene file, with its place.
#include <filesystem>
#include <stdexcept>
#include <string>

namespace voxtouch::scene {

/// A place in a scene file. Line and column count from 1; 0: no place in the text.
struct SourcePlace {
  int line = 0, column = 0;
};

/// what() is `file:line:column: sentence`, or `file: sentence` if the file could not be read.
class SceneError : public std::runtime_error {
 public:
  /// `sentence` describes the error at `place` of `file`.
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
