#pragma once
#include <cstddef>

namespace voxtouch::hard {

/// Bytes that this thread has asked `new` for so far. Linking allocated.cpp replaces `new` for the whole program.
std::size_t allocated_here() noexcept;

}  // namespace voxtouch::hard
