#pragma once
/// Which voxtouch this is.
#include <string_view>

namespace voxtouch {

/// "MAJOR.MINOR.PATCH" (semver.org), from the CMake project.
std::string_view version() noexcept;

}  // namespace voxtouch
