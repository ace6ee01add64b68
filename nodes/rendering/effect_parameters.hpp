#pragma once
/// The scene's effects as parameters of a ROS node, and what setting one asks for. No DDS, nothing
/// that waits.
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"
#include "nodes/runtime/ros_parameters.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

using runtime::find_parameter, runtime::list_parameters, runtime::ListedParameters,
    runtime::ParameterMessages, runtime::ParameterValue, runtime::RosParameter, runtime::type_of;

/// All parameters of a rendering of `scene` whose effects are set as `effects` says, sorted by
/// name.
std::vector<RosParameter> parameters_of(const scene::Scene& scene,
                                        std::span<const effects::EffectSpec> effects);
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

}  // namespace voxtouch::rendering_node
