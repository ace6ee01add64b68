#include "core/coupling/passivity.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::coupling {
namespace {

/// A shorter direction counts as zero.
constexpr double kNoLength = 1e-200;

/// Clears an account that overflowed, because NaN would stay in it.
void keep(double& energy_j) noexcept {
  if (!std::isfinite(energy_j))
    energy_j = 0.0;
}

}  // namespace

void Passivity::reset() noexcept { *this = Passivity(); }

bool Passivity::rests(bool in_contact) noexcept {
  const double force = applied_.force.stableNorm(), torque = applied_.torque.stableNorm();
  most_force_n_ = std::max(most_force_n_, force),
  most_torque_nm_ = std::max(most_torque_nm_, torque);
  return !in_contact && force <= kRestForceRatio * most_force_n_ &&
         torque <= kRestForceRatio * most_torque_nm_;
}

void Passivity::observe(const ToolStep& step, bool in_contact, double dt_s,
                        double supplied_j) noexcept {
  const double along = applied_.force.dot(normal_), out = step.translation.dot(normal_);
  energy_.normal_j += supplied_j - along * out;
  energy_.tangential_j -= (applied_.force - along * normal_).dot(step.translation - out * normal_);
  energy_.rotation_j -= applied_.torque.dot(step.rotation);
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

void Passivity::command(const Wrench& applied, const Vec3& contact_force) noexcept {
  applied_ = applied;
  if (const double size = contact_force.stableNorm(); size > kNoLength)
    normal_ = contact_force / size;
}

}  // namespace voxtouch::coupling
