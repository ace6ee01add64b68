#include "devices/phantom/simulated/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace voxtouch::hd_sim {
namespace {

constexpr double kMilli = 1000.0;  // mm in a metre, mNm in a newton metre
// Of the data sheet, from memory: the arm does not reach its corners. It reaches all of half of it, between its stops.
constexpr std::array kReach{-187.5, -135.0, -97.5, 187.5, 135.0, 97.5};

struct Shown {
  unsigned types = 0;  // 0: no such parameter
  Values values;
};

Values list(std::initializer_list<double> all) {
  Values v;
  for (double x : all) v.value[static_cast<std::size_t>(v.count++)] = x;
  return v;
}
Values vector(const Vec3& v, double scale = 1.0) { return list({scale * v.x(), scale * v.y(), scale * v.z()}); }
Values torque(const std::optional<Vec3>& v) { return vector(v.value_or(Vec3::Zero()), kMilli); }
Values joint_torque(const std::optional<Vec3>& v) {
  return vector(phantom::to_library_angles(v.value_or(Vec3::Zero())), kMilli);
}

template <class Array>
Values longs(const Array& all) {
  Values v;
  for (long x : all) v.value[static_cast<std::size_t>(v.count++)] = static_cast<double>(x);
  return v;
}

Vec3 position_of(const Frame& f) {
  return f.position_lost ? Vec3(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())) : f.reading.pose.position;
}

Values transform(const Frame& f) {
  Values v;
  v.count = 16;
  Eigen::Map<Eigen::Matrix4d> m(v.value.data());  // column-major, as the interface has it
  m.setIdentity();
  m.topLeftCorner<3, 3>() = f.reading.pose.orientation.toRotationMatrix();
  m.topRightCorner<3, 1>() = kMilli * position_of(f);
  return v;
}

/// What a frame saw, by the number of the current one.
Shown of_frame(const Frame& f, phantom::hd::HDenum name) {
  const Setpoint& s = f.setpoint;
  switch (name) {
    case phantom::hd::kCurrentButtons: return {kInteger, list({double(f.switches.buttons)})};
    case phantom::hd::kCurrentSafetySwitch: return {kBoolean, list({f.switches.safety ? 1.0 : 0.0})};
    case phantom::hd::kCurrentInkwellSwitch: return {kBoolean, list({f.switches.inkwell ? 1.0 : 0.0})};
    case phantom::hd::kCurrentEncoderValues: return {kLong, longs(f.reading.counts)};
    case phantom::hd::kCurrentPosition: return {kReal, vector(position_of(f), kMilli)};
    case phantom::hd::kCurrentVelocity: return {kReal, vector(f.reading.twist.linear, kMilli)};
    case phantom::hd::kCurrentTransform: return {kReal, transform(f)};
    case phantom::hd::kCurrentAngularVelocity: return {kReal, vector(f.reading.twist.angular)};
    case phantom::hd::kCurrentJointAngles: return {kReal, vector(phantom::to_library_angles(f.reading.joints))};
    case phantom::hd::kCurrentGimbalAngles: return {kReal, vector(f.reading.gimbal)};
    case phantom::hd::kCurrentForce: return {kReal, vector(s.force.value_or(Vec3::Zero()))};
    case phantom::hd::kCurrentTorque: return {kReal, torque(s.torque)};
    case phantom::hd::kCurrentJointTorque: return {kReal, joint_torque(s.joint_torque)};
    case phantom::hd::kCurrentGimbalTorque: return {kReal, torque(s.gimbal_torque)};
    case phantom::hd::kCurrentMotorDacValues: return {kLong, longs(s.dac.value_or(std::array<long, 3>{}))};
    default: return {};
  }
}

/// The number of the current value to one of the last frame; 0: it is none of those.
phantom::hd::HDenum current_of_last(phantom::hd::HDenum name) {
  switch (name) {
    case phantom::hd::kLastForce: return phantom::hd::kCurrentForce;
    case phantom::hd::kLastTorque: return phantom::hd::kCurrentTorque;
    case phantom::hd::kLastJointTorque: return phantom::hd::kCurrentJointTorque;
    case phantom::hd::kLastGimbalTorque: return phantom::hd::kCurrentGimbalTorque;
    case phantom::hd::kLastMotorDacValues: return phantom::hd::kCurrentMotorDacValues;
    default: return name >= 0x2200 && name <= 0x2350 ? name - 0x200 : 0;
  }
}

