// The functions of the vendor's library that the driver calls.
#include <algorithm>
#include <type_traits>

#include "devices/phantom/simulated/library.hpp"

// NOLINTBEGIN: the names belong to the interface
using namespace voxtouch::phantom::hd;
namespace hd_sim = voxtouch::hd_sim;

namespace {

hd_sim::Library& library() { return hd_sim::Library::instance(); }

template <class T>
void get(HDenum name, hd_sim::Type type, T* out) {
  if (out == nullptr)
    return library().fail(kInvalidValue);
  const hd_sim::Values values = library().get(name, type);
  for (int i = 0; i < values.count; ++i)
    out[i] = static_cast<T>(values.value[static_cast<std::size_t>(i)]);
}

struct Sentence {
  HDerror code;
  HDstring text;
};
constexpr Sentence kSentences[]{
    {kSuccess, "no error"},
    {kInvalidEnum, "unknown parameter number"},
    {kInvalidValue, "the value is out of range"},
    {kInvalidOperation, "not possible in this state"},
    {kInvalidInputType, "wrong parameter type"},
    {kBadHandle, "unknown device handle"},
    {kWarmMotors, "the motors are too warm"},
    {kExceededMaxForce, "the force exceeds the device's limit"},
    {kExceededMaxForceImpulse, "the force slew rate exceeds its limit"},
    {kExceededMaxVelocity, "the tip exceeds its speed limit"},
    {kForceError, "forces and torques of this frame contradict each other"},
    {kDeviceFault, "the device has failed"},
    {kDeviceAlreadyInitiated, "the device is already initialised"},
    {kCommError, "communication with the device failed"},
    {kCommConfigError, "no device of this name"},
    {kTimerError, "the servo loop's timer failed"},
    {kIllegalBegin, "invalid begin of a frame"},
    {kIllegalEnd, "end of a frame without its begin"},
    {kFrameError, "only allowed between begin and end of a frame"},
    {kInvalidPriority, "the priority is out of range"},
    {kSchedulerFull, "too many callbacks"},
    {kInvalidLicense, "the licence is not valid"},
};

}  // namespace

extern "C" {

HHD hdInitDevice(HDstring name) { return library().init(name); }
void hdDisableDevice(HHD device) { library().disable(device); }
void hdMakeCurrentDevice(HHD device) { library().make_current(device); }
HHD hdGetCurrentDevice() { return library().current_device(); }
void hdBeginFrame(HHD device) { library().begin_frame(device); }
void hdEndFrame(HHD device) { library().end_frame(device); }
HDErrorInfo hdGetError() { return library().pop_error(); }
HDstring hdGetErrorString(HDerror code) {
  for (const Sentence& s : kSentences)
    if (s.code == code)
      return s.text;
  return "unknown error";
}

void hdEnable(HDenum capability) { library().set_capability(capability, true); }
void hdDisable(HDenum capability) { library().set_capability(capability, false); }
HDboolean hdIsEnabled(HDenum capability) {
  return library().capability_on(capability) ? kTrue : kFalse;
}

void hdGetIntegerv(HDenum name, HDint* values) { get(name, hd_sim::Type::kInteger, values); }
void hdGetDoublev(HDenum name, HDdouble* values) { get(name, hd_sim::Type::kDouble, values); }
HDstring hdGetString(HDenum name) { return library().string(name); }
void hdSetDoublev(HDenum name, const HDdouble* values) {
  if (values == nullptr)
    return library().fail(kInvalidValue);
  hd_sim::Values copied;
  copied.count = library().count_of_set(name);
  std::copy_n(values, copied.count, copied.value.begin());
  if (copied.count > 0)
    library().set(name, copied);
}

HDenum hdCheckCalibration() { return library().calibration(); }
void hdUpdateCalibration(HDenum style) { library().calibrate(style); }

void hdStartScheduler() { library().start(); }
void hdStopScheduler() { library().stop(); }
void hdSetSchedulerRate(HDulong rate_hz) { library().set_rate(rate_hz); }
HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback callback, void* data,
                                         HDushort priority) {
  return library().schedule_asynchronous(callback, data, priority);
}
void hdUnschedule(HDSchedulerHandle handle) { library().unschedule(handle); }

}  // extern "C"

#define VOXTOUCH_HD_CHECK(name, result, arguments) \
  static_assert(std::is_same_v<decltype(&name), result(*) arguments>);
VOXTOUCH_HD_FUNCTIONS(VOXTOUCH_HD_CHECK)
#undef VOXTOUCH_HD_CHECK
// NOLINTEND
