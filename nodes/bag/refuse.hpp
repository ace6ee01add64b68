#pragma once
/// Internal to nodes/bag: an error from a sentence with holes.
#include <fmt/format.h>

#include <utility>

#include "nodes/bag/error.hpp"

namespace voxtouch::bag {

template <class... Args>
std::unexpected<BagError> refuse(fmt::format_string<Args...> sentence, Args&&... args) {
  return std::unexpected(BagError{fmt::format(sentence, std::forward<Args>(args)...)});
}

}  // namespace voxtouch::bag
