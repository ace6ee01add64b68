#include "core/coupling/passivity.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::coupling {
namespace {

/// A direction shorter than this is none.
constexpr double kNoLength = 1e-200;

/// A debt up to here [J] is rounding.
constexpr double kNoDebt = 1e-12;

double damping_for(double energy_j, double speed, double limit, double period_s) noexcept {
  if (!(energy_j < -kNoDebt) || !(speed > 0.0))
    return 0.0;
  return std::min(limit, -energy_j / period_s / speed / speed);  // no speed^2: it would underflow
}

void keep(double& energy_j) noexcept {
  if (!std::isfinite(energy_j))
    energy_j = 0.0;
}

}  // namespace

void Passivity::reset() noexcept { *this = Passivity(nominal_s_); }

bool Passivity::rests(bool in_contact) noexcept {
  const double force = applied_.force.stableNorm(), torque = applied_.torque.stableNorm();
  most_force_n_ = std::max(most_force_n_, force),
  most_torque_nm_ = std::max(most_torque_nm_, torque);
  return !in_contact && force <= kRestShare * most_force_n_ &&
         torque <= kRestShare * most_torque_nm_;
}

void Passivity::observe(const ToolStep& way, bool in_contact, double dt_s,
                        double supplied_j) noexcept {
  const double along = applied_.force.dot(normal_), out = way.shift.dot(normal_);
  energy_.normal_j += supplied_j - along * out;
  energy_.tangential_j -= (applied_.force - along * normal_).dot(way.shift - out * normal_);
  energy_.rotation_j -= applied_.torque.dot(way.turn);
  for (double* account : {&energy_.normal_j, &energy_.tangential_j, &energy_.rotation_j})
    keep(*account);

  if (!rests(in_contact)) {
    rested_s_ = 0.0;
    return;
  }
  rested_s_ = std::min(rested_s_ + dt_s, 2.0 * kDebtS);
  if (rested_s_ < kContactEndS)
    return;
  most_force_n_ = most_torque_nm_ = 0.0;
  const bool all = rested_s_ >= kDebtS;
  for (double* account : {&energy_.normal_j, &energy_.tangential_j, &energy_.rotation_j})
    *account = all ? 0.0 : std::min(*account, 0.0);
}

PassivityDamping Passivity::control(const Vec3& push, const ToolStep& way, const Twist& velocity,
                                    const PassivityLimits& limits) noexcept {
  if (const double size = push.stableNorm(); size > kNoLength)
    normal_ = push / size;
  PassivityDamping out;
  const Vec3 along = velocity.linear.dot(normal_) * normal_, across = velocity.linear - along;
  const auto damp = [&](double energy_j, const Vec3& v, const Vec3& last, double limit,
                        Vec3& effort, double& most) {
    if (v.dot(last) < 0.0)
      return;
    const double alpha = damping_for(energy_j, v.stableNorm(), limit, nominal_s_);
    effort = -alpha * v;
    most = std::max(most, alpha);
  };
  damp(energy_.normal_j, along, way.shift, limits.linear_ns_per_m, out.normal, out.linear_ns_per_m);
  damp(energy_.tangential_j, across, way.shift, limits.linear_ns_per_m, out.tangential,
       out.linear_ns_per_m);
  damp(energy_.rotation_j, velocity.angular, way.turn, limits.angular_nms_per_rad, out.torque,
       out.angular_nms_per_rad);
  return out;
}

}  // namespace voxtouch::coupling
