#pragma once
/// Requests of the rendering's services as messages that can be read from the wire alone.
#include "voxtouch_msgs/services.hpp"

namespace voxtouch::msg {

template <class Service>
struct RequestType {
  static constexpr const dds_topic_descriptor_t* descriptor = Service::request.descriptor;
  static constexpr std::string_view ros_name = Service::request.ros_name;
};
template <>
struct Type<ChangeEffect::Request> : RequestType<ChangeEffect> {};
template <>
struct Type<rcl_interfaces_ListParameters::Request> : RequestType<rcl_interfaces_ListParameters> {};
template <>
struct Type<rcl_interfaces_GetParameters::Request> : RequestType<rcl_interfaces_GetParameters> {};
template <>
struct Type<rcl_interfaces_GetParameterTypes::Request>
    : RequestType<rcl_interfaces_GetParameterTypes> {};
template <>
struct Type<rcl_interfaces_DescribeParameters::Request>
    : RequestType<rcl_interfaces_DescribeParameters> {};
template <>
struct Type<rcl_interfaces_SetParameters::Request> : RequestType<rcl_interfaces_SetParameters> {};
template <>
struct Type<rcl_interfaces_SetParametersAtomically::Request>
    : RequestType<rcl_interfaces_SetParametersAtomically> {};

}  // namespace voxtouch::msg

namespace voxtouch::fuzz {

/// The first byte of each request in an input.
enum class Asked : unsigned char { kList, kGet, kTypes, kDescribe, kSet, kSetTogether, kChange };
constexpr int kKindsOfRequests = 7;

}  // namespace voxtouch::fuzz
