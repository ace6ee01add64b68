#pragma once
/// The vendor's library, or the simulated one, found and loaded at run time. Building requires
/// neither.
#include <string>

#include "devices/phantom/hdapi.hpp"
#include "devices/phantom/simulated/hdsim.h"

namespace voxtouch::phantom {

/// Functions of the simulated library only; null for the vendor's.
// clang-format off
#define VOXTOUCH_HDSIM_HOOKS(X)                                                          \
  X(use_virtual_time) X(set_seed) X(set_model) X(set_motion) X(set_hand) X(set_switches) \
  X(step) X(inject) X(read_state) X(last_message)
// clang-format on
struct HdSimHooks {
#define VOXTOUCH_HDSIM_MEMBER(name) decltype(&hdsim_##name) name = nullptr;
  VOXTOUCH_HDSIM_HOOKS(VOXTOUCH_HDSIM_MEMBER)
#undef VOXTOUCH_HDSIM_MEMBER
  bool complete() const noexcept { return last_message != nullptr; }  ///< whether all of them exist
};

/// One per process, loaded until its end: the vendor's library does not support unloading and
/// reloading.
class HdLibrary {
 public:
  /// `path`: that file only. Empty: the library that is already loaded, otherwise the first of the
  /// usual names that the dynamic linker finds. Throws DeviceOpenError with all attempts and their
  /// errors, with the missing function, or with the name of another library that this process has
  /// loaded.
  static const HdLibrary& load(const std::string& path = {});

  const hd::Api& api() const noexcept { return api_; }
  const HdSimHooks& hooks() const noexcept { return hooks_; }
  const std::string& name() const noexcept { return name_; }  ///< as loaded

 private:
  HdLibrary() = default;
  std::string open(const std::string& file);  // empty, or the error

  std::string name_;
  hd::Api api_;
  HdSimHooks hooks_;
};

}  // namespace voxtouch::phantom
