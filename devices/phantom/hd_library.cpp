#include "devices/phantom/hd_library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <mutex>
#include <string_view>
#include <vector>

#include "devices/driver.hpp"

namespace voxtouch::phantom {
namespace {

// The development name, which every release installs, and the run-time names of releases 3.4 and
// 3.0.
const std::vector<std::string>& usual_names() {
  static const std::vector<std::string> names = {"libHD.so", "libHD.so.3.4", "libHD.so.3.0"};
  return names;
}

HdSimHooks find_hooks(void* library) {
  HdSimHooks hooks;
  bool all = true;
#define VOXTOUCH_HDSIM_FIND(name)                                                      \
  hooks.name = reinterpret_cast<decltype(hooks.name)>(dlsym(library, "hdsim_" #name)); \
  all = all && hooks.name != nullptr;
  VOXTOUCH_HDSIM_HOOKS(VOXTOUCH_HDSIM_FIND)
#undef VOXTOUCH_HDSIM_FIND
  return all ? hooks : HdSimHooks{};
}

}  // namespace

/// Global: the vendor's library resolves symbols of its device drivers globally.
std::string HdLibrary::open(const std::string& file) {
  void* const library = dlopen(file.c_str(), RTLD_LAZY | RTLD_GLOBAL);
  if (library == nullptr) {
    const char* const reason = dlerror();
    return reason != nullptr ? reason : "no reason given";
  }
  const std::string_view missing =
      hd::resolve_api(api_, [library](const char* function) { return dlsym(library, function); });
  if (!missing.empty())
    return fmt::format("{} has no function {}: it is not an HDAPI library", file, missing);
  hooks_ = find_hooks(library);
  name_ = file;
  return {};
}

const HdLibrary& HdLibrary::load(const std::string& path) {
  static std::mutex mutex;
  // Never unloaded: its functions are called until the process ends.
  static const HdLibrary* loaded = nullptr;
  const std::lock_guard lock(mutex);
  if (loaded != nullptr) {
    if (path.empty() || path == loaded->name_)
      return *loaded;
    throw devices::DeviceOpenError(
        fmt::format("device 'phantom': this process has loaded {} and cannot switch to {}. Start "
                    "another process",
                    loaded->name_, path));
  }
  std::vector<std::string> reasons;
  for (const std::string& file : path.empty() ? usual_names() : std::vector<std::string>{path}) {
    HdLibrary candidate;
    const std::string reason = candidate.open(file);
    if (reason.empty())
      return *(loaded = new HdLibrary(std::move(candidate)));
    reasons.push_back(reason);
  }
  throw devices::DeviceOpenError(
      fmt::format("device 'phantom': cannot load the vendor's library ({}). Install OpenHaptics "
                  "and the device's driver, or set option library (simulated: libHD_sim.so)",
                  fmt::join(reasons, "; ")));
}

}  // namespace voxtouch::phantom
