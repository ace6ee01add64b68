#include "nodes/rendering/effect_parameters.hpp"

#include <fmt/format.h>
#include <string.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

using namespace msg::effect_change;
using effects::EffectParameter;
using effects::ParameterShape;

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

/// ROS has no range without an end.
double finite_end(double high) {
  return std::isinf(high) ? std::numeric_limits<double>::max() : high;
}

std::string word_at(const EffectParameter& parameter, double place) {
  std::string_view words = parameter.words;
  for (auto n = static_cast<int>(place); n > 0; --n)
    words.remove_prefix(words.find(' ') + 1);
  return std::string(words.substr(0, words.find(' ')));
}

RosParameter parameter_of(const effects::EffectSpec& effect, const EffectParameter& parameter,
                          const std::array<double, 3>& value) {
  RosParameter out{.name = fmt::format("{}.{}", effect.name, parameter.name),
                   .value = {},
                   .meaning = std::string(parameter.meaning),
                   .effect = effect.name,
                   .parameter = std::string(parameter.name)};
  switch (parameter.shape) {
    case ParameterShape::kNumber:
      out.value = value[0], out.low = parameter.low, out.high = finite_end(parameter.high);
      break;
    case ParameterShape::kVector:
      out.value = std::vector(value.begin(), value.end());
      out.constraints = fmt::format(
          "Three numbers; their vector's length is {:g}{}.", parameter.low,
          std::isinf(parameter.high) ? " at least" : fmt::format(" to {:g}", parameter.high));
      break;
    case ParameterShape::kDirection:
      out.value = std::vector(value.begin(), value.end());
      out.constraints = "Three numbers, not all 0: they are brought to unit length.";
      break;
    case ParameterShape::kWord:
      out.value = word_at(parameter, value[0]), out.read_only = true;
      out.constraints = fmt::format("One of: {}. It cannot change while running.", parameter.words);
      break;
    case ParameterShape::kText:
      out.value = effect.text, out.read_only = true;
      out.constraints = "It cannot change while running.";
      break;
  }
  return out;
}

void add_effect(std::vector<RosParameter>& all, const effects::EffectSpec& effect) {
  if (!effect.kind->everywhere) {
    all.push_back({.name = effect.name + ".on",
                   .value = effect.on,
                   .meaning = "Whether the effect is felt: " + std::string(effect.kind->says),
                   .effect = effect.name});
    all.push_back({.name = effect.name + ".gain",
                   .value = effect.gain,
                   .meaning = "Share of the effect that is felt [1].",
                   .low = 0.0,
                   .high = 1.0,
                   .effect = effect.name});
  }
  for (std::size_t n = 0; n < effect.kind->parameters.size(); ++n)
    all.push_back(parameter_of(effect, effect.kind->parameters[n], effect.values.at(n)));
}

/// The numbers of a value that is one or three; empty: it is none.
std::vector<double> numbers_of(const msg::rcl_interfaces_ParameterValue& value) {
  switch (value.type) {
    case kInteger:
      return {static_cast<double>(value.integer_value)};
    case kDouble:
      return {value.double_value};
    case kIntegerArray:
      return {value.integer_array_value._buffer,
              value.integer_array_value._buffer + value.integer_array_value._length};
    case kDoubleArray:
      return {value.double_array_value._buffer,
              value.double_array_value._buffer + value.double_array_value._length};
    default:
      return {};
  }
}

std::uint64_t parts_of(std::string_view name) {
  return static_cast<std::uint64_t>(std::ranges::count(name, '.'));
}

}  // namespace

