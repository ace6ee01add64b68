#pragma once

namespace voxtouch {

/// 0 up to `from`, 1 from `to` on, 3t^2 - 2t^3 between: continuous with its first derivative. NaN
/// gives 0. Real-time safe.
inline constexpr double smoothstep(double from, double to, double x) noexcept {
  const double t = (x - from) / (to - from);
  if (!(t > 0.0))
    return 0.0;
  if (t >= 1.0)
    return 1.0;
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace voxtouch
