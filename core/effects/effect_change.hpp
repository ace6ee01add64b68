#pragma once
/// A change of one effect while it runs: asked for by name, judged once, then plain numbers that a
/// loop can take.
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

/// As requested. Nothing of it is trusted.
struct EffectRequest {
  EffectAction action = EffectAction::kSwitch;
  std::string_view effect;     ///< its name in the scene
  std::string_view parameter;  ///< kValue
  std::array<double, 3>
      value{};  ///< kSwitch: 0 off, 1 on; kGain and parameters of one number: the first
};

/// As a loop takes it: no names, nothing left to check.
struct EffectCommand {
  EffectAction action = EffectAction::kSwitch;
  std::uint32_t effect = 0, parameter = 0;  ///< places in the scene's list and in the kind's
  std::array<double, 3> value{};  ///< directions at unit length; numbers that do not count are 0
};

/// What `request` means for `effects`, or a sentence why not: an unknown name, a number that is not
/// finite or out of its range, a word (which never changes while running), values that together
/// need what was not built or bound the stiffness no more.
std::expected<EffectCommand, std::string> judge(std::span<const EffectSpec> effects,
                                                const EffectRequest& request);
/// The same of several that are made together, in the same sample: each by what all of them lead
/// to, so that values which only fit together may be asked for in any order. A sentence about the
/// first that cannot be.
std::expected<std::vector<EffectCommand>, std::string> judge(
    std::span<const EffectSpec> effects, std::span<const EffectRequest> requests);

/// Does to the spec what the chain does to the effect, without a ramp: where it will have come to.
/// Real-time safe.
void carry_out(EffectSpec& effect, const EffectCommand& command) noexcept;

/// `text` for a sentence: at most 64 characters, those that cannot be printed as '?'.
std::string quotable(std::string_view text);

}  // namespace voxtouch::effects