Shown of_device(const Device& d, const Rates& rates, phantom::hd::HDenum name) {
  const Limits& l = d.amplifier.limits;
  const Model& m = d.model();
  switch (name) {
    case phantom::hd::kMaxWorkspaceDimensions:
    case phantom::hd::kUsableWorkspaceDimensions: {
      Values box;
      const double share = name == phantom::hd::kUsableWorkspaceDimensions ? 0.5 : 1.0;
      for (const double x : kReach) box.value[static_cast<std::size_t>(box.count++)] = share * x;
      return {kReal, box};
    }
    case phantom::hd::kTabletopOffset: return {kReal, list({-kMilli * d.plant.config().geometry.shin_m})};
    case phantom::hd::kInputDof: return {kInteger, list({6.0})};
    case phantom::hd::kOutputDof: return {kInteger, list({double(m.output_dof)})};
    case phantom::hd::kCalibrationStyle: return {kInteger, list({double(m.calibration)})};
    case phantom::hd::kUpdateRate: return {kInteger, list({std::round(rates.mean_hz)})};
    case phantom::hd::kInstantaneousUpdateRate: return {kInteger, list({std::round(rates.last_hz)})};
    case phantom::hd::kNominalMaxStiffness: return {kReal, list({m.stiffness_n_per_mm})};
    case phantom::hd::kNominalMaxForce: return {kReal, list({m.max_force_n})};
    case phantom::hd::kNominalMaxContinuousForce: return {kReal, list({m.continuous_force_n})};
    case phantom::hd::kNominalMaxDamping: return {kReal, list({m.damping})};
    case phantom::hd::kNominalMaxTorqueStiffness:
    case phantom::hd::kNominalMaxTorqueDamping:
    case phantom::hd::kNominalMaxTorqueForce:
    case phantom::hd::kNominalMaxTorqueContinuousForce:
      return {kReal, list({0.0})};  // the arm that is simulated gives no torque
    case phantom::hd::kMotorTemperature: {
      Values v = vector(d.amplifier.temperature());
      v.count = m.output_dof;  // motors of a gimbal stay cold
      return {kReal, v};
    }
    case phantom::hd::kSoftwareVelocityLimit: return {kReal, list({kMilli * l.velocity_limit_m_per_s})};
    case phantom::hd::kSoftwareForceImpulseLimit: return {kReal, list({l.impulse_limit_n_per_ms})};
    case phantom::hd::kForceRampingRate: return {kReal, list({l.ramp_n_per_s})};
    case phantom::hd::kUserStatusLight: return {kInteger, list({double(d.status_light)})};
    default: return {};
  }
}

phantom::hd::HDerror set_dac(Setpoint& s, const Values& in) {
  std::array<long, 3> dac{};
  for (int i = 0; i < in.count; ++i) {
    const double x = in.value[static_cast<std::size_t>(i)];
    if (!(x >= -32767.0 && x <= 32766.0)) return phantom::hd::kInvalidValue;
    dac[static_cast<std::size_t>(i)] = static_cast<long>(x);
  }
  s.dac = dac;
  return phantom::hd::kSuccess;
}

phantom::hd::HDerror set_positive(double& out, double value) {
  if (!(value > 0.0)) return phantom::hd::kInvalidValue;
  out = value;
  return phantom::hd::kSuccess;
}

/// Of the frame that is open.
phantom::hd::HDerror set_output(Device& device, phantom::hd::HDenum name, const Values& in) {
  if (!device.frame_open()) return phantom::hd::kFrameError;
  Setpoint& s = device.setpoint();
  const Vec3 v(in.value[0], in.value[1], in.value[2]);
  switch (name) {
    case phantom::hd::kCurrentForce: s.force = v; return phantom::hd::kSuccess;
    case phantom::hd::kCurrentJointTorque: s.joint_torque = phantom::to_library_angles(v) / kMilli; return phantom::hd::kSuccess;
    case phantom::hd::kCurrentMotorDacValues: return set_dac(s, in);
    default: break;
  }
  if (device.model().output_dof < 6) return phantom::hd::kInvalidOperation;  // there are no motors for it: assumed
  (name == phantom::hd::kCurrentTorque ? s.torque : s.gimbal_torque) = v / kMilli;
  return phantom::hd::kSuccess;
}

}  // namespace

