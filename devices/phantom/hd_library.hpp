#pragma once
/// The vendor's library, or the simulated one, found and loaded at run time: nothing of it is needed to build.
#include <string>

#include "devices/phantom/hdapi.hpp"
#include "devices/phantom/simulated/hdsim.h"

namespace voxtouch {

/// What only the simulated library has. Null in the vendor's.
struct HdSimHooks {
  decltype(&hdsim_use_virtual_time) use_virtual_time = nullptr;
  decltype(&hdsim_step) step = nullptr;
  decltype(&hdsim_read_state) read_state = nullptr;
  decltype(&hdsim_last_message) last_message = nullptr;
  bool complete() const noexcept {
    return use_virtual_time != nullptr && step != nullptr && read_state != nullptr && last_message != nullptr;
  }
};

/// One a process, and for as long as it runs: the vendor's library does not survive being closed and loaded again.
class HdLibrary {
 public:
  /// `path`: that file and no other. Empty: the library that is loaded already, or else the first of the usual names that the
  /// dynamic linker finds. Throws DeviceOpenError that lists what was tried and why it failed, that names the function that is
  /// missing, or that says which other library this process has loaded before.
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

}  // namespace voxtouch
