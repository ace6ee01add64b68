#pragma once
/// A file that is written at the end of a long run.
#include <filesystem>
#include <fstream>
#include <string>

namespace voxtouch::cli {

/// Checks at once whether `<file>.part` can be written, so that a missing folder is reported before
/// the run, and leaves no file. keep() writes the text under that name and then renames it. An
/// aborted run leaves no file, and a full disk no partial one.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);  ///< throws std::runtime_error, a sentence
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream();  ///< for a long text, before keep(); from now on there is a file
  void keep(const std::string& text = {});  ///< once; throws std::runtime_error, a sentence

 private:
  std::filesystem::path file_, fresh_;
  std::ofstream out_;
};

}  // namespace voxtouch::cli
