#include "nodes/console/reason.hpp"

#include <unistd.h>

#include <cerrno>
#include <climits>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

namespace voxtouch::console {
namespace {

constexpr std::size_t kMaxPrinted = 64;  ///< of a path

std::string shortened(const std::string& path) {
  return path.size() <= kMaxPrinted ? path : path.substr(0, kMaxPrinted) + "...";
}

bool current_folder_is_gone() {
  char folder[PATH_MAX];
  return getcwd(folder, sizeof folder) == nullptr && errno == ENOENT;
}

std::string_view remedy_for(const std::filesystem::filesystem_error& error) {
  if (error.path1().string().starts_with("/proc/"))
    return ": mount /proc (proc(5))";
  if (current_folder_is_gone())
    return ": the current folder is deleted; change to another one";
  return "";
}

}  // namespace

std::string reason_of(const std::exception& error) {
  if (const auto* files = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return fmt::format("'{}': {}{}", shortened(files->path1().string()), files->code().message(),
                       remedy_for(*files));
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  if (system && system->code() == std::errc::resource_unavailable_try_again)
    return "the system refused a new thread: raise the process limit (`ulimit -u`) or pids.max of "
           "the container";
  if (dynamic_cast<const std::bad_alloc*>(&error))
    return "out of memory";
  return error.what();
}

}  // namespace voxtouch::console
