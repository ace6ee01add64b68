#include "core/coupling/spring_damper.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch {
namespace {

/// A displacement component below this [m] is set to zero, before it decays into denormal numbers.
constexpr double kRest = 1e-30;

void settle(Vec3& delta) noexcept {
  for (double& x : delta)
    if (std::abs(x) < kRest) x = 0.0;
}

}  // namespace

Vec3 UnilateralSpringDamper::step(const Vec3& f, double k, double c, double r, double dt_s) noexcept {
  const double damper = r / dt_s;
  const double left = damper / (c + damper);  // share of the displacement that an unpushed object keeps over the step
  const double size = f.norm();
  if (!(size > 0.0)) {
    delta *= left;
    settle(delta);
    return Vec3::Zero();
  }
  const Vec3 along = f / size;
  const double before = along.dot(delta);
  // Below zero (the force has turned round within a step) the object would be pushed by more than the contact gives.
  double now = std::max(0.0, (size + damper * before) / (k + c + damper));
  double given = size - k * now;
  if (given < 0.0) given = 0.0, now = left * before;  // off the surface
  delta = left * (delta - before * along) + now * along;
  settle(delta);
  return given * along;
}

void SpringDamper::reset(const Wrench& held) noexcept {
  rest_at(policy_.restart(held));
}

bool SpringDamper::set(double stiffness_n_per_m, double damping_ns_per_m) noexcept {
  if (!(stiffness_n_per_m > 0.0 && std::isfinite(stiffness_n_per_m) && damping_ns_per_m >= 0.0 &&
        std::isfinite(damping_ns_per_m)))
    return false;
  c_.head_for(stiffness_n_per_m, kDefaultRampS);
  r_.head_for(damping_ns_per_m, kDefaultRampS);
  return true;
}

void SpringDamper::rest_at(const Wrench& held) noexcept {
  held_ = given_ = held;
  force_.delta = held.force / c_.now();
  torque_.delta = held.torque / c_.now();
}

Wrench SpringDamper::step(const CouplingInput& input, double dt_s) noexcept {
  PolicedInput in = policy_.take(input, dt_s, 1.0);
  if (in.gap) rest_at(given_);
  const double c = c_.advance(in.dt_s), r = r_.advance(in.dt_s);
  if (in.weight < 1.0) {
    const double back = (1.0 - in.weight) * (c + in.stiffness_n_per_m) / c;  // f that would keep the held force at rest
    in.contact.force = in.weight * in.contact.force + back * held_.force;
    in.contact.torque = in.weight * in.contact.torque + back * held_.torque;
  }
  given_.force = force_.step(in.contact.force, in.stiffness_n_per_m, c, r, in.dt_s);
  given_.torque = torque_.step(in.contact.torque, in.stiffness_n_per_m, c, r, in.dt_s);
  return given_;
}

}  // namespace voxtouch