std::vector<RosParameter> parameters_of(const scene::Scene& scene,
                                        std::span<const effects::EffectSpec> effects) {
  std::vector<RosParameter> all{{.name = "scene",
                                 .value = scene.name,
                                 .meaning = "Name of the scene that runs.",
                                 .read_only = true},
                                {.name = "voxel_size_m",
                                 .value = scene.voxel_size_m,
                                 .meaning = "Edge of a voxel [m].",
                                 .read_only = true},
                                {.name = "contact_model",
                                 .value = scene.contact.model,
                                 .meaning = "How forces of the contact are found.",
                                 .read_only = true}};
  for (const effects::EffectSpec& effect : effects)
    add_effect(all, effect);
  std::ranges::sort(all, {}, &RosParameter::name);
  return all;
}

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
    const bool is_wanted = prefixes.empty()
                               ? depth == 0 || parts_of(name) < depth
                               : std::ranges::any_of(prefixes, [&](const std::string& prefix) {
                                   return is_below(name, prefix);
                                 });
    if (!is_wanted)
      continue;
    listed.names.push_back(name);
    const std::size_t dot = name.rfind('.');
    if (dot != std::string::npos && !std::ranges::count(listed.prefixes, name.substr(0, dot)))
      listed.prefixes.push_back(name.substr(0, dot));
  }
  return listed;
}

msg::EffectChange ParameterChange::message() const {
  msg::EffectChange m{};
  m.action = action;
  m.effect = runtime::lend(effect), m.parameter = runtime::lend(parameter),
  m.model = const_cast<char*>("");
  std::ranges::copy(value, m.value);
  return m;
}

std::expected<ParameterChange, std::string> change_of(std::span<const RosParameter> all,
                                                      const msg::rcl_interfaces_Parameter& asked) {
  const std::string name = asked.name ? asked.name : "";
  const RosParameter* const known = find_parameter(all, name);
  const std::size_t dot = name.rfind('.');
  if (known ? known->effect.empty() : dot == std::string::npos) {
    if (known)
      return std::unexpected(
          fmt::format("'{}' is of the scene and cannot change while running; `voxtouch change "
                      "--reload` reads another",
                      name));
    return std::unexpected(
        fmt::format("there is no parameter '{}'; parameters are called as EFFECT.on, EFFECT.gain "
                    "or EFFECT.PARAMETER",
                    effects::quotable(name)));
  }
  ParameterChange change{.action = kActionValue,
                         .effect = known ? known->effect : name.substr(0, dot),
                         .parameter = known ? known->parameter : name.substr(dot + 1)};
  const bool is_switch =
      known ? std::holds_alternative<bool>(known->value) : change.parameter == "on";
  if (is_switch || (known ? known->parameter.empty() : change.parameter == "gain")) {
    change.action = is_switch ? kActionSwitch : kActionGain;
    change.parameter.clear();
  }
  if (change.action == kActionSwitch) {
    if (asked.value.type != kBool)
      return std::unexpected(fmt::format("'{}' takes true or false", effects::quotable(name)));
    change.value[0] = asked.value.bool_value ? 1.0 : 0.0;
    return change;
  }
  if (known && known->read_only)
    return change;  // judged, and refused, by whoever makes changes
  const std::vector<double> numbers = numbers_of(asked.value);
  const std::size_t count =
      known && std::holds_alternative<std::vector<double>>(known->value) ? 3 : 1;
  if (known && numbers.size() != count)
    return std::unexpected(
        fmt::format("'{}' takes {}", name, count == 3 ? "three numbers" : "a number"));
  std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 3), change.value);
  return change;
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
    out.string_value = runtime::lend(*one);
  if (const auto* many = std::get_if<std::vector<double>>(&value)) {
    out.double_array_value._buffer = const_cast<double*>(many->data());
    out.double_array_value._length = out.double_array_value._maximum =
        static_cast<std::uint32_t>(many->size());
  }
  return out;
}

msg::rcl_interfaces_Parameter ParameterMessages::parameter(const RosParameter& parameter) {
  return {runtime::lend(parameter.name), value(parameter.value)};
}

msg::rcl_interfaces_ParameterDescriptor ParameterMessages::descriptor(
    const RosParameter& parameter) {
  msg::rcl_interfaces_ParameterDescriptor out{};
  out.name = runtime::lend(parameter.name);
  out.type = type_of(parameter.value);
  out.description = runtime::lend(parameter.meaning);
  out.additional_constraints = runtime::lend(parameter.constraints);
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

}  // namespace voxtouch::rendering_node
