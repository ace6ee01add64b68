#pragma once
/// The vendor's library, or the simulated one, found and loaded at run time: nothing of it is
/// needed to build.
#include <string>

#include "devices/phantom/hdapi.hpp"
#include "devices/phantom/simulated/hdsim.h"

namespace voxtouch::phantom {

/// What only the simulated library has. Null in the vendor's.
// clang-format off
#define VOXTOUCH_HDSIM_HOOKS(X)                                                          \
  X(use_virtual_time) X(set_seed) X(set_model) X(set_motion) X(set_hand) X(set_switches) \
  X(step) X(inject) X(read_state) X(last_message)
// clang-format on
struct HdSimHooks {
#define VOXTOUCH_HDSIM_MEMBER(name) decltype(&hdsim_##name) name = nullptr;
  VOXTOUCH_HDSIM_HOOKS(VOXTOUCH_HDSIM_MEMBER)
#undef VOXTOUCH_HDSIM_MEMBER
  bool complete() const noexcept {
    return last_message != nullptr;
  }  ///< all of them are there, or none is
};

/// One a process, and for as long as it runs: the vendor's library does not survive being closed
/// and loaded again.
class HdLibrary {
 public:
  /// `path`: that file and no other. Empty: the library that is loaded already, or else the first
  /// of the usual names that the dynamic linker finds. Throws DeviceOpenError that lists what was
  /// tried and why it failed, that names the function that is missing, or that says which other
  /// library this process has loaded before.
  static const HdLibrary& load(const std::string& path = {});

  const hd::Api& api() const noexcept { return api_; }
  const HdSimHooks& hooks() const noexcept { return hooks_; }
  const std::string& name() const noexcept { return name_; }  ///< as it was loaded

 private:
  HdLibrary() = default;
  std::string open(const std::string& file);  // empty, or why not

  std::string name_;
  hd::Api api_;
  HdSimHooks hooks_;
};

}  // namespace voxtouch::phantom
