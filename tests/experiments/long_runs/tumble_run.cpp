#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/effects/rigid_body.hpp"
#include "tests/experiments/long_runs/long_runs.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::long_runs {
namespace {

constexpr double kPeriod = 1e-3;
constexpr double kMaxNorm = 1e-15, kMaxSkew = 1e-14;  ///< permitted error of a rotation

effects::RigidBody tumbling() {
  effects::BodyShape shape;
  shape.inertia_m2 = Vec3(1e-4, 2e-4, 2.7e-4).asDiagonal();
  shape.reach_m = 0.02;
  effects::RigidBody body(shape);
  body.place({Vec3::Zero(), Quat(Eigen::AngleAxisd(0.3, Vec3(3, 1, 2).normalized()))}, false);
  return body;
}

/// About changing axes, in alternating directions, so that it neither comes to rest nor accelerates
/// without limit.
effects::BodyLoad push(std::uint64_t n) {
  effects::BodyLoad load;
  load.wrench.torque = 1e-4 * Vec3(std::sin(0.01 * static_cast<double>(n % 10000)), 0.7, -0.4);
  if (n / 2000 % 2 == 1)
    load.wrench.torque *= -1.0;
  return load;
}

}  // namespace

Findings run_tumble(const TumbleRunOptions& ask, const Progress& progress) {
  Findings out;
  effects::RigidBody body = tumbling();
  effects::BodyParameters parameters;
  parameters.mass_kg = 0.1;
  double norm = 0.0, skew = 0.0, angle = 0.0, first_s = 0.0, last_s = 0.0;
  std::uint64_t n = 0;
  for (std::uint64_t tenth = 1; tenth <= 10; ++tenth) {
    const double begin = thread_seconds();
    for (const std::uint64_t until = ask.steps / 10 * tenth; n < until; ++n) {
      body.step(push(n), {}, {}, false, 0.0, parameters, kPeriod);
      const Quat& q = body.pose().orientation;
      norm = std::max(norm, std::abs(q.norm() - 1.0));
      angle += body.twist().angular.norm() * kPeriod;
      if (n % 64 == 0) {
        const Mat3 r = q.toRotationMatrix();
        skew = std::max(skew, (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff());
      }
      if (progress && n % 100'000 == 0)
        progress(n, ask.steps);
    }
    (tenth == 1 ? first_s : last_s) = thread_seconds() - begin;
  }
  out.slow_down = last_s / first_s;
  out.lines.push_back(fmt::format(
      "a body that tumbles, {} steps, {:.4g} rad: |q| - 1 at most {:.2g}, R'R - I at most {:.2g}",
      n, angle, norm, skew));
  // A NaN is a fault too.
  if (!(norm <= kMaxNorm))
    out.faults.push_back(fmt::format("a quaternion's norm is off one by {:.3g}", norm));
  if (!(skew <= kMaxSkew))
    out.faults.push_back(fmt::format("a rotation matrix is off orthogonal by {:.3g}", skew));
  if (!(angle >= 1e-4 * static_cast<double>(ask.steps)))
    out.faults.push_back(
        fmt::format("the body turned by {:.3g} rad only, which shows nothing", angle));
  return out;
}

}  // namespace voxtouch::long_runs
