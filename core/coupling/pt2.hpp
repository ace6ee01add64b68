#pragma once
/// The second-order low-pass of the paper (section 3) for one number,
///
///     H(s) = K w0^2 / (s^2 + 2 d w0 s + w0^2),
///
/// sampled with the Tustin rule s = (2/T) (z - 1)/(z + 1).
///
/// The realisation applies the trapezoid rule to the states y and v = y'/w0, solved for the
/// increments of a step. It has exactly the printed H_f(z), but its state is physical: (y - K u)^2
/// + v^2 never grows for a constant input, for any sequence of w0, d and T. Parameters may
/// therefore change at any time, and from rest |y| <= 2 |K| max|u|. A direct form has neither
/// property: its error grows with 1/(w0 T)^2, and it can diverge when T changes.
#include <cmath>

namespace voxtouch::coupling {

/// Coefficients of one step, shared by all components with the same filter.
struct Pt2Coefficients {
  double g = 0;   ///< w0 T / 2
  double c = 0;   ///< 2 (2 d + g)
  double gd = 0;  ///< g / (1 + 2 d g + g^2)

  /// Tustin rule without prewarping, for w0 >= 0, d >= 0 and T > 0 (the paper, section 3).
  /// Real-time safe.
  static Pt2Coefficients of(double w0_rad_per_s, double damping_ratio, double period_s) noexcept {
    const double g = 0.5 * w0_rad_per_s * period_s, damped = 2.0 * damping_ratio + g;
    return {g, 2.0 * damped, g / (1.0 + g * damped)};
  }
};

/// State of one component.
struct Pt2State {
  double y = 0;       ///< output
  double v = 0;       ///< y' / w0
  double u_last = 0;  ///< last input

  /// A smaller state without input is set to zero. It would otherwise decay into denormal numbers,
  /// which take twenty times longer, and remain there.
  static constexpr double kRest = 1e-12;

  /// Filters one sample of input `u` [any unit]. Returns the output in the unit of `gain * u`.
  /// Real-time safe.
  double advance(const Pt2Coefficients& k, double gain, double u) noexcept {
    const double e = gain * (u + u_last) - 2.0 * y;
    const double dv = k.gd * (e - k.c * v);
    y += k.g * (2.0 * v + dv);
    v += dv;
    u_last = u;
    if (u == 0.0 && std::abs(y) + std::abs(v) < kRest)
      y = v = 0.0;
    return y;
  }
  /// Sets the state to rest at `y0`, which the input y0 / gain maintains. Real-time safe.
  void reset(double y0, double gain) noexcept {
    y = y0, v = 0.0, u_last = gain == 0.0 ? 0.0 : y0 / gain;
  }
};

}  // namespace voxtouch::coupling
