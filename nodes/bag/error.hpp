#pragma once
/// What can go wrong with a bag, as a value.
#include <cstdint>
#include <expected>
#include <string>

namespace voxtouch::bag {

enum class BagFault : std::uint8_t {
  kExists,  ///< the folder is there already; nothing was touched
  kDisk,    ///< unwritable, full, unreadable: the operating system or sqlite says no
  kFormat,  ///< not a bag, or one of a kind that is not read here
  kNoSuchTopic,
  kBadMessage,  ///< the message cannot be stored or has no key
};

/// One sentence for a person: what happened, where, what to do.
struct BagError {
  BagFault fault = BagFault::kDisk;
  std::string sentence;
};

template <class T>
using Result = std::expected<T, BagError>;

}  // namespace voxtouch::bag
