#pragma once
/// Parameters of a ROS node as values and as messages. Uses no DDS and does not block.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::runtime {

/// The value types of ROS tools; the first means "not set".
using ParameterValue =
    std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>>;

struct RosParameter {
  std::string name;  ///< "friction.coulomb"; ".on" and ".gain" of each effect that has them
  ParameterValue value;
  std::string meaning;           ///< a sentence, with the unit
  std::string constraints{};     ///< constraints that a range cannot express
  double low = 0.0, high = 0.0;  ///< range of a number; no range if both are 0
  bool read_only = false;
  /// The effect and its parameter; empty for switch, gain and scene values.
  std::string effect{}, parameter{};
  bool operator==(const RosParameter&) const = default;
};

/// Null for an unknown name.
const RosParameter* find_parameter(std::span<const RosParameter> all, std::string_view name);

/// The reply to `list_parameters`, as nodes of rclcpp give it. It lists the names below one of the
/// prefixes (all names without prefixes), at most `depth` parts deep (0: any depth), and the
/// prefixes of these names.
struct ListedParameters {
  std::vector<std::string> names, prefixes;
};
ListedParameters list_parameters(std::span<const RosParameter> all,
                                 std::span<const std::string> prefixes, std::uint64_t depth);

/// Type number of a value in rcl_interfaces.
std::uint8_t type_of(const ParameterValue& value) noexcept;

/// Messages whose texts refer to parameters, which must outlive them.
class ParameterMessages {
 public:
  static msg::rcl_interfaces_ParameterValue value(const ParameterValue& value);
  static msg::rcl_interfaces_Parameter parameter(const RosParameter& parameter);
  /// Not `static`: this object holds the range.
  msg::rcl_interfaces_ParameterDescriptor descriptor(const RosParameter& parameter);

 private:
  std::vector<std::unique_ptr<msg::rcl_interfaces_FloatingPointRange>> ranges_;
};

/// Whether lists and texts of a request are within the size limits. Called in a thread of DDS:
/// allocates nothing.
bool fits(const char* text) noexcept;
bool fits(const msg::rcl_interfaces_Parameter& parameter) noexcept;

/// Whether setting `parameter` to this value changes nothing.
bool is_same(const ParameterValue& parameter, const msg::rcl_interfaces_ParameterValue& requested);

}  // namespace voxtouch::runtime
