#include "nodes/runtime/ros_parameters.hpp"

#include <string.h>

#include <algorithm>
#include <string_view>

#include "nodes/runtime/strings.hpp"

namespace voxtouch::runtime {
namespace {

enum : std::uint8_t {
  kNotSet,
  kBool,
  kInteger,
  kDouble,
  kString,
  kByteArray,
  kBoolArray,
  kIntegerArray,
  kDoubleArray
};

std::uint64_t parts_of(std::string_view name) {
  return static_cast<std::uint64_t>(std::ranges::count(name, '.'));
}

}  // namespace

const RosParameter* find_parameter(std::span<const RosParameter> all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &RosParameter::name);
  return found == all.end() ? nullptr : &*found;
}

ListedParameters list_parameters(std::span<const RosParameter> all,
                                 std::span<const std::string> prefixes, std::uint64_t depth) {
  ListedParameters listed;
  const auto is_below = [&](const std::string& name, const std::string& prefix) {
    if (name == prefix)
      return true;
    return name.starts_with(prefix + ".") &&
           (depth == 0 || parts_of(std::string_view(name).substr(prefix.size() + 1)) < depth);
  };
  for (const RosParameter& parameter : all) {
    const std::string& name = parameter.name;
    const bool is_requested = prefixes.empty()
                                  ? depth == 0 || parts_of(name) < depth
                                  : std::ranges::any_of(prefixes, [&](const std::string& prefix) {
                                      return is_below(name, prefix);
                                    });
    if (!is_requested)
      continue;
    listed.names.push_back(name);
    const std::size_t dot = name.rfind('.');
    if (dot != std::string::npos && !std::ranges::count(listed.prefixes, name.substr(0, dot)))
      listed.prefixes.push_back(name.substr(0, dot));
  }
  return listed;
}

std::uint8_t type_of(const ParameterValue& value) noexcept {
  constexpr std::uint8_t kTypes[] = {kNotSet, kBool, kInteger, kDouble, kString, kDoubleArray};
  return kTypes[value.index()];
}

msg::rcl_interfaces_ParameterValue ParameterMessages::value(const ParameterValue& value) {
  msg::rcl_interfaces_ParameterValue out{};
  out.type = type_of(value);
  out.string_value = const_cast<char*>("");
  if (const bool* one = std::get_if<bool>(&value))
    out.bool_value = *one;
  if (const auto* one = std::get_if<std::int64_t>(&value))
    out.integer_value = *one;
  if (const double* one = std::get_if<double>(&value))
    out.double_value = *one;
  if (const auto* one = std::get_if<std::string>(&value))
    out.string_value = lend(*one);
  if (const auto* many = std::get_if<std::vector<double>>(&value)) {
    out.double_array_value._buffer = const_cast<double*>(many->data());
    out.double_array_value._length = out.double_array_value._maximum =
        static_cast<std::uint32_t>(many->size());
  }
  return out;
}

msg::rcl_interfaces_Parameter ParameterMessages::parameter(const RosParameter& parameter) {
  return {lend(parameter.name), value(parameter.value)};
}

msg::rcl_interfaces_ParameterDescriptor ParameterMessages::descriptor(
    const RosParameter& parameter) {
  msg::rcl_interfaces_ParameterDescriptor out{};
  out.name = lend(parameter.name);
  out.type = type_of(parameter.value);
  out.description = lend(parameter.meaning);
  out.additional_constraints = lend(parameter.constraints);
  out.read_only = parameter.read_only;
  if (parameter.low == 0.0 && parameter.high == 0.0)
    return out;
  ranges_.push_back(std::make_unique<msg::rcl_interfaces_FloatingPointRange>(
      msg::rcl_interfaces_FloatingPointRange{parameter.low, parameter.high, 0.0}));
  out.floating_point_range._buffer = ranges_.back().get();
  out.floating_point_range._length = out.floating_point_range._maximum = 1;
  return out;
}

bool fits(const char* text) noexcept {
  constexpr std::size_t kMaxBytes = 1024;
  return text && ::strnlen(text, kMaxBytes + 1) <= kMaxBytes;
}

bool fits(const msg::rcl_interfaces_Parameter& parameter) noexcept {
  constexpr std::uint32_t kMax = 16;
  const msg::rcl_interfaces_ParameterValue& v = parameter.value;
  return fits(parameter.name) && fits(v.string_value) && v.byte_array_value._length <= kMax &&
         v.bool_array_value._length <= kMax && v.integer_array_value._length <= kMax &&
         v.double_array_value._length <= kMax && v.string_array_value._length <= kMax &&
         std::all_of(v.string_array_value._buffer,
                     v.string_array_value._buffer + v.string_array_value._length,
                     [](const char* text) { return fits(text); });
}

bool is_same(const ParameterValue& parameter, const msg::rcl_interfaces_ParameterValue& requested) {
  if (type_of(parameter) != requested.type)
    return false;
  if (const bool* one = std::get_if<bool>(&parameter))
    return *one == requested.bool_value;
  if (const auto* one = std::get_if<std::int64_t>(&parameter))
    return *one == requested.integer_value;
  if (const double* one = std::get_if<double>(&parameter))
    return *one == requested.double_value;
  if (const auto* one = std::get_if<std::string>(&parameter))
    return *one == requested.string_value;
  const auto& many = requested.double_array_value;
  const auto* own = std::get_if<std::vector<double>>(&parameter);
  return own && std::ranges::equal(*own, std::span(many._buffer, many._length));
}

}  // namespace voxtouch::runtime
