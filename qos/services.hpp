#pragma once
/// Table of services: name, type, server, purpose.
#include <string>
#include <string_view>

#include "qos/topics.hpp"

namespace voxtouch::qos {

/// One row. A node that serves it has it as /<rig>/<node>/<path>. Requests and replies have the
/// profile kService.
struct Service {
  std::string_view path;
  std::string_view type;  ///< "pkg/srv/Name"
  Nodes servers;
  std::string_view why;
};

inline constexpr Service kChangeEffect{"change_effect", "voxtouch_msgs/srv/ChangeEffect",
                                       kRendering, "An EffectChange with a reply to its sender."};
inline constexpr Service kListParameters{"list_parameters", "rcl_interfaces/srv/ListParameters",
                                         kEveryNode,
                                         "use_sim_time and settings of the node; of the rendering "
                                         "also gains, switches and values of effects."};
inline constexpr Service kGetParameters{"get_parameters", "rcl_interfaces/srv/GetParameters",
                                        kEveryNode, "Their values."};
inline constexpr Service kGetParameterTypes{
    "get_parameter_types", "rcl_interfaces/srv/GetParameterTypes", kEveryNode, "Their types."};
inline constexpr Service kDescribeParameters{"describe_parameters",
                                             "rcl_interfaces/srv/DescribeParameters", kEveryNode,
                                             "Their meaning, unit and range."};
inline constexpr Service kSetParameters{"set_parameters", "rcl_interfaces/srv/SetParameters",
                                        kEveryNode, "Changes, each validated separately."};
inline constexpr Service kSetParametersAtomically{
    "set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically", kEveryNode,
    "Changes that apply together in one sample, or not at all."};

inline constexpr Service kServices[] = {
    kChangeEffect,       kListParameters, kGetParameters,          kGetParameterTypes,
    kDescribeParameters, kSetParameters,  kSetParametersAtomically};

namespace detail {
inline std::string service_name(std::string_view prefix, const Service& service,
                                std::string_view rig, std::string_view node,
                                std::string_view suffix) {
  std::string name(prefix);
  return name.append(rig).append("/").append(node).append("/").append(service.path).append(suffix);
}
}  // namespace detail

/// "rq/haptic/rendering/get_parametersRequest"
inline std::string request_name(const Service& service, std::string_view rig,
                                std::string_view node) {
  return detail::service_name("rq/", service, rig, node, "Request");
}
/// "rr/haptic/rendering/get_parametersReply"
inline std::string reply_name(const Service& service, std::string_view rig, std::string_view node) {
  return detail::service_name("rr/", service, rig, node, "Reply");
}

}  // namespace voxtouch::qos
