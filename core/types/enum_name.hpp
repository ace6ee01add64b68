#pragma once
/// Words for enumerators that count from 0, in both directions.
#include <array>
#include <cstddef>
#include <string_view>

namespace voxtouch {

/// The word of `value`, or `otherwise` if there is none. Real-time safe.
template <class Enum, std::size_t N>
constexpr std::string_view name_in(const std::array<std::string_view, N>& names, Enum value,
                                   std::string_view otherwise = "unknown") noexcept {
  const auto place = static_cast<std::size_t>(value);
  return place < N ? names[place] : otherwise;
}

/// The enumerator called `word`; false, with `value` unchanged, if there is none. Real-time safe.
template <class Enum, std::size_t N>
constexpr bool find_name(const std::array<std::string_view, N>& names, std::string_view word,
                         Enum& value) noexcept {
  for (std::size_t place = 0; place < N; ++place)
    if (names[place] == word)
      return value = static_cast<Enum>(place), true;
  return false;
}

}  // namespace voxtouch
