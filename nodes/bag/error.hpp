#pragma once
/// What can go wrong with a bag, as a value.
#include <expected>
#include <string>

namespace voxtouch::bag {

/// One sentence for a person: what happened, where, what to do.
struct BagError {
  std::string sentence;
};

template <class T>
using Result = std::expected<T, BagError>;

}  // namespace voxtouch::bag
