#include "devices/phantom/simulated/parameters.hpp"

#include <cmath>
#include <limits>

namespace voxtouch::hd_sim {
namespace {

constexpr double kMilli = 1000.0;  // mm per metre, mNm per newton metre

struct ReadValue {
  Type type = Type::kNone;
  Values values;
};

Values list(std::initializer_list<double> all) {
  Values v;
  for (double x : all)
    v.value[static_cast<std::size_t>(v.count++)] = x;
  return v;
}
Values vector(const Vec3& v, double scale = 1.0) {
  return list({scale * v.x(), scale * v.y(), scale * v.z()});
}

Vec3 position_of(const Frame& f) {
  return f.position_lost ? Vec3(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()))
                         : f.reading.pose.position;
}

Values transform(const Frame& f) {
  Values v;
  v.count = 16;
  Eigen::Map<Eigen::Matrix4d> m(v.value.data());  // column-major, as in the interface
  m.setIdentity();
  m.topLeftCorner<3, 3>() = f.reading.pose.orientation.toRotationMatrix();
  m.topRightCorner<3, 1>() = kMilli * position_of(f);
  return v;
}

/// Values captured by a frame.
ReadValue of_frame(const Frame& f, phantom::hd::HDenum name) {
  switch (name) {
    case phantom::hd::kCurrentButtons:
      return {Type::kInteger, list({double(f.switches.buttons)})};
    case phantom::hd::kCurrentPosition:
      return {Type::kDouble, vector(position_of(f), kMilli)};
    case phantom::hd::kCurrentVelocity:
      return {Type::kDouble, vector(f.reading.twist.linear, kMilli)};
    case phantom::hd::kCurrentTransform:
      return {Type::kDouble, transform(f)};
    case phantom::hd::kCurrentForce:
      return {Type::kDouble, vector(f.setpoint.force.value_or(Vec3::Zero()))};
    case phantom::hd::kCurrentTorque:
      return {Type::kDouble, vector(f.setpoint.torque.value_or(Vec3::Zero()), kMilli)};
    default:
      return {};
  }
}

ReadValue of_device(const Device& d, double mean_rate_hz, phantom::hd::HDenum name) {
  const Model& m = d.model();
  switch (name) {
    case phantom::hd::kInputDof:
      return {Type::kInteger, list({6.0})};
    case phantom::hd::kOutputDof:
      return {Type::kInteger, list({double(m.output_dof)})};
    case phantom::hd::kCalibrationStyle:
      return {Type::kInteger, list({double(m.calibration)})};
    case phantom::hd::kUpdateRate:
      return {Type::kInteger, list({std::round(mean_rate_hz)})};
    case phantom::hd::kNominalMaxStiffness:
      return {Type::kDouble, list({m.stiffness_n_per_mm})};
    case phantom::hd::kNominalMaxForce:
      return {Type::kDouble, list({m.max_force_n})};
    case phantom::hd::kNominalMaxContinuousForce:
      return {Type::kDouble, list({m.continuous_force_n})};
    case phantom::hd::kNominalMaxTorqueForce:
      return {Type::kDouble, list({0.0})};  // the simulated arm gives no torque
    case phantom::hd::kMotorTemperature: {
      Values v = vector(d.amplifier.temperature());
      v.count = m.output_dof;  // motors of a gimbal stay cold
      return {Type::kDouble, v};
    }
    case phantom::hd::kSoftwareForceImpulseLimit:
      return {Type::kDouble, list({d.amplifier.limits.impulse_limit_n_per_ms})};
    default:
      return {};
  }
}

phantom::hd::HDerror set_positive(double& out, double value) {
  if (!(value > 0.0))
    return phantom::hd::kInvalidValue;
  out = value;
  return phantom::hd::kSuccess;
}

/// Sets a value of the open frame.
phantom::hd::HDerror set_output(Device& device, phantom::hd::HDenum name, const Values& in) {
  if (!device.frame_open())
    return phantom::hd::kFrameError;
  Setpoint& s = device.setpoint();
  const Vec3 v(in.value[0], in.value[1], in.value[2]);
  if (name == phantom::hd::kCurrentForce) {
    s.force = v;
    return phantom::hd::kSuccess;
  }
  if (device.model().output_dof < 6)
    return phantom::hd::kInvalidOperation;  // there are no motors for it: assumed
  s.torque = v / kMilli;
  return phantom::hd::kSuccess;
}

}  // namespace

phantom::hd::HDerror read_parameter(const Device& device, double mean_rate_hz,
                                    phantom::hd::HDenum name, Type type, Values& out) noexcept {
  ReadValue value = of_frame(device.current(), name);
  if (value.type == Type::kNone)
    value = of_device(device, mean_rate_hz, name);
  if (value.type == Type::kNone)
    return phantom::hd::kInvalidEnum;
  if (value.type != type)
    return phantom::hd::kInvalidInputType;
  out = value.values;
  return phantom::hd::kSuccess;
}

int settable(phantom::hd::HDenum name) noexcept {
  switch (name) {
    case phantom::hd::kCurrentForce:
    case phantom::hd::kCurrentTorque:
      return 3;
    case phantom::hd::kSoftwareVelocityLimit:
    case phantom::hd::kSoftwareForceImpulseLimit:
      return 1;
    default:
      return 0;
  }
}

phantom::hd::HDerror write_parameter(Device& device, phantom::hd::HDenum name,
                                     const Values& in) noexcept {
  for (int i = 0; i < in.count; ++i) {
    if (std::isfinite(in.value[static_cast<std::size_t>(i)]))
      continue;
    ++device.non_finite_sets;
    return phantom::hd::kInvalidValue;
  }
  Limits& l = device.amplifier.limits;
  switch (name) {
    case phantom::hd::kSoftwareVelocityLimit:
      return set_positive(l.velocity_limit_m_per_s, in.value[0] / kMilli);
    case phantom::hd::kSoftwareForceImpulseLimit:
      return set_positive(l.impulse_limit_n_per_ms, in.value[0]);
    default:
      return set_output(device, name, in);
  }
}

bool* capability(Limits& l, phantom::hd::HDenum name) noexcept {
  switch (name) {
    case phantom::hd::kForceOutput:
      return &l.force_output;
    case phantom::hd::kMaxForceClamping:
      return &l.clamping;
    case phantom::hd::kForceRamping:
      return &l.ramping;
    case phantom::hd::kSoftwareForceLimit:
      return &l.force_limit;
    case phantom::hd::kOneFrameLimit:
      return &l.one_frame;
    case phantom::hd::kSoftwareVelocityLimit:
      return &l.velocity_limit_on;
    case phantom::hd::kSoftwareForceImpulseLimit:
      return &l.impulse_limit_on;
    default:
      return nullptr;
  }
}

}  // namespace voxtouch::hd_sim
