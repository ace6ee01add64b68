#pragma once
/// Limits of the target of a hand that is led from outside.
#include <algorithm>

#include "core/types/geometry.hpp"

namespace voxtouch {

/// Limits as ratios of the displacement at which the hand's spring gives the device's largest
/// force. A hand that pulls harder than the device passes every wall, as with hardware.
inline constexpr double kLeadRatio = 0.9;     ///< ahead of the tool
inline constexpr double kPressRatio = 0.3;    ///< against the force that the device gives
inline constexpr double kLoadedRatio = 0.05;  ///< of the largest force: from there on kPressRatio

/// Limits `lead`, the displacement from the tool to the hand's target [m]; within the limits it is
/// bit-identical. `load`: the device's force divided by its largest one, in the same axes. `full`:
/// the displacement at which the hand's spring gives the largest force [m]; infinity: no limit. For
/// a rotation: rotation vectors and torques.
///
/// Between no load and kLoadedRatio the limit against the load falls linearly from kLeadRatio, so
/// the result is continuous. Real-time safe.
inline Vec3 limited_lead(const Vec3& lead, const Vec3& load, double full) noexcept {
  const double length = lead.stableNorm(), most = kLeadRatio * full;
  const Vec3 led = length > most ? Vec3((most / length) * lead) : lead;
  const double loaded = load.norm();
  if (!(loaded > 0.0))
    return led;
  const double slack = std::max(0.0, 1.0 - loaded / kLoadedRatio);
  const double limit = (kPressRatio + (kLeadRatio - kPressRatio) * slack) * full;
  const Vec3 against = load / -loaded;
  const double pressed = led.dot(against);
  return pressed > limit ? Vec3(led - (pressed - limit) * against) : led;
}

}  // namespace voxtouch
