// The 36 functions that the vendor's library exports.
#include <type_traits>

#include "devices/phantom/simulated/library.hpp"

// NOLINTBEGIN: names are the interface's
using namespace voxtouch::phantom::hd;
namespace hd_sim = voxtouch::hd_sim;

namespace {

hd_sim::Library& library() { return hd_sim::Library::instance(); }

template <class T>
void get(HDenum name, hd_sim::Type type, T* out) {
  if (out == nullptr) return library().fail(kInvalidValue);
  const hd_sim::Values values = library().get(name, type);
  for (int i = 0; i < values.count; ++i) out[i] = static_cast<T>(values.value[static_cast<std::size_t>(i)]);
}

template <class T>
void set(HDenum name, hd_sim::Type type, const T* in) {
  if (in == nullptr) return library().fail(kInvalidValue);
  hd_sim::Values values;
  values.count = library().count_of_set(name, type);
  for (int i = 0; i < values.count; ++i) values.value[static_cast<std::size_t>(i)] = static_cast<double>(in[i]);
  if (values.count > 0) library().set(name, values);
}

struct Sentence {
  HDerror code;
  HDstring text;
};
constexpr Sentence kSentences[]{
    {kSuccess, "no error"},
    {kInvalidEnum, "there is no parameter of that number"},
    {kInvalidValue, "the value is out of range"},
    {kInvalidOperation, "this cannot be done in this state"},
    {kInvalidInputType, "the parameter has another type"},
    {kBadHandle, "there is no device of that handle"},
    {kWarmMotors, "the motors are too warm"},
    {kExceededMaxForce, "the force is over the device's limit"},
    {kExceededMaxForceImpulse, "the force changes faster than its limit"},
    {kExceededMaxVelocity, "the tip moves faster than its limit"},
    {kForceError, "forces and torques of this frame contradict each other"},
    {kDeviceFault, "the device has failed"},
    {kDeviceAlreadyInitiated, "the device has been initiated before"},
    {kCommError, "communication with the device failed"},
    {kCommConfigError, "no device could be set up under that name"},
    {kTimerError, "the servo loop's timer failed"},
    {kIllegalBegin, "a frame was begun where none may begin"},
    {kIllegalEnd, "a frame was ended that had not begun"},
    {kFrameError, "this has to stand between begin and end of a frame"},
    {kInvalidPriority, "the priority is out of range"},
    {kSchedulerFull, "there is no room for one more callback"},
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
    if (s.code == code) return s.text;
  return "an error without a name";
}

void hdEnable(HDenum capability) { library().set_capability(capability, true); }
void hdDisable(HDenum capability) { library().set_capability(capability, false); }
HDboolean hdIsEnabled(HDenum capability) { return library().capability_on(capability) ? kTrue : kFalse; }

void hdGetBooleanv(HDenum name, HDboolean* values) { get(name, hd_sim::kBoolean, values); }
void hdGetIntegerv(HDenum name, HDint* values) { get(name, hd_sim::kInteger, values); }
void hdGetFloatv(HDenum name, HDfloat* values) { get(name, hd_sim::kFloat, values); }
void hdGetDoublev(HDenum name, HDdouble* values) { get(name, hd_sim::kDouble, values); }
void hdGetLongv(HDenum name, HDlong* values) { get(name, hd_sim::kLong, values); }
HDstring hdGetString(HDenum name) { return library().string(name); }
void hdSetBooleanv(HDenum name, const HDboolean* values) { set(name, hd_sim::kBoolean, values); }
void hdSetIntegerv(HDenum name, const HDint* values) { set(name, hd_sim::kInteger, values); }
void hdSetFloatv(HDenum name, const HDfloat* values) { set(name, hd_sim::kFloat, values); }
void hdSetDoublev(HDenum name, const HDdouble* values) { set(name, hd_sim::kDouble, values); }
void hdSetLongv(HDenum name, const HDlong* values) { set(name, hd_sim::kLong, values); }

HDenum hdCheckCalibration() { return library().calibration(false); }
HDenum hdCheckCalibrationStyle() { return library().calibration(true); }
void hdUpdateCalibration(HDenum style) { library().calibrate(style); }
void hdUpdateCalibrationMessage(HDenum style) { library().calibrate(style); }
void hdScaleGimbalAngles(HDdouble x, HDdouble y, HDdouble z, HDdouble* transform16) {
  library().scale_gimbal({x, y, z}, transform16);
}
HDboolean hdDeploymentLicense(const char*, const char*, const char*) { return kTrue; }  // nothing here needs one

void hdStartScheduler() { library().start(); }
void hdStopScheduler() { library().stop(); }
void hdSetSchedulerRate(HDulong rate_hz) { library().set_rate(rate_hz); }
void hdScheduleSynchronous(HDSchedulerCallback callback, void* data, HDushort priority) {
  library().schedule_synchronous(callback, data, priority);
}
HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback callback, void* data, HDushort priority) {
  return library().schedule_asynchronous(callback, data, priority);
}
void hdUnschedule(HDSchedulerHandle handle) { library().unschedule(handle); }
HDboolean hdWaitForCompletion(HDSchedulerHandle handle, HDWaitCode code) {
  return library().wait(handle, code) ? kTrue : kFalse;
}
HDdouble hdGetSchedulerTimeStamp() { return library().time_stamp(); }

}  // extern "C"

#define VOXTOUCH_HD_CHECK(name, result, arguments) static_assert(std::is_same_v<decltype(&name), result(*) arguments>);
VOXTOUCH_HD_FUNCTIONS(VOXTOUCH_HD_CHECK)
#undef VOXTOUCH_HD_CHECK
// NOLINTEND
