#pragma once
/// Run-time change of one effect: requested by name, validated once, then plain numbers for the
/// loop.
#include <array>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/effects/effect_spec.hpp"

namespace voxtouch::effects {

enum class EffectAction : std::uint8_t { kSwitch, kGain, kValue };

/// A request; nothing in it is validated.
struct EffectRequest {
  EffectAction action = EffectAction::kSwitch;
  std::string_view effect;     ///< its name in the scene
  std::string_view parameter;  ///< kValue
  std::array<double, 3>
      value{};  ///< kSwitch: 0 off, 1 on; kGain and parameters of one number: the first
};

/// A validated command for the loop, without names.
struct EffectCommand {
  EffectAction action = EffectAction::kSwitch;
  std::uint32_t effect = 0, parameter = 0;  ///< indices in the scene's list and in the kind's
  std::array<double, 3> value{};            ///< directions normalised; unused numbers are 0
};

/// The command for `request`, or a sentence with the reason for refusal. Reasons are an unknown
/// name, a number that is not finite or out of range, and a word (words never change at run time).
/// Values are also refused if together they need missing resources or leave the stiffness
/// unbounded.
std::expected<EffectCommand, std::string> judge(std::span<const EffectSpec> effects,
                                                const EffectRequest& request);
/// The same for several changes in one sample. Each is validated with the combined result, so
/// values that only fit together may be requested in any order. Returns a sentence about the first
/// invalid one.
std::expected<std::vector<EffectCommand>, std::string> judge(
    std::span<const EffectSpec> effects, std::span<const EffectRequest> requests);

/// Applies the command to the specification without a ramp: the final state. Real-time safe.
void carry_out(EffectSpec& effect, const EffectCommand& command) noexcept;

/// `text` for a sentence: at most 64 characters, unprintable ones as '?'.
std::string quotable(std::string_view text);

}  // namespace voxtouch::effects
