#pragma once
/// A device in a hand on a contact, as far as the coupling's tests need it: a point mass in three
/// dimensions between samples.
#include <cmath>
#include <functional>

#include "core/coupling/running_coupling.hpp"

namespace voxtouch::coupling {

struct LoopDevice {
  double mass_kg = 0.1, damping_ns_per_m = 0.05, friction_n = 0.0;
  double resolution_m = 0.0;  ///< encoder step; 0: none
  Vec3 push = Vec3::Zero();   ///< constant force of the hand
  double hand_stiffness_n_per_m = 0.0, hand_damping_ns_per_m = 0.0;
  Vec3 hand_at = Vec3::Zero();
};

class HapticLoop {
 public:
  using Contact = std::function<CouplingInput(const Vec3& position)>;

  HapticLoop(const LoopDevice& device, RunningCoupling& coupling, Contact contact,
             double period_s = 1e-3)
      : device_(device),
        coupling_(coupling),
        contact_(std::move(contact)),
        period_s_(period_s) {}

  /// One sample: read, command at once, hold for the period.
  const CouplingOutput& step() {
    Vec3 seen = position;
    if (device_.resolution_m > 0.0)
      seen = (seen / device_.resolution_m).array().round() * device_.resolution_m;
    CouplingInput input = contact_(seen);
    input.tool.position = seen;
    out_ = coupling_.step(input, period_s_);
    work_in_j -= out_.wrench.force.dot(move());
    return out_;
  }

  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
  double work_in_j = 0.0;  ///< by the hand against the command, of the true motion

 private:
  Vec3 move() {
    constexpr int kPieces = 20;
    const double h = period_s_ / kPieces;
    const Vec3 start = position;
    for (int i = 0; i < kPieces; ++i) {
      Vec3 force = out_.wrench.force + device_.push - device_.damping_ns_per_m * velocity +
                   device_.hand_stiffness_n_per_m * (device_.hand_at - position) -
                   device_.hand_damping_ns_per_m * velocity;
      rub(force, h);
      velocity += h / device_.mass_kg * force;
      position += h * velocity;
    }
    return position - start;
  }
  /// Dry friction along x: it only stops.
  void rub(Vec3& force, double h) const {
    if (!(device_.friction_n > 0.0))
      return;
    const double stop = -device_.mass_kg * velocity.x() / h - force.x();
    force.x() += std::fmax(-device_.friction_n, std::fmin(device_.friction_n, stop));
  }

  LoopDevice device_;
  RunningCoupling& coupling_;
  Contact contact_;
  double period_s_;
  CouplingOutput out_;
};

/// A wall with force along +x for x < 0.
inline CouplingInput wall(const Vec3& at, double k) {
  CouplingInput in;
  if (at.x() > 0.0)
    return in;
  in.contact.force = Vec3(-k * at.x(), 0, 0);
  in.contact_stiffness_n_per_m = k;
  in.contact_stiffness(0, 0) = k;
  return in;
}

/// A frictionless cylinder about z, touched from outside (radius `r`) or from inside.
inline CouplingInput cylinder(const Vec3& at, double r, double k, bool inside = false) {
  CouplingInput in;
  const Vec3 radial(at.x(), at.y(), 0);
  const double depth = inside ? radial.norm() - r : r - radial.norm();
  if (depth < 0.0)
    return in;
  const Vec3 out = (inside ? -1.0 : 1.0) * radial.normalized();
  in.contact.force = k * depth * out;
  in.contact_stiffness_n_per_m = k;
  in.contact_stiffness.topLeftCorner<3, 3>() = k * out * out.transpose();
  return in;
}

}  // namespace voxtouch::coupling
