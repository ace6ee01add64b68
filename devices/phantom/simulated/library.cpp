#include "devices/phantom/simulated/library.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace voxtouch::hd_sim {

Library& Library::instance() {
  static Library* const library = new Library;
  return *library;
}

Library::Library() {
  if (const char* text = std::getenv("VOXTOUCH_HD_SIM")) {
    try {
      Settings candidate;
      read_settings(candidate, text);
      power_on(candidate);
      return;
    } catch (const std::runtime_error& e) {
      broken_ = e.what();
      std::fprintf(stderr, "VOXTOUCH_HD_SIM: %s; no device will be found\n", e.what());
    }
  }
  const std::string broken = broken_;
  power_on({});
  broken_ = broken;
}

void Library::power_on(const Settings& settings) {
  if (open_ || running_)
    throw std::runtime_error(
        "simulated Phantom: cannot change while a device is open or the scheduler runs");
  device_ = std::make_unique<Device>(settings);
  settings_ = settings;
  broken_.clear();
  errors_ = {};
  callbacks_.clear();
  substeps_ = 8;
  fail_init_ = phantom::hd::kSuccess;
  fail_start_ = false;
  skip_ticks_ = 0;
  late_s_ = 0.0;
  ticks_without_callbacks_ = 0;
  mean_rate_hz_ = 0.0;
}

void Library::note(phantom::hd::HDerror code) {
  if (code != phantom::hd::kSuccess)
    errors_.push(code, open_ ? kHandle : phantom::hd::kInvalidHandle);
}

void Library::fail(phantom::hd::HDerror code) {
  const Lock lock(mutex_);
  note(code);
}

phantom::hd::HDErrorInfo Library::pop_error() {
  const Lock lock(mutex_);
  return errors_.pop();
}

bool Library::opened() {
  if (!open_)
    note(phantom::hd::kInvalidOperation);
  return open_;
}

bool Library::usable(phantom::hd::HHD device) {
  if (open_ && device == kHandle)
    return true;
  note(phantom::hd::kBadHandle);
  return false;
}

phantom::hd::HHD Library::init(phantom::hd::HDstring name) {
  const Lock lock(mutex_);
  const std::string_view requested = name == nullptr ? "" : name;
  phantom::hd::HDerror failure = std::exchange(fail_init_, phantom::hd::kSuccess);
  if (open_)
    failure = phantom::hd::kDeviceAlreadyInitiated;
  const bool known =
      name == nullptr || requested == "Default PHANToM" || requested == "Default Device";
  if (failure == phantom::hd::kSuccess && (!known || !broken_.empty()))
    failure = phantom::hd::kCommConfigError;
  if (failure != phantom::hd::kSuccess) {
    errors_.push(failure, phantom::hd::kInvalidHandle);
    return phantom::hd::kInvalidHandle;
  }
  open_ = true;
  device_->amplifier.limits = {};
  device_->amplifier.release();
  device_->set_substeps(substeps_);
  return kHandle;
}

void Library::disable(phantom::hd::HHD device) {
  const Lock lock(mutex_);
  if (!usable(device))
    return;
  device_->close_frame();
  device_->amplifier.limits.force_output = false;
  device_->restart_ramp();
  open_ = false;
}

void Library::make_current(phantom::hd::HHD device) {
  const Lock lock(mutex_);
  usable(device);
}

phantom::hd::HHD Library::current_device() {
  const Lock lock(mutex_);
  return open_ ? kHandle : phantom::hd::kInvalidHandle;
}

void Library::begin_frame(phantom::hd::HHD device) {
  const Lock lock(mutex_);
  if (usable(device))
    note(device_->begin_frame(serves()));
}

void Library::end_frame(phantom::hd::HHD device) {
  const Lock lock(mutex_);
  if (usable(device))
    note(device_->end_frame(serves()));
}

void Library::set_capability(phantom::hd::HDenum name, bool on) {
  const Lock lock(mutex_);
  if (!opened())
    return;
  bool* state = capability(device_->amplifier.limits, name);
  if (state == nullptr)
    return note(phantom::hd::kInvalidEnum);
  if (state == &device_->amplifier.limits.force_output && on != *state)
    device_->restart_ramp();
  *state = on;
}

bool Library::capability_on(phantom::hd::HDenum name) {
  const Lock lock(mutex_);
  if (!opened())
    return false;
  const bool* state = capability(device_->amplifier.limits, name);
  if (state == nullptr)
    note(phantom::hd::kInvalidEnum);
  return state != nullptr && *state;
}

Values Library::get(phantom::hd::HDenum name, Type type) {
  const Lock lock(mutex_);
  Values out;
  if (opened())
    note(read_parameter(*device_, mean_rate_hz_, name, type, out));
  return out;
}

int Library::count_of_set(phantom::hd::HDenum name) {
  const Lock lock(mutex_);
  if (!opened())
    return 0;
  const int count = settable(name);
  if (count == 0)
    note(phantom::hd::kInvalidEnum);
  return count;
}

void Library::set(phantom::hd::HDenum name, const Values& values) {
  const Lock lock(mutex_);
  if (opened())
    note(write_parameter(*device_, name, values));
}

phantom::hd::HDstring Library::string(phantom::hd::HDenum name) {
  const Lock lock(mutex_);
  if (!opened())
    return nullptr;
  if (name == phantom::hd::kDeviceModelType)
    return device_->model().type;
  if (name == phantom::hd::kDeviceSerialNumber)
    return "simulated";
  note(phantom::hd::kInvalidEnum);
  return nullptr;
}

phantom::hd::HDenum Library::calibration() {
  const Lock lock(mutex_);
  if (!opened())
    return phantom::hd::kCalibrationNeedsManualInput;
  return device_->calibration();
}

void Library::calibrate(phantom::hd::HDenum style) {
  const Lock lock(mutex_);
  if (opened())
    note(device_->calibrate(style, serves()));
}

}  // namespace voxtouch::hd_sim
