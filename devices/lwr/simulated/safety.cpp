#include "devices/lwr/simulated/safety.hpp"

#include <cmath>

namespace voxtouch::lwr_sim {
namespace {

/// Rounding of floats on the wire must not make a command over its limit.
constexpr double kSlack = 1.0 + 1e-5;

/// The joints whose |value| is over its limit; NaN is over any.
std::uint16_t over(const LwrJoints& value, const LwrJoints& limit) noexcept {
  std::uint16_t bits = 0;
  for (int i = 0; i < 7; ++i)
    if (!(std::abs(value[i]) <= kSlack * limit[i])) bits = static_cast<std::uint16_t>(bits | (1U << i));
  return bits;
}

template <class V>
bool within(const V& values, double low, double high) noexcept {
  return (values.array() >= low).all() && (values.array() <= kSlack * high).all();
}

bool gains_fit(const SafetyRules& rules, fri::Control control, const Setpoint& s) noexcept {
  if (control == fri::Control::kCartesianImpedance)
    return within(s.cart_stiffness.head<3>(), 0.0, rules.max_cart_stiffness) &&
           within(s.cart_stiffness.tail<3>(), 0.0, rules.max_cart_rotational_stiffness) &&
           within(s.cart_damping, 0.0, 1.0);
  return within(s.stiffness, 0.0, rules.max_stiffness_nm_per_rad) && within(s.damping, 0.0, 1.0);
}

}  // namespace

std::string_view sentence_of(Reason reason) noexcept {
  switch (reason) {
    case Reason::kNone: return "nothing is wrong";
    case Reason::kAsked: return "friStop, as the remote side asked";
    case Reason::kMisses: return "too many answers were missing";
    case Reason::kClosed: return "friClose";
    case Reason::kNotFinite: return "a command held a number that is none";
    case Reason::kFlagsChanged: return "the command flags changed in command mode";
    case Reason::kJump: return "the last commanded position is not the mirrored one";
    case Reason::kCommandSpeed: return "a commanded position moved faster than the joint may";
    case Reason::kCommandPosition: return "a commanded position is out of the joint's range";
    case Reason::kDeviation: return "a commanded position is too far from the measured one";
    case Reason::kTorque: return "a commanded torque or force is over its limit";
    case Reason::kGains: return "a commanded stiffness or damping is out of range";
    case Reason::kJointSpeed: return "a joint was faster than it may be";
    case Reason::kElbowStretched: return "the elbow is too straight for Cartesian impedance";
    case Reason::kEmergencyStop: return "emergency stop";
    case Reason::kDrivesOff: return "drives went off";
    case Reason::kQualityForced: return "the quality was made bad by a fault of the simulation";
  }
  return "unknown";
}

Violation check_command(const SafetyRules& rules, fri::Control control, const Setpoint& before, const Setpoint& now,
                        double elapsed_s, const LwrJoints& q, const Pose& tool) noexcept {
  const LwrJoints all_deviation = LwrJoints::Constant(rules.max_deviation_rad);
  if (const auto j = over(now.position, rules.max_position_rad)) return {Reason::kCommandPosition, j};
  // The wire rounds positions to floats: a rounding step in a millisecond is no speed.
  const LwrJoints most = rules.max_speed_rad_s * elapsed_s + LwrJoints::Constant(1e-6);
  if (const auto j = over(now.position - before.position, most)) return {Reason::kCommandSpeed, j};
  if (const auto j = over(now.position - q, all_deviation)) return {Reason::kDeviation, j};
  if (const auto j = over(now.torque, rules.max_torque_nm)) return {Reason::kTorque, j};
  if (!gains_fit(rules, control, now)) return {Reason::kGains, 0};
  if (control != fri::Control::kCartesianImpedance) return {};
  if (!((now.pose.position - tool.position).norm() <= rules.max_pose_deviation_m)) return {Reason::kDeviation, 0};
  const bool strong = !(now.wrench.head<3>().norm() <= kSlack * rules.max_force_n) ||
                      !(now.wrench.tail<3>().norm() <= kSlack * rules.max_wrench_torque_nm);
  return strong ? Violation{Reason::kTorque, 0} : Violation{};
}

Violation check_motion(const SafetyRules& rules, const LwrJoints& rate) noexcept {
  const auto joints = over(rate, rules.max_speed_rad_s);
  return joints ? Violation{Reason::kJointSpeed, joints} : Violation{};
}

Violation check_entry(const SafetyRules& rules, fri::Control control, const LwrJoints& mirrored,
                      const LwrJoints& expected, const LwrJoints& q) noexcept {
  if (const auto j = over(mirrored - expected, LwrJoints::Constant(rules.jump_rad))) return {Reason::kJump, j};
  if (control == fri::Control::kCartesianImpedance && !(std::abs(q[3]) >= rules.least_elbow_rad))
    return {Reason::kElbowStretched, 1U << 3};
  return {};
}

}  // namespace voxtouch::lwr_sim
