#include "core/types/version.hpp"

namespace voxtouch {

std::string_view version() noexcept { return VOXTOUCH_VERSION; }

}  // namespace voxtouch
