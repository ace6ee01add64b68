#include "devices/phantom/hd_session.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

namespace voxtouch::phantom {
namespace {

constexpr double kMilli = 1e-3;  // m per mm, Nm per mNm
constexpr auto kPoll = std::chrono::milliseconds(10);
constexpr int kTicksAPoll = 10;  // in virtual time
constexpr double kPollS = 0.01;

std::atomic<bool> g_in_use{
    false};  // the servo loop belongs to the process, so there is one session per process

/// Discards all waiting errors; returns the newest one.
hd::HDerror take_errors(const hd::Api& api) {
  hd::HDerror newest = hd::kSuccess;
  for (int i = 0; i < 256; ++i) {
    const hd::HDerror code = api.hdGetError().error_code;
    if (code == hd::kSuccess)
      break;
    if (newest == hd::kSuccess)
      newest = code;
  }
  return newest;
}

hd::HDenum style_of(int bits) noexcept {  // the last supported one is selected, in this order
  hd::HDenum style = 0;
  for (const hd::HDenum s :
       {hd::kCalibrationEncoderReset, hd::kCalibrationInkwell, hd::kCalibrationAuto})
    if ((static_cast<hd::HDenum>(bits) & s) != 0)
      style = s;
  return style;
}

}  // namespace

HdSession::Claim::Claim(const hd::Api& functions) : api(functions) {
  if (g_in_use.exchange(true))
    throw devices::DeviceOpenError(
        "device 'phantom': a Phantom is already open in this process, limit 1. Close it, or start "
        "another process");
}

HdSession::Claim::~Claim() {
  if (initiated) {
    api.hdMakeCurrentDevice(device);
    api.hdDisable(hd::kForceOutput);
  }
  if (started)
    api.hdStopScheduler();
  if (scheduled)
    api.hdUnschedule(callback);
  if (initiated)
    api.hdDisableDevice(device);
  take_errors(api);
  g_in_use.store(false);
}

HdSession::HdSession(const HdLibrary& library, const PhantomOptions& options)
    : library_(library),
      api_(library.api()),
      options_(options),
      claim_(api_) {
  hdsim_state state{};
  virtual_time_ = library.hooks().complete() &&
                  library.hooks().read_state(&state, sizeof state) == 0 && state.virtual_time != 0;
  initiate();
  ask();
}

HdSession::~HdSession() = default;

void HdSession::must(std::string_view what) {
  const hd::HDerror code = take_errors(api_);
  if (code == hd::kSuccess)
    return;
  throw devices::DeviceOpenError(
      fmt::format("device 'phantom': {} failed with error {}", what, error_text(api_, code)));
}

void HdSession::initiate() {
  std::string tried;
  if (!options_.name.empty() && initiate(options_.name.c_str(), tried))
    return;
  // Releases differ in the names that they accept, and in whether they accept null.
  for (const char* name : {"Default Device", "Default PHANToM", hd::kDefaultDevice})
    if (initiate(name, tried))
      return;
  throw devices::DeviceOpenError(
      fmt::format("device 'phantom': cannot initialise a device ({}). Check power, cable, its name "
                  "in the vendor's tool, and the permissions of its port",
                  tried));
}

bool HdSession::initiate(const char* name, std::string& tried) {
  const hd::HHD device = api_.hdInitDevice(name);
  const hd::HDerror code = take_errors(api_);
  if (device != hd::kInvalidHandle && classify(code).severity == HdSeverity::kNone) {
    claim_.device = device;
    claim_.initiated = true;
    return true;
  }
  if (device != hd::kInvalidHandle)
    api_.hdDisableDevice(device);
  take_errors(api_);
  if (code == hd::kDeviceAlreadyInitiated)
    throw devices::DeviceOpenError(fmt::format(
        "device 'phantom': error {}: it is in use. End the other program and open it again",
        error_text(api_, code)));
  if (code == hd::kInvalidLicense)
    throw devices::DeviceOpenError(
        fmt::format("device 'phantom': error {}: install the licence file of OpenHaptics, or set "
                    "OH_SDK_LICENSE_PATH",
                    error_text(api_, code)));
  tried += fmt::format("{}{}: {}", tried.empty() ? "" : "; ", name != nullptr ? name : "no name",
                       code != hd::kSuccess ? error_text(api_, code) : "no handle");
  return false;
}

/// Absent if the library does not support the parameter or returns NaN. It may write up to 16
/// values; the first is used.
std::optional<double> HdSession::number(hd::HDenum name) {
  std::array<double, 16> values;
  values.fill(std::nan(""));
  api_.hdGetDoublev(name, values.data());
  if (take_errors(api_) != hd::kSuccess || !std::isfinite(values[0]))
    return {};
  return values[0];
}

std::optional<int> HdSession::integer(hd::HDenum name) {
  std::array<int, 16> values{};
  api_.hdGetIntegerv(name, values.data());
  if (take_errors(api_) != hd::kSuccess)
    return {};
  return values[0];
}

void HdSession::ask() {
  const hd::HDstring model = api_.hdGetString(hd::kDeviceModelType);
  must("querying the model");
  facts_.model = model != nullptr ? model : "";
  const hd::HDstring serial = api_.hdGetString(hd::kDeviceSerialNumber);
  if (take_errors(api_) == hd::kSuccess && serial != nullptr)
    facts_.serial = serial;
  facts_.input_dof = integer(hd::kInputDof).value_or(6);
  facts_.output_dof = integer(hd::kOutputDof).value_or(3);
  facts_.max_force_n = number(hd::kNominalMaxForce).value_or(0.0);
  facts_.continuous_force_n = number(hd::kNominalMaxContinuousForce).value_or(0.0);
  facts_.max_stiffness_n_per_m = number(hd::kNominalMaxStiffness).value_or(0.0) / kMilli;
  // The unit is undocumented. mNm is assumed, as for setting torques. If it were Nm, the limit
  // would be too low and not too high.
  facts_.max_torque_nm = number(hd::kNominalMaxTorqueForce).value_or(0.0) * kMilli;
  facts_.max_impulse_n_per_s = number(hd::kSoftwareForceImpulseLimit).value_or(0.0) / kMilli;
  facts_.temperatures = number(hd::kMotorTemperature) ? std::clamp(facts_.output_dof, 0, 6) : 0;
  if (options_.max_force_n &&
      !(facts_.max_force_n > 0.0 && facts_.max_force_n < *options_.max_force_n))
    facts_.max_force_n = *options_.max_force_n;
}

void HdSession::start(hd::HDSchedulerCallback callback, void* data) {
  const hd::HDenum style = style_of(integer(hd::kCalibrationStyle).value_or(0));
  const bool needs_servo = style == hd::kCalibrationInkwell || style == hd::kCalibrationAuto;
  if (style == hd::kCalibrationEncoderReset)
    calibrate_encoders();
  if (options_.rate_hz) {
    api_.hdSetSchedulerRate(*options_.rate_hz);
    must(fmt::format("setting the servo rate to {} Hz (usual are 500, 1000, 2000)",
                     *options_.rate_hz));
  }
  if (options_.max_speed_m_per_s) {
    const double mm_per_s = *options_.max_speed_m_per_s / kMilli;
    api_.hdSetDoublev(hd::kSoftwareVelocityLimit, &mm_per_s);
    api_.hdEnable(hd::kSoftwareVelocityLimit);
    must("setting the speed limit");
  }
  if (!needs_servo)
    enable_forces();
  claim_.callback = api_.hdScheduleAsynchronous(callback, data, hd::kMaxPriority);
  claim_.scheduled = true;
  must("scheduling the servo callback");
  api_.hdStartScheduler();
  claim_.started = true;  // also after a failure: stopping a loop that does not run is harmless
  must("starting the servo loop");
  const std::optional<int> rate = integer(hd::kUpdateRate);
  facts_.rate_hz = rate && *rate > 0 ? *rate : options_.rate_hz.value_or(0);
  if (!needs_servo)
    return;
  calibrate_running(style);
  enable_forces();
}

void HdSession::enable_forces() {
  api_.hdEnable(hd::kForceRamping);
  api_.hdEnable(hd::kMaxForceClamping);
  must("enabling force ramping and clamping");
  api_.hdEnable(hd::kForceOutput);
  must("enabling force output");
}

void HdSession::calibrate_encoders() {
  if (options_.encoder_reset == EncoderReset::kIfNeeded &&
      api_.hdCheckCalibration() == hd::kCalibrationOk)
    return;
  take_errors(api_);
  api_.hdUpdateCalibration(hd::kCalibrationEncoderReset);
  must("setting the encoders to zero");
  if (api_.hdCheckCalibration() != hd::kCalibrationOk)
    throw devices::DeviceOpenError(
        "device 'phantom': not calibrated after setting the encoders to zero. Hold all links at "
        "right angles and open it again");
  must("checking the calibration");
}

void HdSession::calibrate_running(hd::HDenum style) {
  for (double waited_s = 0.0;; waited_s += kPollS) {
    const hd::HDenum calibration = api_.hdCheckCalibration();
    must("checking the calibration");
    if (calibration == hd::kCalibrationOk)
      return;
    if (calibration == hd::kCalibrationNeedsUpdate) {
      api_.hdUpdateCalibration(style);
      must("calibrating");
      continue;
    }
    if (waited_s >= options_.calibration_timeout_s)
      throw devices::DeviceOpenError(
          fmt::format("device 'phantom': not calibrated within {} s; {}, and open it again",
                      options_.calibration_timeout_s,
                      style == hd::kCalibrationInkwell ? "put the stylus into its inkwell"
                                                       : "move the arm slowly"));
    pause();
  }
}

void HdSession::pause() {
  if (!virtual_time_)
    return std::this_thread::sleep_for(kPoll);
  for (int i = 0; i < kTicksAPoll; ++i)
    library_.hooks().step();
}

}  // namespace voxtouch::phantom
