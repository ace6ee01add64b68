#pragma once
/// An EffectChange that owns its texts until it is applied.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "core/effects/effect_change.hpp"
#include "nodes/runtime/strings.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

class KeptChange {
 public:
  KeptChange() = default;
  explicit KeptChange(const msg::EffectChange& m)
      : request_(m.request),
        action_(m.action),
        effect_(text_of(m.effect)),
        parameter_(text_of(m.parameter)),
        model_(text_of(m.model)),
        voxel_size_m_(m.voxel_size_m) {
    std::ranges::copy(m.value, value_.begin());
  }

  /// Record of the applied change. Its texts refer to this object.
  msg::EffectChange made(std::uint64_t session, std::uint64_t from_sample) const {
    msg::EffectChange m{};
    m.request = request_, m.session_id = session, m.from_sample = from_sample, m.action = action_,
    m.voxel_size_m = voxel_size_m_;
    m.effect = runtime::lend(effect_), m.parameter = runtime::lend(parameter_),
    m.model = runtime::lend(model_);
    std::ranges::copy(value_, m.value);
    return m;
  }

 private:
  static std::string text_of(const char* text) { return text ? text : ""; }
  std::uint64_t request_ = 0;
  std::uint32_t action_ = 0;
  std::string effect_, parameter_, model_;
  std::array<double, 3> value_{};
  double voxel_size_m_ = 0.0;
};

/// Text for messages, for example "'viscosity' off".
inline std::string in_words(const msg::EffectChange& m) {
  using namespace msg::effect_change;
  const std::string effect = effects::quotable(m.effect ? m.effect : "");
  switch (m.action) {
    case kActionSwitch:
      return fmt::format("'{}' {}", effect, m.value[0] != 0.0 ? "on" : "off");
    case kActionGain:
      return fmt::format("gain of '{}' {:g}", effect, m.value[0]);
    case kActionValue:
      return fmt::format("'{}' of '{}'", effects::quotable(m.parameter ? m.parameter : ""), effect);
    default:
      return "the rebuilt scene";
  }
}

}  // namespace voxtouch::rendering_node
