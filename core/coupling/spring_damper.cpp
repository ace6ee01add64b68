#include "core/coupling/spring_damper.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::coupling {
namespace {

/// A smaller displacement component [m] is set to zero, so that it does not decay into denormal
/// numbers.
constexpr double kRest = 1e-30;

void settle(Vec3& delta) noexcept {
  for (double& x : delta)
    if (std::abs(x) < kRest)
      x = 0.0;
}

}  // namespace

Vec3 UnilateralSpringDamper::step(const Vec3& f, double k, double c, double r,
                                  double dt_s) noexcept {
  const double damper = r / dt_s;
  const double left =
      damper / (c + damper);  // fraction of the displacement that a free object keeps over the step
  const double size = f.norm();
  if (!(size > 0.0)) {
    delta *= left;
    settle(delta);
    return Vec3::Zero();
  }
  const Vec3 along = f / size;
  const double before = along.dot(delta);
  // A negative displacement (the force has reversed within a step) would need more force than that
  // of the contact.
  double now = std::max(0.0, (size + damper * before) / (k + c + damper));
  double given = size - k * now;
  if (given < 0.0)
    given = 0.0, now = left * before;  // the object has left the surface
  delta = left * (delta - before * along) + now * along;
  settle(delta);
  return given * along;
}

void SpringDamper::redesign(const CouplingSpec& spec) noexcept {
  c_.head_for(spec.stiffness_n_per_m, kDefaultRampS);
  r_.head_for(spec.damping_ns_per_m, kDefaultRampS);
}

void SpringDamper::start_at(const Wrench& start) noexcept {
  start_ = start;
  force_.delta = start.force / c_.now();
  torque_.delta = start.torque / c_.now();
}

Wrench SpringDamper::step(const LawInput& in) noexcept {
  const double c = c_.advance(in.dt_s), r = r_.advance(in.dt_s);
  Wrench contact = in.contact;
  if (in.weight < 1.0) {
    const double back = (1.0 - in.weight) * (c + in.stiffness_n_per_m) /
                        c;  // f that would maintain the start force at rest
    contact.force = in.weight * in.contact.force + back * start_.force;
    contact.torque = in.weight * in.contact.torque + back * start_.torque;
  }
  return {force_.step(contact.force, in.stiffness_n_per_m, c, r, in.dt_s),
          torque_.step(contact.torque, in.stiffness_n_per_m, c, r, in.dt_s)};
}

}  // namespace voxtouch::coupling