phantom::hd::HDerror read_parameter(const Device& device, const Rates& rates, phantom::hd::HDenum name, Type type, Values& out) noexcept {
  const phantom::hd::HDenum of_last = current_of_last(name);
  Shown shown = of_last != 0 ? of_frame(device.last(), of_last) : of_frame(device.current(), name);
  if (shown.types == 0 && of_last == 0) shown = of_device(device, rates, name);
  if (shown.types == 0) return phantom::hd::kInvalidEnum;
  if ((shown.types & type) == 0) return phantom::hd::kInvalidInputType;
  out = shown.values;
  return phantom::hd::kSuccess;
}

phantom::hd::HDerror settable(phantom::hd::HDenum name, Type type, int& count) noexcept {
  unsigned types = kReal;
  switch (name) {
    case phantom::hd::kCurrentForce:
    case phantom::hd::kCurrentTorque:
    case phantom::hd::kCurrentJointTorque:
    case phantom::hd::kCurrentGimbalTorque: count = 3; break;
    case phantom::hd::kCurrentMotorDacValues: types = kLong, count = 3; break;
    case phantom::hd::kSoftwareVelocityLimit:
    case phantom::hd::kSoftwareForceImpulseLimit:
    case phantom::hd::kForceRampingRate: count = 1; break;
    case phantom::hd::kUserStatusLight: types = kInteger, count = 1; break;
    default: return phantom::hd::kInvalidEnum;
  }
  return (types & type) != 0 ? phantom::hd::kSuccess : phantom::hd::kInvalidInputType;
}

phantom::hd::HDerror write_parameter(Device& device, phantom::hd::HDenum name, const Values& in) noexcept {
  for (int i = 0; i < in.count; ++i) {
    if (std::isfinite(in.value[static_cast<std::size_t>(i)])) continue;
    ++device.non_finite_sets;
    return phantom::hd::kInvalidValue;
  }
  Limits& l = device.amplifier.limits;
  switch (name) {
    case phantom::hd::kSoftwareVelocityLimit: return set_positive(l.velocity_limit_m_per_s, in.value[0] / kMilli);
    case phantom::hd::kSoftwareForceImpulseLimit: return set_positive(l.impulse_limit_n_per_ms, in.value[0]);
    case phantom::hd::kForceRampingRate: return set_positive(l.ramp_n_per_s, in.value[0]);
    case phantom::hd::kUserStatusLight:
      if (!(in.value[0] >= 0.0 && in.value[0] <= 7.0)) return phantom::hd::kInvalidValue;
      device.status_light = static_cast<int>(in.value[0]);
      return phantom::hd::kSuccess;
    default: return set_output(device, name, in);
  }
}

phantom::hd::HDstring read_string(const Model& model, phantom::hd::HDenum name) noexcept {
  switch (name) {
    case phantom::hd::kVersion: return "3.4.0";
    case phantom::hd::kDeviceModelType: return model.type;
    case phantom::hd::kDeviceDriverVersion: return "simulated";
    case phantom::hd::kDeviceVendor: return "voxtouch, simulated";
    case phantom::hd::kDeviceSerialNumber: return "0";
    default: return nullptr;
  }
}

bool* capability(Limits& l, phantom::hd::HDenum name) noexcept {
  switch (name) {
    case phantom::hd::kForceOutput: return &l.force_output;
    case phantom::hd::kMaxForceClamping: return &l.clamping;
    case phantom::hd::kForceRamping: return &l.ramping;
    case phantom::hd::kSoftwareForceLimit: return &l.force_limit;
    case phantom::hd::kOneFrameLimit: return &l.one_frame;
    case phantom::hd::kSoftwareVelocityLimit: return &l.velocity_limit_on;
    case phantom::hd::kSoftwareForceImpulseLimit: return &l.impulse_limit_on;
    default: return nullptr;
  }
}

}  // namespace voxtouch::hd_sim
