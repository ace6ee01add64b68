#pragma once
/// A file that is written at the end of a long run.
#include <filesystem>
#include <fstream>
#include <string>

namespace voxtouch::cli {

/// Opens `<file>.part` at once, so that a folder that is not there is told before the run and not after it; keep() writes the text
/// and gives it its real name, so that a full disk leaves no half file under that. Without keep() nothing stays.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);  ///< throws std::runtime_error, a sentence
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() noexcept { return out_; }  ///< for a long text, before keep()
  void keep(const std::string& text = {});          ///< once; throws std::runtime_error, a sentence

 private:
  std::filesystem::path file_, fresh_;
  std::ofstream out_;
};

}  // namespace voxtouch::cli
