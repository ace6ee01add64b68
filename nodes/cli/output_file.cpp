#include "nodes/cli/output_file.hpp"

#include <stdexcept>

#include <fmt/format.h>

namespace voxtouch::cli {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw std::runtime_error(fmt::format(
      "Cannot write {}. Check that its folder exists, the free space and the permissions",
      file.string()));
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path file)
    : file_(std::move(file)),
      fresh_(file_.string() + ".part") {
  out_.open(fresh_, std::ios::binary);
  const bool failed = !out_ || std::filesystem::is_directory(file_);
  out_.close();
  out_.clear();
  std::error_code ignored;
  std::filesystem::remove(fresh_, ignored);
  if (failed)
    refuse(file_);
}

OutputFile::~OutputFile() {
  if (!out_.is_open())
    return;
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(fresh_, ignored);
}

std::ostream& OutputFile::stream() {
  if (!out_.is_open())
    out_.open(fresh_, std::ios::binary);
  return out_;
}

void OutputFile::keep(const std::string& text) {
  stream() << text;
  out_.close();
  std::error_code failed;
  if (out_)
    std::filesystem::rename(fresh_, file_, failed);
  if (!out_ || failed) {
    std::filesystem::remove(fresh_, failed);
    refuse(file_);
  }
}

}  // namespace voxtouch::cli
