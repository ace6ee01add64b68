#pragma once
/// Settings of a device, read strictly: what is not known, doubled, or no value of its kind is refused with a sentence.
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/geometry.hpp"
#include "devices/device_options.hpp"

namespace voxtouch::devices {

/// "KEY=VALUE" in two. Throws DeviceOpenError where there is no '=' or nothing before it.
DeviceSettings parse_settings(const std::vector<std::string>& texts);

/// All functions throw DeviceOpenError that names device, key, value and rule.
class SettingReader {
 public:
  /// `known`: every key that this device takes. Those in `many` may come more than once.
  SettingReader(std::string_view device, const DeviceSettings& settings, std::initializer_list<std::string_view> known,
                std::initializer_list<std::string_view> many = {});

  /// Absent: the key was not given.
  std::optional<std::string> text(std::string_view key) const;
  std::optional<double> number(std::string_view key) const;        ///< finite
  std::optional<std::uint32_t> whole(std::string_view key) const;  ///< 0 or more
  std::optional<std::uint16_t> port(std::string_view key) const;   ///< 1 to 65535
  std::optional<Vec3> vector(std::string_view key) const;          ///< "X,Y,Z", finite
  std::vector<std::string> all(std::string_view key) const;        ///< of a key that may come more than once
  [[noreturn]] void refuse(std::string_view key, std::string_view value, std::string_view rule) const;

 private:
  std::string device_;
  const DeviceSettings& settings_;
};

}  // namespace voxtouch::devices
