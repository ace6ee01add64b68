#include "core/coupling/injected_damping.hpp"

#include <algorithm>

#include "core/coupling/stiffness_scale.hpp"
#include "core/types/clamp.hpp"

namespace voxtouch::coupling {
namespace {

/// A smaller stiffness counts as zero, since its inverse would overflow.
constexpr double kNoStiffness = 1e-200;

}  // namespace

Mat3 contact_directions(const Mat3& stiffness, const Vec3& contact_force) noexcept {
  if (const double most = largest_eigenvalue(stiffness); most > kNoStiffness)
    return (0.5 / most) * (stiffness + stiffness.transpose());
  const double size = contact_force.stableNorm();
  if (!(size > kNoStiffness))
    return Mat3::Zero();
  const Vec3 along = contact_force / size;
  return along * along.transpose();
}

double one_sided(double coherence) noexcept {
  const double x = std::clamp((coherence - 0.2) / 0.3, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

void never_pull(Vec3& sum, const Vec3& contact_force, double part) noexcept {
  const double size = contact_force.stableNorm();
  if (!(size > kNoStiffness))
    return;
  const Vec3 along = contact_force / size;
  if (const double pull = along.dot(sum); pull < 0.0)
    sum -= part * pull * along;
}

bool bound_addition(Vec3& damping, const Vec3& contact_force, double most, double free) noexcept {
  const double size = contact_force.stableNorm();
  if (!(size > kNoStiffness))
    return clamp_length(damping, free);
  const Vec3 along = contact_force / size, taken = std::min(0.0, along.dot(damping)) * along;
  damping -= taken;
  const bool cut = clamp_length(damping, most);
  damping += taken;
  return cut;
}

InjectedWrench InjectedDamping::of(const CouplingInput& contact, const Vec3& law_force,
                                   const Twist& velocity) const noexcept {
  InjectedWrench out;
  const Mat6& k = contact.contact_stiffness;
  // Damping compensates stiffness that acts late. A force without stiffness (drag of a medium, a
  // weight) needs none.
  if (!(contact.contact_stiffness_n_per_m > 0.0) && k.isZero(0.0))
    return out;
  if (linear_.now() > 0.0)
    out.wrench.force =
        -linear_.now() *
        (contact_directions(k.topLeftCorner<3, 3>(), contact.contact.force) * velocity.linear);
  if (angular_.now() > 0.0)
    out.wrench.torque =
        -angular_.now() * (contact_directions(k.bottomRightCorner<3, 3>(), contact.contact.torque) *
                           velocity.angular);
  if (const double parts = parts_.now(); parts > 0.0)
    out.bounded =
        bound_addition(out.wrench.force, law_force, law_force.stableNorm() / parts + free_.now(),
                       (1.0 - one_sided(contact.coherence)) * free_.now());
  return out;
}

}  // namespace voxtouch::coupling
