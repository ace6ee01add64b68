#pragma once
/// A file that is written at the end of a long run.
#include <filesystem>
#include <fstream>
#include <string>

namespace voxtouch::cli {

/// Finds out at once whether `<file>.part` can be written, so that a folder that is not there is
/// reported before the run and not after it, and leaves nothing there: a run that is broken off
/// (Ctrl-C, a kill) leaves no file behind. keep() writes the text under that name and then gives it
/// its real one, so that a full disk leaves no half file under that.
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
