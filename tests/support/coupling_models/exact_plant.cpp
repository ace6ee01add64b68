#include "tests/support/coupling_models/exact_plant.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::coupling_models {
namespace {

/// C = cos(sqrt(-z)) and S = sin(sqrt(-z)) / sqrt(-z), or their hyperbolic continuations for z > 0.
struct Oscillation {
  double c, s;
};

Oscillation oscillation(double z) noexcept {
  if (std::abs(z) <= 1e-2)  // the usual case: a plant is slow against a sample
    return {
        1.0 + z * (1.0 / 2 + z * (1.0 / 24 + z * (1.0 / 720 + z * (1.0 / 40320 + z / 3628800)))),
        1.0 +
            z * (1.0 / 6 + z * (1.0 / 120 + z * (1.0 / 5040 + z * (1.0 / 362880 + z / 39916800))))};
  const double root = std::sqrt(std::abs(z));
  if (z < 0.0)
    return {std::cos(root), std::sin(root) / root};
  return {std::cosh(root), std::sinh(root) / root};
}

/// (y - 1 + exp(-y)) / y^2: twice integrated exponential, without its cancellation for small y.
double twice_integrated(double y, double exp_minus_y) noexcept {
  if (y > 0.5)
    return (y - 1.0 + exp_minus_y) / (y * y);
  double sum = 0.0;
  for (int n = 15; n >= 2; --n)
    sum = (1.0 - y * sum) / n;  // Horner: 1/2 (1 - y/3 (1 - y/4 (...)))
  return sum;
}

}  // namespace

ExactPlant::ExactPlant(const coupling::design::LoopPlant& plant, double coulomb_friction,
                       double push) noexcept
    : mass_(plant.mass + plant.hand_mass),
      damping_(plant.damping + plant.hand_damping),
      stiffness_(plant.hand_stiffness),
      friction_(coulomb_friction),
      push_(push),
      half_rate_(0.5 * damping_ / mass_),
      w2_(stiffness_ / mass_),
      discriminant_(half_rate_ * half_rate_ - w2_) {
  if (!(plant.effort_lag_s > 0.0))
    return;
  fade_rate_ = 1.0 / plant.effort_lag_s;
  const auto at = [&](double a) { return a * a - 2.0 * half_rate_ * a + w2_; };
  while (std::abs(at(fade_rate_)) < 1e-7 * (fade_rate_ * fade_rate_ + w2_))
    fade_rate_ *= 1.0001;
  fade_denominator_ = at(fade_rate_);
}

ExactPlant::Flow ExactPlant::flow(double h) const noexcept {
  const double decay = std::exp(-half_rate_ * h);
  const Oscillation o = oscillation(discriminant_ * h * h);
  const double c = decay * o.c, s = decay * h * o.s;
  Flow out{c + half_rate_ * s, s, -w2_ * s, c - half_rate_ * s, 0.0, s / mass_, 0.0, 0.0, 0.0};
  if (w2_ > 0.0) {
    out.x_const = (1.0 - out.xx) / stiffness_;
  } else {
    out.xx = 1.0;  // exact: a body without a spring has no equilibrium position
    out.x_const = h * h * twice_integrated(2.0 * half_rate_ * h, decay * decay) / mass_;
  }
  if (fade_rate_ > 0.0) {
    out.fade = std::exp(-fade_rate_ * h);
    const double q = (out.fade - (out.xx - fade_rate_ * s)) / fade_denominator_;
    out.x_fading = q / mass_;
    out.v_fading = (s - fade_rate_ * q) / mass_;
  }
  return out;
}

ExactPlant::State ExactPlant::end(const Flow& c, double constant, double fading) const noexcept {
  return {c.xx * x_ + c.xv * v_ + c.x_const * constant + c.x_fading * fading,
          c.vx * x_ + c.vv * v_ + c.v_const * constant + c.v_fading * fading};
}

void ExactPlant::slide(double h, double u, double friction) noexcept {
  const Flow c = flow(h);
  const double constant = u + push_ - friction, fading = fade_rate_ > 0.0 ? f_ - u : 0.0;
  const State to = end(c, constant, fading);
  work_ += u * (to.x - x_);
  if (fading != 0.0) {
    // integral of exp(-a t) v: the equation of motion times exp(-a t), integrated by parts
    const double a = fade_rate_;
    const double drive =
        constant * (1.0 - c.fade) / a + fading * (1.0 - c.fade * c.fade) / (2.0 * a);
    const double ends = mass_ * (c.fade * to.v - v_), displacement = c.fade * to.x - x_;
    work_ += fading * (drive - ends + stiffness_ * displacement / a) /
             (a * mass_ + damping_ + stiffness_ / a);
  }
  x_ = to.x, v_ = to.v, f_ = u + fading * c.fade;
}

double ExactPlant::net_at_rest(double u, double fade) const noexcept {
  return (fade_rate_ > 0.0 ? u + (f_ - u) * fade : u) + push_ - stiffness_ * x_;
}

