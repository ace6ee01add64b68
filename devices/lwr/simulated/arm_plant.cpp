#include "devices/lwr/simulated/arm_plant.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace voxtouch::lwr_sim {
namespace {

constexpr int kSweeps = 60;           // of the impulses' iteration; it converges in a few
constexpr double kConverged = 1e-13;  // [rad/s] change of a rate in one sweep

Wrench wrench_of(const hand::HandAction& hand, const ArmDynamics::Terms& terms) noexcept {
  return {hand.force(terms.tool.position, terms.twist.linear),
          hand.torque(terms.tool.orientation, terms.twist.angular)};
}

}  // namespace

PlantParameters lwr_plant(double torque_feedback_gain) {
  PlantParameters p;
  p.inertia = lwr_inertia(torque_feedback_gain);
  p.viscous_nms_per_rad << 1.0, 1.2, 0.9, 0.8, 0.5, 0.3, 0.2;
  p.viscous_nms_per_rad /= torque_feedback_gain;
  p.coulomb_nm << 0.5, 0.8, 0.4, 0.3, 0.2, 0.1, 0.05;
  p.coulomb_nm /= torque_feedback_gain;
  const lwr::LwrLimits limits = lwr::lwr_limits();
  p.torque_limit_nm = limits.torque_nm;
  p.position_limit_rad = limits.position_rad;
  p.brake_nm = 2.0 * limits.torque_nm;
  return p;
}

ArmPlant::ArmPlant(const PlantParameters& parameters, const lwr::LwrJoints& q)
    : parameters_(parameters), dynamics_(parameters.inertia, parameters.pose_FT),
      q_(q) {
  sensed_ = dynamics_.at(q_, rate_).gravity;
}

lwr::LwrJoints ArmPlant::drive_torque(const Step& step, const lwr::LwrJoints& gravity) const noexcept {
  if (step.drives == Drives::kBraked) return lwr::LwrJoints::Zero();
  return (step.torque + gravity).cwiseMin(parameters_.torque_limit_nm).cwiseMax(-parameters_.torque_limit_nm);
}

ArmPlant::Slope ArmPlant::slope(const Step& step, const lwr::LwrJoints& q, const lwr::LwrJoints& rate,
                                ArmDynamics::Terms& terms) const noexcept {
  terms = dynamics_.at(q, rate, {step.hand.mass_kg, step.hand.inertia_kg_m2});
  const lwr::LwrJoints push = drive_torque(step, terms.gravity) - terms.gravity - terms.coriolis -
                         parameters_.viscous_nms_per_rad.cwiseProduct(rate) +
                         lwr::joint_torque(terms.jacobian, wrench_of(step.hand, terms));
  return {rate, terms.mass.llt().solve(push)};
}

lwr::LwrJoints ArmPlant::sticking_impulse(const LwrMatrix& mass, const lwr::LwrJoints& q, const lwr::LwrJoints& rate, Drives drives,
                                    double dt_s) noexcept {
  lwr::LwrJoints low, high;
  high = dt_s * parameters_.coulomb_nm;
  if (drives == Drives::kBraked) high += dt_s * parameters_.brake_nm;
  low = -high;
  at_stop_ = false;
  for (int i = 0; i < 7; ++i) {
    const double limit = parameters_.position_limit_rad[i];
    if (q[i] >= limit) low[i] = -std::numeric_limits<double>::infinity();
    if (q[i] <= -limit) high[i] = std::numeric_limits<double>::infinity();
  }
  if (low.isZero(0.0) && high.isZero(0.0)) return lwr::LwrJoints::Zero();
  const lwr::LwrJoints full = -(mass * rate);  // brings all joints to rest
  if ((full.array() >= low.array()).all() && (full.array() <= high.array()).all()) return full;

  // Projected Gauss-Seidel on the joints' rates: each joint in turn takes what brings it to rest, as far as its bounds allow.
  const LwrMatrix mobility = mass.llt().solve(LwrMatrix::Identity());
  lwr::LwrJoints impulse = lwr::LwrJoints::Zero(), left = rate;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double change = 0.0;
    for (int i = 0; i < 7; ++i) {
      const double wanted = std::clamp(impulse[i] - left[i] / mobility(i, i), low[i], high[i]);
      const double more = wanted - impulse[i];
      impulse[i] = wanted;
      left += more * mobility.col(i);
      change = std::max(change, std::abs(more) * mobility(i, i));
    }
    if (change < kConverged) break;
  }
  return impulse;
}

void ArmPlant::step(const lwr::LwrJoints& torque, Drives drives, const hand::HandAction& hand, double dt_s) noexcept {
  const Step step{torque, drives, hand};
  const double half = 0.5 * dt_s;
  ArmDynamics::Terms start, tried;
  const Slope a = slope(step, q_, rate_, start);
  const Slope b = slope(step, q_ + half * a.rate, rate_ + half * a.acceleration, tried);
  const Slope c = slope(step, q_ + half * b.rate, rate_ + half * b.acceleration, tried);
  const Slope d = slope(step, q_ + dt_s * c.rate, rate_ + dt_s * c.acceleration, tried);
  const double sixth = dt_s / 6.0;
  const lwr::LwrJoints before = rate_;
  lwr::LwrJoints q = q_ + sixth * (a.rate + 2.0 * (b.rate + c.rate) + d.rate);
  lwr::LwrJoints rate = rate_ + sixth * (a.acceleration + 2.0 * (b.acceleration + c.acceleration) + d.acceleration);

  hand_wrench_ = wrench_of(hand, start);
  const lwr::LwrJoints impulse = sticking_impulse(start.mass, q, rate, drives, dt_s);
  sensed_ = drive_torque(step, start.gravity) + impulse / dt_s;
  if (!impulse.isZero(0.0)) {
    const lwr::LwrJoints change = start.mass.llt().solve(impulse);
    lwr::LwrJoints stuck = rate + change;
    // Rounding is no motion: what friction holds stays exactly where it is.
    for (int i = 0; i < 7; ++i)
      if (std::abs(stuck[i]) < 1e-12 && std::abs(before[i]) < 1e-12) stuck[i] = 0.0;
    q += half * change;
    rate = stuck;
    for (int i = 0; i < 7; ++i)
      if (rate[i] == 0.0 && before[i] == 0.0) q[i] = q_[i];
  }
  for (int i = 0; i < 7; ++i) {
    const double limit = parameters_.position_limit_rad[i];
    if (std::abs(q[i]) < limit) continue;
    at_stop_ = true;
    q[i] = std::copysign(limit, q[i]);
  }
  q_ = q, rate_ = rate;
}

}  // namespace voxtouch::lwr_sim
