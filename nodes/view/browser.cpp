#include "nodes/view/browser.hpp"

#include <spawn.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

extern char** environ;

namespace voxtouch::view {
namespace {

bool is_set(const char* name) {
  const char* const value = std::getenv(name);
  return value && *value;
}

}  // namespace

void open_browser(const std::string& address) {
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY"))
    return;
  const std::filesystem::path folder =
      is_set("XDG_RUNTIME_DIR") ? std::getenv("XDG_RUNTIME_DIR") : "/tmp";
  std::string file = (folder / "voxtouch-XXXXXX.html").string();
  const int descriptor = ::mkstemps(file.data(), 5);  // readable by this user alone
  if (descriptor < 0)
    return;
  const std::string page = fmt::format(
      "<!DOCTYPE html><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" "
      "content=\"0;url={0}\"><a href=\"{0}\">voxtouch</a>\n",
      address);
  const bool written =
      ::write(descriptor, page.data(), page.size()) == static_cast<ssize_t>(page.size());
  ::close(descriptor);
  char program[] = "xdg-open";
  char* const argv[] = {program, file.data(), nullptr};
  pid_t pid = 0;
  if (written)
    (void)::posix_spawnp(&pid, program, nullptr, nullptr, argv, environ);
}

}  // namespace voxtouch::view
