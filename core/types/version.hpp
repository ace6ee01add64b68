#pragma once
/// Which voxtouch this is.
#include <string_view>

namespace voxtouch {

/// "MAJOR.MINOR.PATCH" (semver.org): the version of the CMake project, which is the one place where
/// it stands.
std::string_view version() noexcept;

}  // namespace voxtouch
