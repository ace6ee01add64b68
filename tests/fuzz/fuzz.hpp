#pragma once
/// What the fuzz targets share. A target is one file with LLVMFuzzerTestOneInput: bytes from
/// outside go through the project's own reader and checks, and what these let through must keep
/// what is promised of it.
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

/// What must hold for every input that was let through. Ends the process, which is how libFuzzer
/// learns of it.
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

/// The input, taken from its front. Numbers that are not there any more are zero.
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

/// A folder of this process for readers that want a file; it goes with the process.
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
