#pragma once
#include <string_view>

namespace voxtouch::rendering {

/// Of all source that built parts depend on, how it was compiled, and how parts are kept: changes
/// with each of them, so that what another program built is never taken for what this one would
/// build. Worked out when this is compiled (deploy/cmake/builders_digest.cmake).
std::string_view builders_digest() noexcept;

}  // namespace voxtouch::rendering
