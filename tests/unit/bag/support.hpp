#pragma once
/// Common parts of the bag tests: a temporary folder, messages of a known form, values of results.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <expected>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::bag::test {

/// An empty folder that is removed with the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "voxtouch_bag_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(path_, ignored);
  }
  std::filesystem::path operator/(const char* name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Little-endian CDR: header, session, sequence number, then `fill` bytes that depend on the
/// sequence number.
inline std::vector<std::byte> ring_message(std::uint64_t session, std::uint64_t sequence,
                                           std::size_t fill = 32) {
  std::vector<std::byte> bytes(4 + 16 + fill);
  bytes[1] = std::byte{1};
  std::memcpy(bytes.data() + 4, &session, 8);
  std::memcpy(bytes.data() + 12, &sequence, 8);
  for (std::size_t i = 0; i < fill; ++i)
    bytes[20 + i] = static_cast<std::byte>(sequence * 31 + i);
  return bytes;
}

/// The same, with incompressible content.
inline std::vector<std::byte> noisy_message(std::uint64_t session, std::uint64_t sequence,
                                            std::size_t fill) {
  std::vector<std::byte> bytes = ring_message(session, sequence, fill);
  std::uint64_t state = sequence + 1;
  for (std::size_t i = 20; i < bytes.size(); ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    bytes[i] = static_cast<std::byte>(state >> 56);
  }
  return bytes;
}

/// The value; without one the test ends with the error's sentence.
template <class T, class Error>
T expect_value(std::expected<T, Error>&& result) {
  if (!result)
    throw std::runtime_error(result.error().sentence);
  return std::move(*result);
}

/// Whether there is none, and the error's sentence has these words.
template <class T, class Error>
bool says(const std::expected<T, Error>& result, std::string_view words) {
  return !result && result.error().sentence.contains(words);
}

}  // namespace voxtouch::bag::test

#define EXPECT_GOOD(expression)                               \
  do {                                                        \
    const auto& good_result = (expression);                   \
    EXPECT_TRUE(good_result) << good_result.error().sentence; \
  } while (false)
