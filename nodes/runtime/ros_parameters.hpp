#pragma once
/// Parameters of a ROS node as values and as messages. No DDS, nothing that waits.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::runtime {

/// As ROS tools give and take it; the first is what is not set.
using ParameterValue =
    std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<double>>;

struct RosParameter {
  std::string name;  ///< "friction.coulomb"; ".on" and ".gain" of each effect that takes them
  ParameterValue value;
  std::string meaning;           ///< a sentence, with the unit
  std::string constraints{};     ///< what no range says
  double low = 0.0, high = 0.0;  ///< of a number; none where both are 0
  bool read_only = false;
  std::string effect{}, parameter{};  ///< of which effect, and which of its parameters; empty:
                                      ///< switch and gain, and what is of the scene
  bool operator==(const RosParameter&) const = default;
};

/// Null where there is none of that name.
const RosParameter* find_parameter(std::span<const RosParameter> all, std::string_view name);

/// The names that `list_parameters` answers with, as rclcpp's nodes do: those below one of the
/// prefixes (below any, where there is none) with at most `depth` parts behind it (0: any), and the
/// prefixes of those names.
struct ListedParameters {
  std::vector<std::string> names, prefixes;
};
ListedParameters list_parameters(std::span<const RosParameter> all,
                                 std::span<const std::string> prefixes, std::uint64_t depth);

/// rcl_interfaces' number of a value's type.
std::uint8_t type_of(const ParameterValue& value) noexcept;

/// Messages that lend their texts from parameters, which outlive them.
class ParameterMessages {
 public:
  static msg::rcl_interfaces_ParameterValue value(const ParameterValue& value);
  static msg::rcl_interfaces_Parameter parameter(const RosParameter& parameter);
  /// Not `static`: the range lives here.
  msg::rcl_interfaces_ParameterDescriptor descriptor(const RosParameter& parameter);

 private:
  std::vector<std::unique_ptr<msg::rcl_interfaces_FloatingPointRange>> ranges_;
};

/// Whether lists and texts of requests are no longer than any that can be meant. In a thread of
/// DDS: allocates nothing.
bool fits(const char* text) noexcept;
bool fits(const msg::rcl_interfaces_Parameter& parameter) noexcept;

/// Whether setting `parameter` to this changes nothing.
bool is_same(const ParameterValue& parameter, const msg::rcl_interfaces_ParameterValue& asked);

}  // namespace voxtouch::runtime
