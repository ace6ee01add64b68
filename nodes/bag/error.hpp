#pragma once
/// Errors of bags, as values.
#include <expected>
#include <string>

namespace voxtouch::bag {

/// One sentence: what happened, where, what to do.
struct BagError {
  std::string sentence;
};

template <class T>
using Result = std::expected<T, BagError>;

}  // namespace voxtouch::bag
