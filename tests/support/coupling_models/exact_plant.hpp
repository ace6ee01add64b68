#pragma once
/// Device and hand in continuous time, solved in closed form between the instants at which the
/// effort changes.
///
///   M x'' + B x' + k_h x = f + push - friction,     f' = (u - f) a     (a = 1 / effort lag; no
///   lag: f = u)
#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling_models {

/// One axis. Nothing is discretised: over an interval with constant u, position, speed and effort
/// are the sums of exponentials that solve the equations, for an interval of any length.
///
/// Dry friction is exact as well. While the body slides in one direction it is a constant effort,
/// so the closed form is valid until the speed becomes zero. The body then rests until the net
/// effort exceeds the friction (that instant is a logarithm). Friction therefore never drives, and
/// a body at rest below the friction stays in place, bit-identically.
class ExactPlant {
 public:
  /// Mass of device and hand together > 0, damping, stiffness and lag >= 0. A lag within 0.1 % of a
  /// pole of the plant is moved off it by as much, because the closed form would divide by zero.
  ExactPlant(const coupling::design::LoopPlant& plant, double coulomb_friction,
             double push) noexcept;

  /// Moves on by `h` [s] >= 0 under the commanded effort `u`.
  void advance(double h, double u) noexcept;

  double position() const noexcept { return x_; }
  double speed() const noexcept { return v_; }
  double effort() const noexcept { return f_; }
  /// Energy that the effort has supplied to device and hand so far, integral of f v [J], exact.
  double work() const noexcept { return work_; }
  /// Kinetic energy and that of the hand's spring [J].
  double energy() const noexcept { return 0.5 * (mass_ * v_ * v_ + stiffness_ * x_ * x_); }
  void set(double position, double speed) noexcept { x_ = position, v_ = speed; }

 private:
  struct State {
    double x, v;
  };
  /// Coefficients of the solution after one length of time.
  struct Flow {
    double xx, xv, vx, vv;      ///< from position and speed
    double x_const, v_const;    ///< from a constant effort
    double x_fading, v_fading;  ///< from an effort exp(-a t)
    double fade;                ///< exp(-a h)
  };
  Flow flow(double h) const noexcept;
  State end(const Flow& c, double constant, double fading) const noexcept;
  void slide(double h, double u, double friction) noexcept;
  double net_at_rest(double u, double fade) const noexcept;
  double slide_until_rest(double h, double u, double direction) noexcept;
  double rest_until_slip(double h, double u) noexcept;
  void advance_with_friction(double h, double u) noexcept;

  double mass_, damping_, stiffness_, friction_, push_;
  double half_rate_;               ///< sigma = B / (2 M)
  double w2_;                      ///< k_h / M
  double discriminant_;            ///< sigma^2 - w2
  double fade_rate_ = 0.0;         ///< a; 0: no lag
  double fade_denominator_ = 1.0;  ///< a^2 - 2 sigma a + w2
  double x_ = 0.0, v_ = 0.0, f_ = 0.0, work_ = 0.0;
};

}  // namespace voxtouch::coupling_models
