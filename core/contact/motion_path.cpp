#include "core/contact/motion_path.hpp"

#include <cmath>

#include "core/types/rotation_vector.hpp"

namespace voxtouch::contact {

MotionPath::MotionPath(const Pose& from, const Pose& to) noexcept
    : from_(from), to_(to), shift_(to.position - from.position), turn_(rotation_vector(from.orientation, to.orientation)) {}

Pose MotionPath::at(double t) const noexcept {
  if (!(t > 0.0)) return from_;
  if (t >= 1.0) return to_;
  Pose pose{from_.position + t * shift_, from_.orientation};
  const double angle = turn_.norm();
  if (angle > 0.0)
    pose.orientation = (Quat(Eigen::AngleAxisd(t * angle, turn_ / angle)) * from_.orientation).normalized();
  return pose;
}

int MotionPath::steps(double reach_m, double step_m, int most) const noexcept {
  // The way of a motion that just fits must not round up to one piece more.
  const double pieces = std::ceil(length_m(reach_m) / step_m * (1.0 - 1e-12));
  return pieces >= 1.0 ? (pieces <= most ? static_cast<int>(pieces) : most + 1) : 1;
}

double MotionPath::share(const Wrench& wrench) const noexcept {
  const double most = wrench.force.norm() * shift_.norm() + wrench.torque.norm() * turn_.norm();
  return most > 0.0 ? work_j(wrench) / most : 0.0;
}

}  // namespace voxtouch::contact
