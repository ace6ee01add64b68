#include "devices/lwr/simulated/safety.hpp"

#include <cmath>

namespace voxtouch::lwr_sim {
namespace {

/// Rounding of floats on the wire must not violate a limit.
constexpr double kSlack = 1.0 + 1e-5;

/// The joints with |value| above the limit; NaN counts as above.
std::uint16_t over(const lwr::LwrJoints& value, const lwr::LwrJoints& limit) noexcept {
  std::uint16_t bits = 0;
  for (int i = 0; i < 7; ++i)
    if (!(std::abs(value[i]) <= kSlack * limit[i]))
      bits = static_cast<std::uint16_t>(bits | (1U << i));
  return bits;
}

bool within(const lwr::LwrJoints& values, double high) noexcept {
  return (values.array() >= 0.0).all() && (values.array() <= kSlack * high).all();
}

}  // namespace

std::string_view sentence_of(Reason reason) noexcept {
  switch (reason) {
    case Reason::kNone:
      return "no error";
    case Reason::kAsked:
      return "friStop on request of the remote side";
    case Reason::kMisses:
      return "too many missing replies";
    case Reason::kClosed:
      return "friClose";
    case Reason::kNotFinite:
      return "a command had NaN or infinity";
    case Reason::kFlagsChanged:
      return "the command flags changed in command mode";
    case Reason::kJump:
      return "the last commanded position differs from the mirrored one";
    case Reason::kCommandSpeed:
      return "a commanded position exceeded the joint's speed limit";
    case Reason::kCommandPosition:
      return "a commanded position is outside the joint's range";
    case Reason::kDeviation:
      return "a commanded position is too far from the measured one";
    case Reason::kTorque:
      return "a commanded torque or force exceeds its limit";
    case Reason::kGains:
      return "a commanded stiffness or damping is out of range";
    case Reason::kJointSpeed:
      return "a joint exceeded its speed limit";
    case Reason::kEmergencyStop:
      return "emergency stop";
    case Reason::kDrivesOff:
      return "drives went off";
    case Reason::kQualityForced:
      return "simulated fault: bad connection quality";
  }
  return "unknown";
}

Violation check_command(const SafetyRules& rules, const Setpoint& before, const Setpoint& now,
                        double elapsed_s, const lwr::LwrJoints& q) noexcept {
  const lwr::LwrJoints all_deviation = lwr::LwrJoints::Constant(rules.max_deviation_rad);
  if (const auto j = over(now.position, rules.max_position_rad))
    return {Reason::kCommandPosition, j};
  // The wire rounds positions to floats: a rounding step in a millisecond is not a speed.
  const lwr::LwrJoints most = rules.max_speed_rad_s * elapsed_s + lwr::LwrJoints::Constant(1e-6);
  if (const auto j = over(now.position - before.position, most))
    return {Reason::kCommandSpeed, j};
  if (const auto j = over(now.position - q, all_deviation))
    return {Reason::kDeviation, j};
  if (const auto j = over(now.torque, rules.max_torque_nm))
    return {Reason::kTorque, j};
  const bool gains_fit =
      within(now.stiffness, rules.max_stiffness_nm_per_rad) && within(now.damping, 1.0);
  return gains_fit ? Violation{} : Violation{Reason::kGains, 0};
}

Violation check_motion(const SafetyRules& rules, const lwr::LwrJoints& rate) noexcept {
  const auto joints = over(rate, rules.max_speed_rad_s);
  return joints ? Violation{Reason::kJointSpeed, joints} : Violation{};
}

Violation check_entry(const SafetyRules& rules, const lwr::LwrJoints& mirrored,
                      const lwr::LwrJoints& expected) noexcept {
  const auto joints = over(mirrored - expected, lwr::LwrJoints::Constant(rules.jump_rad));
  return joints ? Violation{Reason::kJump, joints} : Violation{};
}

}  // namespace voxtouch::lwr_sim
