#include "core/effects/effect_change.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace voxtouch::effects {
namespace {

using CheckedChange = std::expected<EffectCommand, std::string>;

/// Resources that were not requested when the scene was built do not exist.
bool needs_more(const EffectNeeds& after, const EffectNeeds& before) {
  return (after.twist && !before.twist) || (after.contact && !before.contact) ||
         (after.torque && !before.torque) || (after.orientation && !before.orientation) ||
         (after.body && !before.body) || (after.external && !before.external) ||
         after.proximity_m > before.proximity_m || after.smoothing_m > before.smoothing_m ||
         after.lever_m < before.lever_m;
}

std::string names_of(std::span<const EffectSpec> effects) {
  std::string names;
  for (const EffectSpec& effect : effects)
    names += (names.empty() ? "" : ", ") + effect.name;
  return names;
}

std::string names_of(std::span<const EffectParameter> parameters) {
  std::string names;
  for (const EffectParameter& p : parameters)
    names.append(names.empty() ? "" : ", ").append(p.name);
  return names;
}

/// The numbers in use: a direction normalised (0 and non-finite values are kept, to be refused),
/// zeros after a single number.
std::array<double, 3> in_shape(const EffectParameter& parameter,
                               const std::array<double, 3>& value) {
  if (parameter.shape == ParameterShape::kNumber)
    return {value[0], 0.0, 0.0};
  if (parameter.shape != ParameterShape::kDirection)
    return value;
  const Vec3 v(value[0], value[1], value[2]);
  const double length = v.stableNorm();
  if (!(std::isfinite(length) && length > 0.0))
    return value;
  const Vec3 unit = v / length;
  return {unit.x(), unit.y(), unit.z()};
}

/// Why a kind with `everywhere` has no switch and no weight.
std::string no_switch(const EffectSpec& effect) {
  return fmt::format("'{}' has no switch and no gain", effect.name);
}

/// The command for one parameter of one effect; its number is not checked.
CheckedChange find_value(const EffectSpec& effect, std::string_view parameter,
                         const std::array<double, 3>& value) {
  const std::span<const EffectParameter> all = effect.kind->parameters;
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const EffectParameter& p) { return p.name == parameter; });
  if (found == all.end())
    return std::unexpected(fmt::format("effect '{}' has no parameter '{}'; valid: {}", effect.name,
                                       quotable(parameter), names_of(all)));
  if (found->shape == ParameterShape::kWord || found->shape == ParameterShape::kText)
    return std::unexpected(fmt::format("'{}' cannot change while running", found->name));
  EffectCommand command{.action = EffectAction::kValue,
                        .effect = 0,
                        .parameter = static_cast<std::uint32_t>(found - all.begin())};
  command.value = in_shape(*found, value);
  return command;
}

/// The command for `request`; only the shape of a parameter's number is checked.
CheckedChange find(std::span<const EffectSpec> effects, const EffectRequest& request) {
  const auto found = std::find_if(effects.begin(), effects.end(),
                                  [&](const EffectSpec& e) { return e.name == request.effect; });
  if (found == effects.end())
    return std::unexpected(
        effects.empty()
            ? fmt::format("no effect '{}': the scene has no effects", quotable(request.effect))
            : fmt::format("no effect '{}'; effects of the scene: {}", quotable(request.effect),
                          names_of(effects)));
  const double first = request.value[0];
  EffectCommand command{.action = request.action, .value = {first, 0.0, 0.0}};
  if (found->kind->everywhere && request.action != EffectAction::kValue)
    return std::unexpected(no_switch(*found));
  switch (request.action) {
    case EffectAction::kSwitch:
      if (first != 0.0 && first != 1.0)
        return std::unexpected("a switch must be 1 (on) or 0 (off)");
      break;
    case EffectAction::kGain:
      if (!(first >= 0.0 && first <= 1.0))
        return std::unexpected("'gain' must be a number from 0 to 1");
      break;
    case EffectAction::kValue: {
      const CheckedChange value = find_value(*found, request.parameter, request.value);
      if (!value)
        return value;
      command = *value;
      break;
    }
  }
  command.effect = static_cast<std::uint32_t>(found - effects.begin());
  return command;
}

/// Why `requested` cannot replace `effect`, from which it differs in `parameter`.
std::string refusal(const EffectSpec& effect, const EffectSpec& requested,
                    std::uint32_t parameter) {
  const std::string_view name = effect.kind->parameters[parameter].name;
  if (std::string why = check_values(*effect.kind, requested.values); !why.empty())
    return why;
  if (needs_more(effect.kind->needs(requested.values), effect.kind->needs(effect.values)))
    return fmt::format(
        "'{}' needs resources that are not built for this scene; change the scene file and reload "
        "it",
        name);
  const EffectBound bound = bound_of(requested);
  if (!std::isfinite(bound.stiffness_n_per_m) || !std::isfinite(bound.stiffness_nm_per_rad))
    return fmt::format("with this '{}' the stiffness of '{}' is unbounded", name, effect.name);
  return {};
}

}  // namespace

CheckedChange judge(std::span<const EffectSpec> effects, const EffectRequest& request) {
  const auto all = judge(effects, std::span(&request, 1));
  if (!all)
    return std::unexpected(all.error());
  return all->front();
}

std::expected<std::vector<EffectCommand>, std::string> judge(
    std::span<const EffectSpec> effects, std::span<const EffectRequest> requests) {
  std::vector<EffectSpec> requested(effects.begin(), effects.end());
  std::vector<EffectCommand> commands;
  for (const EffectRequest& request : requests) {
    const CheckedChange command = find(effects, request);
    if (!command)
      return std::unexpected(command.error());
    carry_out(requested[command->effect], *command);
    commands.push_back(*command);
  }
  for (const EffectCommand& command : commands) {
    if (command.action != EffectAction::kValue)
      continue;
    if (std::string why =
            refusal(effects[command.effect], requested[command.effect], command.parameter);
        !why.empty())
      return std::unexpected(std::move(why));
  }
  return commands;
}

void carry_out(EffectSpec& effect, const EffectCommand& command) noexcept {
  switch (command.action) {
    case EffectAction::kSwitch:
      effect.on = command.value[0] != 0.0;
      break;
    case EffectAction::kGain:
      effect.gain = command.value[0];
      break;
    case EffectAction::kValue:
      effect.values.at(command.parameter) = command.value;
      break;
  }
}

std::string quotable(std::string_view text) {
  constexpr std::size_t kMaxLength = 64;
  std::string out(text.substr(0, kMaxLength));
  for (char& c : out)
    if (c < ' ' || c > '~')
      c = '?';
  return text.size() > kMaxLength ? out + "..." : out;
}

}  // namespace voxtouch::effects
