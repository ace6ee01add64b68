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

enum : std::uint8_t { kBool = 1, kInteger = 2, kDouble = 3, kIntegerArray = 7, kDoubleArray = 8 };

/// A ROS range requires finite ends.
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
          "Three numbers; norm {:g}{}.", parameter.low,
          std::isinf(parameter.high) ? " or more" : fmt::format(" to {:g}", parameter.high));
      break;
    case ParameterShape::kDirection:
      out.value = std::vector(value.begin(), value.end());
      out.constraints = "Three numbers, not all 0; normalised to unit length.";
      break;
    case ParameterShape::kWord:
      out.value = word_at(parameter, value[0]), out.read_only = true;
      out.constraints = fmt::format("One of: {}. Read-only while running.", parameter.words);
      break;
    case ParameterShape::kText:
      out.value = effect.text, out.read_only = true;
      out.constraints = "Read-only while running.";
      break;
  }
  return out;
}

void add_effect(std::vector<RosParameter>& all, const effects::EffectSpec& effect) {
  if (!effect.kind->everywhere) {
    all.push_back({.name = effect.name + ".on",
                   .value = effect.on,
                   .meaning = "Effect on or off: " + std::string(effect.kind->summary),
                   .effect = effect.name});
    all.push_back({.name = effect.name + ".gain",
                   .value = effect.gain,
                   .meaning = "Gain of the effect, 0 to 1 [1].",
                   .low = 0.0,
                   .high = 1.0,
                   .effect = effect.name});
  }
  for (std::size_t n = 0; n < effect.kind->parameters.size(); ++n)
    all.push_back(parameter_of(effect, effect.kind->parameters[n], effect.values.at(n)));
}

/// The numbers of a value with one or three of them; empty for any other value.
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

}  // namespace

std::vector<RosParameter> parameters_of(const scene::Scene& scene,
                                        std::span<const effects::EffectSpec> effects) {
  std::vector<RosParameter> all{{.name = "scene",
                                 .value = scene.name,
                                 .meaning = "Name of the running scene.",
                                 .read_only = true},
                                {.name = "voxel_size_m",
                                 .value = scene.voxel_size_m,
                                 .meaning = "Edge of a voxel [m].",
                                 .read_only = true},
                                {.name = "contact_model",
                                 .value = scene.contact.model,
                                 .meaning = "Contact model.",
                                 .read_only = true}};
  for (const effects::EffectSpec& effect : effects)
    add_effect(all, effect);
  std::ranges::sort(all, {}, &RosParameter::name);
  return all;
}

msg::EffectChange ParameterChange::message() const {
  msg::EffectChange m{};
  m.action = action;
  m.effect = runtime::lend(effect), m.parameter = runtime::lend(parameter),
  m.model = const_cast<char*>("");
  std::ranges::copy(value, m.value);
  return m;
}

std::expected<ParameterChange, std::string> change_of(
    std::span<const RosParameter> all, const msg::rcl_interfaces_Parameter& requested) {
  const std::string name = requested.name ? requested.name : "";
  const RosParameter* const known = find_parameter(all, name);
  const std::size_t dot = name.rfind('.');
  if (known ? known->effect.empty() : dot == std::string::npos) {
    if (known)
      return std::unexpected(
          fmt::format("'{}' belongs to the scene and is read-only while running; use `voxtouch "
                      "change --reload`",
                      name));
    return std::unexpected(
        fmt::format("unknown parameter '{}'; valid names: EFFECT.on, EFFECT.gain, EFFECT.PARAMETER",
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
    if (requested.value.type != kBool)
      return std::unexpected(fmt::format("'{}' must be true or false", effects::quotable(name)));
    change.value[0] = requested.value.bool_value ? 1.0 : 0.0;
    return change;
  }
  if (known && known->read_only)
    return change;  // the change validator checks it and may refuse it
  const std::vector<double> numbers = numbers_of(requested.value);
  const std::size_t count =
      known && std::holds_alternative<std::vector<double>>(known->value) ? 3 : 1;
  if (known && numbers.size() != count)
    return std::unexpected(
        fmt::format("'{}' must be {}", name, count == 3 ? "three numbers" : "a number"));
  std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 3), change.value);
  return change;
}

}  // namespace voxtouch::rendering_node
