#pragma once
/// Stability limit of a shaping filter's loop without hold, delay and lag: a closed form for
/// comparison with the sampled loop.
#include <algorithm>

#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::test {

/// Contact stiffness [N/m] by Routh's criterion, K taken into account; for a shaping filter with
/// gain > 0 and no injected damping. At 1 kHz and 1 ms of delay 2 % too high at 5 Hz, and twice too
/// high at 40 Hz with a lag.
inline double routh_stiffness(const coupling::design::LoopPlant& p,
                              const coupling::design::LoopController& c) {
  const double m = p.mass + p.hand_mass, b = p.damping + p.hand_damping, k_h = p.hand_stiffness,
               w0 = c.w0_rad_per_s;
  const double twice = 2.0 * c.damping_ratio * w0;
  // (m s^2 + b s + k_h)(s^2 + 2 d w0 s + w0^2) + K k w0^2, from s^4 down.
  const double a4 = m, a3 = twice * m + b, a2 = m * w0 * w0 + twice * b + k_h,
               a1 = b * w0 * w0 + twice * k_h;
  return std::max(0.0, ((a2 - a4 * a1 / a3) * a1 / a3 / (w0 * w0) - k_h) / c.gain);
}

}  // namespace voxtouch::test
