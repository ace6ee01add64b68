#pragma once
/// Presents the scene's effects as parameters of a ROS node and translates parameter requests. Uses
/// no DDS and does not block.
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

/// All parameters of a rendering of `scene` with the effect settings `effects`, sorted by name.
std::vector<RosParameter> parameters_of(const scene::Scene& scene,
                                        std::span<const effects::EffectSpec> effects);
/// A change requested by setting a parameter, in the fields of EffectChange. Owns the texts that
/// `message` refers to.
struct ParameterChange {
  std::uint32_t action = 0;
  std::string effect, parameter;
  double value[3] = {};
  /// The texts of the message refer to this object, which must outlive it.
  msg::EffectChange message() const;
};
/// Translates `requested`, or returns a sentence if the parameter does not accept its type or
/// number of values. The change validator checks whether the change can be applied; it also reports
/// unknown names.
std::expected<ParameterChange, std::string> change_of(
    std::span<const RosParameter> all, const msg::rcl_interfaces_Parameter& requested);

}  // namespace voxtouch::rendering_node
