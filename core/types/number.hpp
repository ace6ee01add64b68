#pragma once
/// Numbers out of text: the one strict reader for files, options and the wire.
#include <charconv>
#include <cmath>
#include <expected>
#include <optional>
#include <string_view>
#include <system_error>

namespace voxtouch {

/// Parses `text` as a `Number`: the whole text, without blanks, '+' or locale. A floating-point
/// number may be "inf" or "nan". Otherwise the error: `result_out_of_range` for a number that does
/// not fit, `invalid_argument` for all else. Real-time safe.
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

/// The same for a finite double; empty for any other text.
inline std::optional<double> parse_finite(std::string_view text) noexcept {
  const auto value = parse_number<double>(text);
  return value && std::isfinite(*value) ? std::optional(*value) : std::nullopt;
}

}  // namespace voxtouch
