#pragma once
/// UTF-8 by characters.
#include <cstddef>
#include <string_view>

namespace voxtouch {

/// Length in bytes of the character at `i`; 0 if the bytes are not valid UTF-8 (including overlong
/// forms, surrogates, and values above U+10FFFF). Real-time safe.
constexpr std::size_t utf8_length(std::string_view s, std::size_t i) noexcept {
  const auto byte = [&](std::size_t k) -> unsigned {
    return k < s.size() ? static_cast<unsigned char>(s[k]) : 0U;
  };
  const unsigned lead = byte(i), next = byte(i + 1);
  if (lead < 0x80)
    return i < s.size() ? 1 : 0;
  std::size_t length = 0;
  if (lead >= 0xC2 && lead < 0xE0)
    length = 2;
  if (lead >= 0xE0 && lead < 0xF0)
    length = 3;
  if (lead >= 0xF0 && lead <= 0xF4)
    length = 4;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(i + k) & 0xC0U) != 0x80U)
      return 0;
  const bool overlong = (lead == 0xE0 && next < 0xA0) || (lead == 0xF0 && next < 0x90);
  const bool beyond = (lead == 0xED && next > 0x9F) || (lead == 0xF4 && next > 0x8F);
  return overlong || beyond ? 0 : length;
}

}  // namespace voxtouch
