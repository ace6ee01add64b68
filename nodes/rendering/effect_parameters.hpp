#pragma once
/// The scene's effects as parameters of a ROS node, and what setting one asks for. No DDS, nothing
/// that waits.
#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/scene/scene.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

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

/// All parameters of a rendering of `scene` whose effects are set as `effects` says, sorted by
/// name.
std::vector<RosParameter> parameters_of(const scene::Scene& scene,
                                        std::span<const effects::EffectSpec> effects);
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

/// A change that setting a parameter asks for, in the words of EffectChange. Keeps the texts that
/// `message` lends.
struct ParameterChange {
  std::uint32_t action = 0;
  std::string effect, parameter;
  double value[3] = {};
  /// Lends its texts from this change, which outlives it.
  msg::EffectChange message() const;
};
/// What `asked` means, or a sentence where its type or number of values is none that the parameter
/// takes. Whether the change can be made is judged by whoever makes it, who also has the sentence
/// for a name that there is not.
std::expected<ParameterChange, std::string> change_of(std::span<const RosParameter> all,
                                                      const msg::rcl_interfaces_Parameter& asked);

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

}  // namespace voxtouch::rendering_node