/// Time, at most h, for which the resting body stays in place; the effort advances by it.
double ExactPlant::rest_until_slip(double h, double u) noexcept {
  const double now = net_at_rest(u, 1.0);
  if (std::abs(now) > friction_)
    return 0.0;
  double stay = h;
  if (fade_rate_ > 0.0) {
    const double last = net_at_rest(u, 0.0);  // its limit, approached monotonically
    if (std::abs(last) > friction_) {
      const double edge = std::copysign(friction_, last);
      stay = std::min(h, std::log((now - last) / (edge - last)) / fade_rate_);
    }
    f_ = u + (f_ - u) * std::exp(-fade_rate_ * stay);
  } else {
    f_ = u;
  }
  return stay;
}

/// Slides in `direction` for h or until the speed is zero; the time that it took.
double ExactPlant::slide_until_rest(double h, double u, double direction) noexcept {
  const double constant = u + push_ - direction * friction_,
               fading = fade_rate_ > 0.0 ? f_ - u : 0.0;
  const auto state_at = [&](double t) { return end(flow(t), constant, fading); };
  const auto pull = [&](const State& s, double fade) {
    return direction * (constant + fading * fade - damping_ * s.v - stiffness_ * s.x);
  };
  const auto pull_at = [&](double t, const State& s) {
    return pull(s, fade_rate_ > 0.0 ? std::exp(-fade_rate_ * t) : 0.0);
  };
  State last = state_at(h);
  double high = h;
  if (direction * last.v > 0.0) {
    // Braked at first and driven at the end: the speed has a least value between, which may be
    // below zero.
    double braked = 0.0, driven = h;
    bool stops = false;
    // From rest it is never braked at first; there the sign of the pull is rounding.
    if (v_ != 0.0 && pull({x_, v_}, 1.0) < 0.0 && pull_at(h, last) > 0.0) {
      for (int i = 0; i < 40 && !stops && driven - braked > 1e-9 * h; ++i) {
        high = 0.5 * (braked + driven);
        last = state_at(high);
        stops = direction * last.v <= 0.0;
        (pull_at(high, last) < 0.0 ? braked : driven) = high;
      }
    }
    if (!stops)
      return slide(h, u, direction * friction_), h;
  }
  double low = 0.0, v_low = direction * v_, v_high = direction * last.v;
  for (double t = 0.5 * high; v_low <= 0.0 && t > 1e-9 * h;
       t *= 0.5) {  // it starts from rest: find when it started to move
    const double v = direction * state_at(t).v;
    if (v > 0.0) {
      low = t, v_low = v;
    } else {
      high = t, v_high = v;
    }
  }
  if (v_low <= 0.0)
    return v_ = 0.0, 1e-9 * h;  // it does not set off within a billionth of the interval
  const double rest = 1e-12 * std::max(v_low, -v_high);
  double root = high;
  for (int i = 0, side = 0; i < 60; ++i) {  // false position, Illinois variant
    root = (low * v_high - high * v_low) / (v_high - v_low);
    const double v = direction * state_at(root).v;
    if (std::abs(v) <= rest || high - low <= 1e-14 * h)
      break;
    if (v > 0.0) {
      low = root, v_low = v;
      if (side == 1)
        v_high *= 0.5;
      side = 1;
    } else {
      high = root, v_high = v;
      if (side == -1)
        v_low *= 0.5;
      side = -1;
    }
  }
  slide(root, u, direction * friction_);
  v_ = 0.0;
  return root;
}

void ExactPlant::advance_with_friction(double h, double u) noexcept {
  constexpr int kMaxPieces =
      32;  // an interval has two or three; the end is a guard against rounding
  for (int piece = 0; piece < kMaxPieces && h > 0.0; ++piece) {
    if (v_ == 0.0)
      h -= rest_until_slip(h, u);
    if (!(h > 0.0))
      return;
    const double direction =
        v_ != 0.0 ? std::copysign(1.0, v_) : std::copysign(1.0, net_at_rest(u, 1.0));
    h -= slide_until_rest(h, u, direction);
  }
  if (!(h > 0.0))
    return;
  v_ = 0.0;
  f_ = fade_rate_ > 0.0 ? u + (f_ - u) * std::exp(-fade_rate_ * h) : u;
}

void ExactPlant::advance(double h, double u) noexcept {
  if (fade_rate_ <= 0.0)
    f_ = u;
  if (friction_ > 0.0) {
    // Short compared with the plant's oscillation, so that the body reverses at most twice in a
    // piece.
    const double pieces = std::ceil(2.0 * h * std::sqrt(w2_));
    for (int i = 1; i < static_cast<int>(pieces); ++i)
      advance_with_friction(h / pieces, u);
    advance_with_friction(pieces > 1.0 ? h / pieces : h, u);
  } else {
    slide(h, u, 0.0);
  }
}

}  // namespace voxtouch::coupling_models
