#include "devices/phantom/simulated/plant.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

namespace voxtouch::hd_sim {
namespace {

constexpr double kLightestArm = 0.03;  // [kg] apparent mass at the tip, over the workspace
// The mass matrix is nearly diagonal: the projection converges much earlier.
constexpr int kFrictionSweeps = 20;

void require_in(double value, double low, double high, std::string_view field) {
  if (value >= low && value <= high)
    return;
  throw std::runtime_error(
      fmt::format("simulated Phantom: {} is {}, limits [{}, {}]", field, value, low, high));
}

/// The explicit step is stable for these grips only.
const sim::OperatorConfig& checked(const sim::OperatorConfig& hand) {
  hand::checked_grip(hand);
  if (hand.released)
    return hand;
  const double mass = kLightestArm + hand.mass_kg, factor = std::max(1.0, hand.grip_factor);
  require_in(factor * hand.stiffness_n_per_m, 0.0, mass * kSubstepHz * kSubstepHz / 4.0,
             "the hand's stiffness in N/m");
  require_in(factor * hand.damping_ns_per_m, 0.0, mass * kSubstepHz, "the hand's damping in Ns/m");
  return hand;
}

hand::ToolDrag drag_of(const PlantConfig& c) {
  const double arm = c.geometry.thigh_m;
  return {c.viscous_nms_per_rad / (arm * arm), c.coulomb_nm / arm};
}

Vec3 start_of(const PlantConfig& c, const hand::Hand& hand) {
  const auto joints = phantom::phantom_joints(c.geometry, hand.target());
  if (joints)
    return *joints;
  const Vec3 at = hand.target();
  throw std::runtime_error(
      fmt::format("simulated Phantom: the motion starts at ({:.3f}, {:.3f}, {:.3f}) m, out of the "
                  "arm's reach. Start it closer to the origin",
                  at.x(), at.y(), at.z()));
}

}  // namespace

PhantomPlant::PhantomPlant(const PlantConfig& config, const sim::OperatorConfig& hand,
                           const Motion& motion, std::uint64_t seed, double hand_bandwidth_hz)
    : config_(config),
      dynamics_(config.geometry, config.inertia, config.gravity_m_per_s2),
      hand_(checked(hand), motion, kSubstep, seed, drag_of(config), hand_bandwidth_hz),
      joints_(start_of(config, hand_)) {}

void PhantomPlant::set_hand(const sim::OperatorConfig& hand) { hand_.grip_as(checked(hand)); }

/// An end stop only repels, also while the joint leaves it.
Vec3 PhantomPlant::stop_torque(const Vec3& q, const Vec3& v) const noexcept {
  const auto contact_torque = [this](double depth, double speed) {
    return depth > 0.0
               ? std::max(0.0, config_.stop_nm_per_rad * depth + config_.stop_nms_per_rad * speed)
               : 0.0;
  };
  const double fold = q[1] - q[2], fold_speed = v[1] - v[2];
  const double unfold = contact_torque(fold - config_.fold_rad, fold_speed) -
                        contact_torque(-config_.stretch_rad - fold, -fold_speed);
  return {contact_torque(-config_.turret_stop_rad - q[0], -v[0]) -
              contact_torque(q[0] - config_.turret_stop_rad, v[0]),
          contact_torque(config_.thigh_low_rad - q[1], -v[1]) -
              contact_torque(q[1] - config_.thigh_high_rad, v[1]) - unfold,
          unfold};
}

Vec3 PhantomPlant::acceleration(const Vec3& q, const Vec3& v, const Load& load,
                                Mat3* mobility) const noexcept {
  const Mat3 j = phantom::phantom_jacobian(config_.geometry, q);
  // The mass of the hand moves with the tip: J^T m J in the mass matrix, J^T m J' in the velocity
  // terms.
  const Vec3 at_tip =
      load.hand.force(phantom::phantom_tip(config_.geometry, q), j * v) -
      load.hand.mass_kg * (phantom::phantom_jacobian_rate(config_.geometry, q, v) * v);
  Mat3 m = dynamics_.mass(q) + load.hand.mass_kg * (j.transpose() * j);
  Vec3 torque = load.torque + j.transpose() * at_tip + stop_torque(q, v) -
                dynamics_.coriolis(q, v) * v - dynamics_.gravity(q) -
                config_.viscous_nms_per_rad * v;
  for (int i = 0; i < 3; ++i) {
    if (!load.locks.joint[i])
      continue;
    m.row(i).setZero();
    m.col(i).setZero();
    m(i, i) = 1.0;
    torque[i] = 0.0;
  }
  const Mat3 inverse = m.inverse();
  if (mobility != nullptr)
    *mobility = inverse;
  return inverse * torque;
}

/// Friction impulses, one per joint within its bounds, such that the velocity after the step is
/// zero for an impulse inside its bounds: projected Gauss-Seidel over three unknowns.
PhantomPlant::Locks PhantomPlant::resist(Load& load) const noexcept {
  const double most = config_.coulomb_nm * kSubstep;
  Locks stopping;
  if (!(most > 0.0))
    return stopping;
  Mat3 mobility;
  Vec3 after = rates_ + kSubstep * acceleration(joints_, rates_, load, &mobility);
  Vec3 impulse = Vec3::Zero();
  for (int sweep = 0; sweep < kFrictionSweeps; ++sweep) {
    for (int i = 0; i < 3; ++i) {
      const double requested = std::clamp(impulse[i] - after[i] / mobility(i, i), -most, most);
      after += mobility.col(i) * (requested - impulse[i]);
      impulse[i] = requested;
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (std::abs(impulse[i]) >= most)
      continue;
    (rates_[i] == 0.0 ? load.locks : stopping).joint[i] = true;
  }
  load.torque += impulse / kSubstep;
  return stopping;
}

void PhantomPlant::step(const Vec3& motor_torque) noexcept {
  motor_torque_ = motor_torque.cwiseMin(config_.motor_limit_nm).cwiseMax(-config_.motor_limit_nm);
  Load load{hand_.step(), motor_torque_, {}};
  hand_force_ = load.hand.force(tip(), tip_velocity());
  const Locks stopping = resist(load);
  if (load.locks.all())
    return;
  const double h = kSubstep;
  const Vec3 v1 = rates_, a1 = acceleration(joints_, v1, load);
  const Vec3 v2 = rates_ + 0.5 * h * a1, a2 = acceleration(joints_ + 0.5 * h * v1, v2, load);
  const Vec3 v3 = rates_ + 0.5 * h * a2, a3 = acceleration(joints_ + 0.5 * h * v2, v3, load);
  const Vec3 v4 = rates_ + h * a3, a4 = acceleration(joints_ + h * v3, v4, load);
  joints_ += (h / 6.0) * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
  rates_ += (h / 6.0) * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  for (int i = 0; i < 3; ++i)
    if (stopping.joint[i])
      rates_[i] = 0.0;
}

Vec3 PhantomPlant::motor_force() const noexcept {
  const Mat3 j = phantom::phantom_jacobian(config_.geometry, joints_);
  if (!(std::abs(j.determinant()) > 1e-9))
    return Vec3::Zero();
  return j.transpose().inverse() * motor_torque_;
}

}  // namespace voxtouch::hd_sim
