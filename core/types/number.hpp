#pragma once
/// Numbers out of text: the one strict reader for files, options and the wire.
#include <charconv>
#include <cmath>
#include <expected>
#include <optional>
#include <string_view>
#include <system_error>

namespace voxtouch {

/// `text` as a `Number`, where the whole of it is one: no blanks, no '+', no locale, so that 0.5 is
/// a half everywhere. A floating-point number may be "inf" or "nan". Else the reason:
/// `result_out_of_range` where it is a number but does not fit, `invalid_argument` for all else.
/// Real-time safe.
template <class Number>
std::expected<Number, std::errc> parse_number(std::string_view text) noexcept {
  Number value{};
  const char* const last = text.data() + text.size();
  const auto [end, fault] = std::from_chars(text.data(), last, value);
  if (end != last || fault == std::errc::invalid_argument)
    return std::unexpected(std::errc::invalid_argument);
  if (fault != std::errc())
    return std::unexpected(fault);
  return value;
}

/// The same for a finite double; nothing where it is none.
inline std::optional<double> parse_finite(std::string_view text) noexcept {
  const auto value = parse_number<double>(text);
  return value && std::isfinite(*value) ? std::optional(*value) : std::nullopt;
}

}  // namespace voxtouch
