#pragma once
/// Settings of a device, read strictly: unknown and duplicate keys and invalid values are refused.
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/geometry.hpp"
#include "devices/device_options.hpp"

namespace voxtouch::devices {

/// Splits "KEY=VALUE". Throws DeviceOpenError without a '=' or a key.
DeviceSettings parse_settings(const std::vector<std::string>& texts);

/// All functions throw DeviceOpenError that names device, key, value and rule.
class SettingReader {
 public:
  /// `known`: every key of this device. Those in `many` may occur repeatedly.
  SettingReader(std::string_view device, const DeviceSettings& settings,
                std::initializer_list<std::string_view> known,
                std::initializer_list<std::string_view> many = {});

  /// Absent: the key was not given.
  std::optional<std::string> text(std::string_view key) const;
  /// The next two: from `low` to `high`, in the unit of the key's name.
  std::optional<double> number(std::string_view key, double low, double high) const;
  std::optional<std::uint32_t> whole(std::string_view key, std::uint32_t low,
                                     std::uint32_t high) const;
  std::optional<Vec3> vector(std::string_view key) const;    ///< "X,Y,Z", finite
  std::vector<std::string> all(std::string_view key) const;  ///< of a key that may occur repeatedly
  [[noreturn]] void refuse(std::string_view key, std::string_view value,
                           std::string_view rule) const;

 private:
  template <class Number>
  std::optional<Number> within(std::string_view key, Number low, Number high,
                               std::string_view kind) const;

  std::string device_;
  const DeviceSettings& settings_;
};

}  // namespace voxtouch::devices
