#pragma once
/// The part of the vendor's device library that the driver uses (libHD.so, OpenHaptics HDAPI 3.x)
/// on x86-64 Linux: own declarations of types, constants and functions. The driver links no library
/// and resolves the functions by name at run time, from the vendor's library or the simulated one.
///
/// Units of this interface: mm, mm/s, N, mNm, rad, rad/s. Transforms are column-major arrays.
#include <cstddef>
#include <string_view>

namespace voxtouch::phantom::hd {

// --- types
using HDint = int;
using HDboolean = unsigned char;
using HDulong = unsigned long;
using HDushort = unsigned short;
using HDdouble = double;
using HDenum = unsigned int;
using HDerror = unsigned int;
using HHD = unsigned int;
using HDSchedulerHandle = unsigned long;
using HDCallbackCode = unsigned int;
using HDstring = const char*;
using HDSchedulerCallback = HDCallbackCode (*)(void*);

/// Returned by value: the first two members in one register, the third in another.
struct HDErrorInfo {
  HDerror error_code = 0;
  int internal_error_code = 0;
  HHD device = 0;
};

static_assert(sizeof(HDErrorInfo) == 12 && alignof(HDErrorInfo) == 4 &&
              offsetof(HDErrorInfo, error_code) == 0 &&
              offsetof(HDErrorInfo, internal_error_code) == 4 &&
              offsetof(HDErrorInfo, device) == 8);
static_assert(sizeof(HDint) == 4 && sizeof(HDenum) == 4 && sizeof(HHD) == 4);
static_assert(sizeof(HDulong) == 8 && sizeof(HDSchedulerHandle) == 8, "the interface is LP64");
static_assert(sizeof(HDboolean) == 1 && sizeof(HDushort) == 2 && sizeof(HDdouble) == 8);

// --- basics
inline constexpr HDboolean kTrue = 1, kFalse = 0;
inline constexpr HHD kInvalidHandle = 0xFFFFFFFF;  // 0 is a valid handle
inline constexpr HDstring kDefaultDevice = nullptr;
inline constexpr HDCallbackCode kCallbackDone = 0, kCallbackContinue = 1;
inline constexpr HDushort kMinPriority = 0, kDefaultPriority = 32767, kMaxPriority = 65535;

// --- errors
inline constexpr HDerror kSuccess = 0x0000;
inline constexpr HDerror kInvalidEnum = 0x0100;
inline constexpr HDerror kInvalidValue = 0x0101;
inline constexpr HDerror kInvalidOperation = 0x0102;
inline constexpr HDerror kInvalidInputType = 0x0103;
inline constexpr HDerror kBadHandle = 0x0104;
inline constexpr HDerror kWarmMotors = 0x0200;
inline constexpr HDerror kExceededMaxForce = 0x0201;
inline constexpr HDerror kExceededMaxForceImpulse = 0x0202;
inline constexpr HDerror kExceededMaxVelocity = 0x0203;
inline constexpr HDerror kForceError = 0x0204;
inline constexpr HDerror kDeviceFault = 0x0300;
inline constexpr HDerror kDeviceAlreadyInitiated = 0x0301;
inline constexpr HDerror kCommError = 0x0302;
inline constexpr HDerror kCommConfigError = 0x0303;
inline constexpr HDerror kTimerError = 0x0304;
inline constexpr HDerror kIllegalBegin = 0x0400;
inline constexpr HDerror kIllegalEnd = 0x0401;
inline constexpr HDerror kFrameError = 0x0402;
inline constexpr HDerror kInvalidPriority = 0x0500;
inline constexpr HDerror kSchedulerFull = 0x0501;
inline constexpr HDerror kInvalidLicense = 0x0600;

// --- state; type and unit in each comment
inline constexpr HDenum kCurrentButtons = 0x2000;    // int, one bit a button
inline constexpr HDenum kCurrentPosition = 0x2050;   // double x3, mm
inline constexpr HDenum kCurrentVelocity = 0x2051;   // double x3, mm/s, smoothed
inline constexpr HDenum kCurrentTransform = 0x2052;  // double x16, column-major, [12..14] in mm
inline constexpr HDenum kCurrentForce = 0x2700;      // get, set: double x3, N
inline constexpr HDenum kCurrentTorque = 0x2701;     // get, set: double x3, mNm

// --- properties and settings of a device
inline constexpr HDenum kDeviceModelType = 0x2501;            // string
inline constexpr HDenum kDeviceSerialNumber = 0x2504;         // string
inline constexpr HDenum kInputDof = 0x2553;                   // int
inline constexpr HDenum kOutputDof = 0x2554;                  // int
inline constexpr HDenum kCalibrationStyle = 0x2555;           // int, bit set
inline constexpr HDenum kUpdateRate = 0x2600;                 // int, Hz
inline constexpr HDenum kNominalMaxStiffness = 0x2602;        // double, N/mm
inline constexpr HDenum kNominalMaxForce = 0x2603;            // double, N
inline constexpr HDenum kNominalMaxContinuousForce = 0x2604;  // double, N
inline constexpr HDenum kMotorTemperature = 0x2605;  // double x OUTPUT_DOF, 0..1; 1 is overheated
inline constexpr HDenum kSoftwareVelocityLimit = 0x2606;  // set: double, mm/s; also a capability
// Get, set: double, N/ms; also a capability.
inline constexpr HDenum kSoftwareForceImpulseLimit = 0x2607;
inline constexpr HDenum kNominalMaxTorqueForce = 0x2622;  // double

// --- capabilities: for hdEnable, hdDisable, hdIsEnabled, in addition to the two limits above
inline constexpr HDenum kForceOutput = 0x4000;
inline constexpr HDenum kMaxForceClamping = 0x4001;
inline constexpr HDenum kForceRamping = 0x4002;
inline constexpr HDenum kSoftwareForceLimit = 0x4003;
inline constexpr HDenum kOneFrameLimit = 0x4004;

// --- calibration
inline constexpr HDenum kCalibrationOk = 0x5000;
inline constexpr HDenum kCalibrationNeedsUpdate = 0x5001;
inline constexpr HDenum kCalibrationNeedsManualInput = 0x5002;
inline constexpr HDenum kCalibrationEncoderReset = 1, kCalibrationAuto = 2, kCalibrationInkwell = 4;

/// The functions, of the 36 exported by libHD.so 3.0.0, that the driver and its tests call: X(name,
/// result, arguments).
// clang-format off
#define VOXTOUCH_HD_FUNCTIONS(X)                                                               \
  X(hdInitDevice, HHD, (HDstring name))                                                        \
  X(hdDisableDevice, void, (HHD device))                                                       \
  X(hdMakeCurrentDevice, void, (HHD device))                                                   \
  X(hdGetCurrentDevice, HHD, ())                                                               \
  X(hdBeginFrame, void, (HHD device))                                                          \
  X(hdEndFrame, void, (HHD device))                                                            \
  X(hdGetError, HDErrorInfo, ())                                                               \
  X(hdGetErrorString, HDstring, (HDerror code))                                                \
  X(hdEnable, void, (HDenum capability))                                                       \
  X(hdDisable, void, (HDenum capability))                                                      \
  X(hdIsEnabled, HDboolean, (HDenum capability))                                               \
  X(hdGetIntegerv, void, (HDenum name, HDint* values))                                         \
  X(hdGetDoublev, void, (HDenum name, HDdouble* values))                                       \
  X(hdGetString, HDstring, (HDenum name))                                                      \
  X(hdSetDoublev, void, (HDenum name, const HDdouble* values))                                 \
  X(hdCheckCalibration, HDenum, ())                                                            \
  X(hdUpdateCalibration, void, (HDenum style))                                                 \
  X(hdStartScheduler, void, ())                                                                \
  X(hdStopScheduler, void, ())                                                                 \
  X(hdSetSchedulerRate, void, (HDulong rate_hz))                                               \
  X(hdScheduleAsynchronous, HDSchedulerHandle,                                                 \
    (HDSchedulerCallback callback, void* data, HDushort priority))                             \
  X(hdUnschedule, void, (HDSchedulerHandle handle))
// clang-format on

/// The functions, by their exported names. Null until resolved.
struct Api {
#define VOXTOUCH_HD_MEMBER(name, result, arguments) result(*name) arguments = nullptr;
  VOXTOUCH_HD_FUNCTIONS(VOXTOUCH_HD_MEMBER)
#undef VOXTOUCH_HD_MEMBER
};

/// Fills `api` from `resolve(const char* name) -> void*` (dlsym). Returns the name of the first
/// missing function, or an empty text.
template <class Resolve>
std::string_view resolve_api(Api& api, Resolve&& resolve) {
  std::string_view missing;
#define VOXTOUCH_HD_RESOLVE(name, result, arguments)                \
  api.name = reinterpret_cast<result(*) arguments>(resolve(#name)); \
  if (api.name == nullptr && missing.empty())                       \
    missing = #name;
  VOXTOUCH_HD_FUNCTIONS(VOXTOUCH_HD_RESOLVE)
#undef VOXTOUCH_HD_RESOLVE
  return missing;
}

}  // namespace voxtouch::phantom::hd
