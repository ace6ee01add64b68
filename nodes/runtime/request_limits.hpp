#pragma once
/// Size limits of requests, checked by DDS when a request arrives. They exceed every valid request.
/// Called in a thread of DDS: allocates nothing.
#include <algorithm>
#include <cstdint>
#include <span>

#include "nodes/runtime/ros_parameters.hpp"
#include "voxtouch_msgs/services.hpp"

namespace voxtouch::runtime {

constexpr std::uint32_t kMaxChanges = 64, kMaxNames = 256;

template <class Sequence>
auto all_of(const Sequence& sequence) {
  return std::span(sequence._buffer, sequence._length);
}

template <class Texts>
bool texts_fit(const Texts& texts) {
  return texts._length <= kMaxNames &&
         std::ranges::all_of(all_of(texts), [](const char* text) { return fits(text); });
}
template <class Request>
bool names_fit(const Request& request) {
  return texts_fit(request.names);
}
inline bool prefixes_fit(const msg::rcl_interfaces_ListParameters::Request& request) {
  return texts_fit(request.prefixes);
}
template <class Request>
bool parameters_fit(const Request& request) {
  return request.parameters._length <= kMaxChanges &&
         std::ranges::all_of(all_of(request.parameters),
                             [](const auto& parameter) { return fits(parameter); });
}
inline bool change_fits(const msg::ChangeEffect::Request& request) {
  return fits(request.effect) && fits(request.parameter) && fits(request.model);
}

}  // namespace voxtouch::runtime
