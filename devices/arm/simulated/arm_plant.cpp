#include "devices/arm/simulated/arm_plant.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace voxtouch::arm_sim {
namespace {

constexpr int kSweeps = 60;           // of the impulses' iteration; it converges in a few
constexpr double kConverged = 1e-13;  // [rad/s] change of a rate in one sweep

Wrench wrench_of(const hand::HandAction& hand, const ArmDynamics::Terms& terms) noexcept {
  return {hand.force(terms.tool.position, terms.twist.linear),
          hand.torque(terms.tool.orientation, terms.twist.angular)};
}

}  // namespace

ArmPlant::ArmPlant(const PlantParameters& parameters, const arm::Joints& q)
    : parameters_(parameters),
      dynamics_(parameters.bodies, parameters.pose_FT),
      q_(q) {
  sensed_ = dynamics_.at(q_, rate_).gravity;
}

arm::Joints ArmPlant::drive_torque(const Step& step, const arm::Joints& gravity) const noexcept {
  if (step.drives == Drives::kBraked)
    return arm::Joints::Zero();
  return (step.torque + gravity)
      .cwiseMin(parameters_.torque_limit_nm)
      .cwiseMax(-parameters_.torque_limit_nm);
}

ArmPlant::Slope ArmPlant::slope(const Step& step, const arm::Joints& q, const arm::Joints& rate,
                                ArmDynamics::Terms& terms) const noexcept {
  terms = dynamics_.at(q, rate, {step.hand.mass_kg, step.hand.inertia_kg_m2});
  const arm::Joints torque = drive_torque(step, terms.gravity) - terms.gravity - terms.coriolis -
                             parameters_.viscous_nms_per_rad.cwiseProduct(rate) +
                             arm::joint_torque(terms.jacobian, wrench_of(step.hand, terms));
  return {rate, terms.mass.llt().solve(torque)};
}

arm::Joints ArmPlant::sticking_impulse(const JointMatrix& mass, const arm::Joints& q,
                                       const arm::Joints& rate, Drives drives,
                                       double dt_s) noexcept {
  arm::Joints low, high;
  high = dt_s * parameters_.coulomb_nm;
  if (drives == Drives::kBraked)
    high += dt_s * parameters_.brake_nm;
  low = -high;
  at_stop_ = false;
  for (int i = 0; i < 7; ++i) {
    if (q[i] >= parameters_.highest_rad[i])
      low[i] = -std::numeric_limits<double>::infinity();
    if (q[i] <= parameters_.lowest_rad[i])
      high[i] = std::numeric_limits<double>::infinity();
  }
  if (low.isZero(0.0) && high.isZero(0.0))
    return arm::Joints::Zero();
  const arm::Joints full = -(mass * rate);  // stops all joints
  if ((full.array() >= low.array()).all() && (full.array() <= high.array()).all())
    return full;

  // Projected Gauss-Seidel on the joint rates: each joint in turn receives the impulse that stops
  // it, within its bounds.
  const JointMatrix mobility = mass.llt().solve(JointMatrix::Identity());
  arm::Joints impulse = arm::Joints::Zero(), left = rate;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double change = 0.0;
    for (int i = 0; i < 7; ++i) {
      const double requested = std::clamp(impulse[i] - left[i] / mobility(i, i), low[i], high[i]);
      const double more = requested - impulse[i];
      impulse[i] = requested;
      left += more * mobility.col(i);
      change = std::max(change, std::abs(more) * mobility(i, i));
    }
    if (change < kConverged)
      break;
  }
  return impulse;
}

void ArmPlant::step(const arm::Joints& torque, Drives drives, const hand::HandAction& hand,
                    double dt_s) noexcept {
  const Step step{torque, drives, hand};
  const double half = 0.5 * dt_s;
  ArmDynamics::Terms start, tried;
  const Slope a = slope(step, q_, rate_, start);
  const Slope b = slope(step, q_ + half * a.rate, rate_ + half * a.acceleration, tried);
  const Slope c = slope(step, q_ + half * b.rate, rate_ + half * b.acceleration, tried);
  const Slope d = slope(step, q_ + dt_s * c.rate, rate_ + dt_s * c.acceleration, tried);
  const double sixth = dt_s / 6.0;
  const arm::Joints before = rate_;
  arm::Joints q = q_ + sixth * (a.rate + 2.0 * (b.rate + c.rate) + d.rate);
  arm::Joints rate =
      rate_ + sixth * (a.acceleration + 2.0 * (b.acceleration + c.acceleration) + d.acceleration);

  hand_wrench_ = wrench_of(hand, start);
  const arm::Joints impulse = sticking_impulse(start.mass, q, rate, drives, dt_s);
  sensed_ = drive_torque(step, start.gravity) + impulse / dt_s;
  if (!impulse.isZero(0.0)) {
    const arm::Joints change = start.mass.llt().solve(impulse);
    arm::Joints stuck = rate + change;
    // Removes rounding: a joint held by friction stays exactly in place.
    for (int i = 0; i < 7; ++i)
      if (std::abs(stuck[i]) < 1e-12 && std::abs(before[i]) < 1e-12)
        stuck[i] = 0.0;
    q += half * change;
    rate = stuck;
    for (int i = 0; i < 7; ++i)
      if (rate[i] == 0.0 && before[i] == 0.0)
        q[i] = q_[i];
  }
  for (int i = 0; i < 7; ++i) {
    if (q[i] < parameters_.highest_rad[i] && q[i] > parameters_.lowest_rad[i])
      continue;
    at_stop_ = true;
    q[i] = std::clamp(q[i], parameters_.lowest_rad[i], parameters_.highest_rad[i]);
  }
  q_ = q, rate_ = rate;
}

}  // namespace voxtouch::arm_sim
