#include "devices/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "core/types/number.hpp"
#include "devices/driver.hpp"

namespace voxtouch::devices {
namespace {

bool among(std::string_view key, std::initializer_list<std::string_view> keys) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

}  // namespace

DeviceSettings parse_settings(const std::vector<std::string>& texts) {
  DeviceSettings settings;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw DeviceOpenError(
          fmt::format("'{}' is not a device option; format KEY=VALUE, such as port=49938", text));
    settings.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return settings;
}

SettingReader::SettingReader(std::string_view device, const DeviceSettings& settings,
                             std::initializer_list<std::string_view> known,
                             std::initializer_list<std::string_view> many)
    : device_(device),
      settings_(settings) {
  std::set<std::string_view> seen;
  for (const auto& [key, value] : settings) {
    if (!among(key, known))
      throw DeviceOpenError(
          known.size() == 0
              ? fmt::format("device '{}' has no options (unknown option '{}')", device, key)
              : fmt::format("device '{}': unknown option '{}'. Valid options: {}", device, key,
                            fmt::join(known, ", ")));
    if (!seen.insert(key).second && !among(key, many))
      throw DeviceOpenError(fmt::format("device '{}': duplicate option {}", device, key));
  }
}

std::optional<std::string> SettingReader::text(std::string_view key) const {
  for (const auto& [name, value] : settings_)
    if (name == key)
      return value;
  return std::nullopt;
}

std::vector<std::string> SettingReader::all(std::string_view key) const {
  std::vector<std::string> values;
  for (const auto& [name, value] : settings_)
    if (name == key)
      values.push_back(value);
  return values;
}

void SettingReader::refuse(std::string_view key, std::string_view value,
                           std::string_view rule) const {
  throw DeviceOpenError(
      fmt::format("device '{}': option {} is '{}'; it must be {}", device_, key, value, rule));
}

template <class Number>
std::optional<Number> SettingReader::within(std::string_view key, Number low, Number high,
                                            std::string_view kind) const {
  const auto value = text(key);
  if (!value)
    return std::nullopt;
  const auto parsed = parse_number<Number>(*value);
  if (!parsed || !(*parsed >= low && *parsed <= high))
    refuse(key, *value, fmt::format("{} in [{}, {}]", kind, low, high));
  return *parsed;
}

std::optional<double> SettingReader::number(std::string_view key, double low, double high) const {
  return within(key, low, high, "a number");
}

std::optional<std::uint32_t> SettingReader::whole(std::string_view key, std::uint32_t low,
                                                  std::uint32_t high) const {
  return within(key, low, high, "an integer");
}

std::optional<Vec3> SettingReader::vector(std::string_view key) const {
  const auto value = text(key);
  if (!value)
    return std::nullopt;
  Vec3 out;
  std::string_view rest = *value;
  for (int axis = 0; axis < 3; ++axis) {
    const auto comma = rest.find(',');
    const auto number = parse_finite(rest.substr(0, comma));
    if (!number || (axis < 2) != (comma != std::string_view::npos))
      refuse(key, *value, "three finite numbers X,Y,Z");
    out[axis] = *number;
    if (axis < 2)
      rest.remove_prefix(comma + 1);
  }
  return out;
}

}  // namespace voxtouch::devices
