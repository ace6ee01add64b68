#pragma once
/// For the files that write the table of keys down, one row a key.
#include <algorithm>
#include <array>

#include "core/scene/keys.hpp"

namespace voxtouch::scene::keys {

using enum KeyKind;
using enum KeyRule;

/// The rows of both, those of `first` before.
template <std::size_t N, std::size_t M>
constexpr std::array<Key, N + M> joined(const std::array<Key, N>& first,
                                        const std::array<Key, M>& second) {
  std::array<Key, N + M> out;
  std::copy(second.begin(), second.end(), std::copy(first.begin(), first.end(), out.begin()));
  return out;
}

}  // namespace voxtouch::scene::keys
