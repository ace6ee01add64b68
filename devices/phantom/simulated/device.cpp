#include "devices/phantom/simulated/device.hpp"

#include <initializer_list>

namespace voxtouch::hd_sim {
namespace {

// Initial observation time of an automatic calibration: assumed.
constexpr std::uint64_t kAutoCalibrationTicks = 50;

}  // namespace

Device::Device(const Settings& s)
    : plant(s.plant, s.hand, s.motion, s.seed, s.hand_bandwidth_hz),
      amplifier(*s.model, s.plant, s.thermal_time_s, s.watchdog_s),
      settings_(s),
      sensors_(s.plant.geometry, s.resolution_m, s.gimbal_resolution_rad, s.velocity_filter_hz) {
  sensors_.zero_at(s.power_on_rad);
  sensors_.set_period(period_s());
  sense();
}

void Device::sense() noexcept {
  if (faults.communication != 0)
    return;
  sensors_.sample(plant.joints(), plant.hand().orientation());
}

phantom::hd::HDerror Device::begin_frame(bool servo_runs) noexcept {
  if (frame_open_)
    return phantom::hd::kIllegalBegin;
  if (servo_runs && framed_this_tick_ && amplifier.limits.one_frame)
    return phantom::hd::kIllegalBegin;
  if (!servo_runs)
    sense();
  frame_open_ = framed_this_tick_ = true;
  current_ = {sensors_.reading(), switches, {}, faults.lost_position != 0};
  if (faults.communication != 0)
    return phantom::hd::kCommError;
  return faults.device != 0 ? phantom::hd::kDeviceFault : phantom::hd::kSuccess;
}

phantom::hd::HDerror Device::end_frame(bool servo_runs) noexcept {
  if (!frame_open_)
    return phantom::hd::kIllegalEnd;
  frame_open_ = false;
  if (!servo_runs) {
    amplifier.release();
    return phantom::hd::kSuccess;
  }
  if (faults.communication != 0)
    return phantom::hd::kCommError;  // no message gets through: the amplifier's watchdog must react
  if (!switches.safety) {
    amplifier.release();
    return phantom::hd::kSuccess;
  }
  return amplifier.flush(current_.setpoint, current_.reading, period_s());
}

void Device::begin_tick(ErrorStack& errors) noexcept {
  framed_this_tick_ = false;
  sense();
  amplifier.set_power(faults.device == 0);
  if (!switches.safety)
    amplifier.release();
  const phantom::hd::HDerror verdict = amplifier.begin_tick(sensors_.reading(), period_s());
  if (verdict != phantom::hd::kSuccess)
    errors.push(verdict, kHandle);
}

void Device::advance(int substeps) noexcept {
  for (int i = 0; i < substeps; ++i)
    plant.step(amplifier.advance(kSubstep));
}

void Device::end_tick() noexcept {
  advance(substeps_);
  for (long* left : {&faults.communication, &faults.device, &faults.lost_position})
    if (*left > 0)
      --*left;
  ++ticks;
}

void Device::set_substeps(int substeps) noexcept {
  substeps_ = substeps;
  sensors_.set_period(period_s());
}

phantom::hd::HDenum Device::calibration() const noexcept {
  if (calibrated_)
    return phantom::hd::kCalibrationOk;
  switch (model().calibration) {
    case phantom::hd::kCalibrationInkwell:
      return switches.inkwell ? phantom::hd::kCalibrationNeedsUpdate
                              : phantom::hd::kCalibrationNeedsManualInput;
    case phantom::hd::kCalibrationAuto:
      return ticks >= kAutoCalibrationTicks ? phantom::hd::kCalibrationNeedsUpdate
                                            : phantom::hd::kCalibrationNeedsManualInput;
    default:
      return phantom::hd::kCalibrationNeedsManualInput;
  }
}

phantom::hd::HDerror Device::calibrate(phantom::hd::HDenum style, bool servo_runs) noexcept {
  if (style != model().calibration)
    return phantom::hd::kInvalidValue;
  if (servo_runs && amplifier.limits.force_output)
    return phantom::hd::kInvalidOperation;
  if (style == phantom::hd::kCalibrationEncoderReset) {
    // At time zero the simulated operator follows the request and holds the links at right angles.
    // Later the encoders are zeroed at the present pose, as on a real device.
    sensors_.zero_at(ticks == 0 ? settings_.reset_error_rad : plant.joints());
  } else {
    if (!servo_runs || calibration() == phantom::hd::kCalibrationNeedsManualInput)
      return phantom::hd::kInvalidOperation;
    sensors_.zero_at(Vec3::Zero());
  }
  calibrated_ = true;
  sense();
  return phantom::hd::kSuccess;
}

}  // namespace voxtouch::hd_sim
