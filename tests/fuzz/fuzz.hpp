#pragma once
/// Common parts of the fuzz targets. A target is one file with LLVMFuzzerTestOneInput: foreign
/// bytes pass the project's reader and checks, and accepted values must keep its guarantees.
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

/// A condition for every accepted input. A failure ends the process, which libFuzzer reports.
#define FUZZ_REQUIRE(condition)                                 \
  do {                                                          \
    if (!(condition))                                           \
      ::voxtouch::fuzz::broken(#condition, __FILE__, __LINE__); \
  } while (false)

namespace voxtouch::fuzz {

[[noreturn]] inline void broken(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, condition);
  std::abort();
}

/// The input, consumed from its front. Beyond its end numbers are zero.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size)
      : left_(reinterpret_cast<const char*>(data), size) {}

  template <class T>
  T take() {
    T value{};
    const std::string_view front = take(sizeof value);
    std::memcpy(&value, front.data(), front.size());
    return value;
  }
  std::string_view take(std::size_t count) {
    const std::string_view front = left_.substr(0, count);
    left_.remove_prefix(front.size());
    return front;
  }
  std::string_view rest() const { return left_; }
  bool empty() const { return left_.empty(); }

 private:
  std::string_view left_;
};

/// A folder of this process for readers of files; removed with the process.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "voxtouch_fuzz_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      std::abort();
    path_ = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace voxtouch::fuzz
