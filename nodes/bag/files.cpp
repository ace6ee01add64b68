#include "nodes/bag/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {
namespace {

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

/// Puts `temporary` in the place of `path`. A rename over a file makes ext4 write the new one to
/// the disk first, which takes 0.4 s on a busy disk. An exchange of the two names does not. In both
/// cases a reader finds the old or the new text.
bool replace(const std::string& temporary, const std::filesystem::path& path, Flush flush) {
  if (flush == Flush::kNo &&
      ::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, path.c_str(), RENAME_EXCHANGE) == 0)
    return ::unlink(temporary.c_str()) == 0;
  return ::rename(temporary.c_str(), path.c_str()) ==
         0;  // the first of its name, or a file system without exchange
}

}  // namespace

Result<void> write_atomically(const std::filesystem::path& path, std::string_view text,
                              Flush flush) {
  const std::string temporary = path.string() + ".tmp";
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  bool good = file >= 0 && write_all(file, text) && (flush == Flush::kNo || ::fsync(file) == 0);
  int error = errno;  // of the first call that failed
  if (file >= 0 && ::close(file) != 0 && good) {
    good = false;
    error = errno;
  }
  if (good && !replace(temporary, path, flush)) {
    good = false;
    error = errno;
  }
  if (good)
    return {};
  ::unlink(temporary.c_str());
  return refuse("Cannot write '{}': {}. Free disk space or choose another folder.", path.string(),
                std::strerror(error));
}

}  // namespace voxtouch::bag
