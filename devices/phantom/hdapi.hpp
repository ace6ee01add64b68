#pragma once
/// The binary interface of the vendor's device library (libHD.so, OpenHaptics HDAPI 3.x) on x86-64 Linux: our own
/// declarations of types, numbers and functions. Nothing is linked: the driver resolves the functions by name from whatever
/// library it was told to load, the vendor's or the simulated one.
///
/// Units at this border are the library's: mm, mm/s, N, mNm, rad, rad/s. Arrays of transforms are column-major.
#include <cstddef>
#include <string_view>

namespace voxtouch::phantom::hd {

// --- types
using HDint = int;
using HDuint = unsigned int;
using HDboolean = unsigned char;
using HDlong = long;  // 64 bits: six encoder values take 48 bytes
using HDulong = unsigned long;
using HDushort = unsigned short;
using HDfloat = float;
using HDdouble = double;
using HDchar = char;
using HDenum = unsigned int;
using HDerror = unsigned int;
using HHD = unsigned int;
using HDSchedulerHandle = unsigned long;
using HDCallbackCode = unsigned int;
using HDWaitCode = unsigned int;
using HDstring = const char*;
using HDSchedulerCallback = HDCallbackCode (*)(void*);

/// Returned by value: the first two members in one register, the third in another.
struct HDErrorInfo {
  HDerror error_code = 0;
  int internal_error_code = 0;
  HHD device = 0;
};

static_assert(sizeof(HDErrorInfo) == 12 && alignof(HDErrorInfo) == 4 && offsetof(HDErrorInfo, error_code) == 0 &&
              offsetof(HDErrorInfo, internal_error_code) == 4 && offsetof(HDErrorInfo, device) == 8);
static_assert(sizeof(HDint) == 4 && sizeof(HDuint) == 4 && sizeof(HDenum) == 4 && sizeof(HHD) == 4);
static_assert(sizeof(HDlong) == 8 && sizeof(HDulong) == 8 && sizeof(HDSchedulerHandle) == 8, "the interface is LP64");
static_assert(sizeof(HDboolean) == 1 && sizeof(HDushort) == 2 && sizeof(HDfloat) == 4 && sizeof(HDdouble) == 8);

// --- basics
inline constexpr HDboolean kTrue = 1, kFalse = 0;
inline constexpr HHD kInvalidHandle = 0xFFFFFFFF;  // 0 is a valid handle
inline constexpr HDstring kDefaultDevice = nullptr;
inline constexpr HDCallbackCode kCallbackDone = 0, kCallbackContinue = 1;
inline constexpr HDWaitCode kWaitCheckStatus = 0, kWaitInfinite = 1;
inline constexpr HDushort kMinPriority = 0, kDefaultPriority = 32767, kMaxPriority = 65535;
inline constexpr HDint kButton1 = 1, kButton2 = 2, kButton3 = 4, kButton4 = 8;

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

// --- state; type and unit behind each. "real" is float or double.
inline constexpr HDenum kCurrentButtons = 0x2000, kLastButtons = 0x2200;              // int, one bit a button
inline constexpr HDenum kCurrentSafetySwitch = 0x2001, kLastSafetySwitch = 0x2201;    // boolean
inline constexpr HDenum kCurrentInkwellSwitch = 0x2002, kLastInkwellSwitch = 0x2202;  // boolean
inline constexpr HDenum kCurrentEncoderValues = 0x2010, kLastEncoderValues = 0x2210;  // long x6
inline constexpr HDenum kCurrentPinchValue = 0x2011, kLastPinchValue = 0x2012;  // pinch models; type not documented
inline constexpr HDenum kCurrentPosition = 0x2050, kLastPosition = 0x2250;      // real x3, mm
inline constexpr HDenum kCurrentVelocity = 0x2051, kLastVelocity = 0x2251;      // real x3, mm/s, smoothed
inline constexpr HDenum kCurrentTransform = 0x2052, kLastTransform = 0x2252;  // real x16, column-major, [12..14] in mm
inline constexpr HDenum kCurrentAngularVelocity = 0x2053, kLastAngularVelocity = 0x2253;  // real x3, rad/s
inline constexpr HDenum kCurrentJacobian = 0x2054, kLastJacobian = 0x2254;          // layout not documented: not used
inline constexpr HDenum kCurrentJointAngles = 0x2100, kLastJointAngles = 0x2300;    // real x3, rad
inline constexpr HDenum kCurrentGimbalAngles = 0x2150, kLastGimbalAngles = 0x2350;  // real x3, rad
inline constexpr HDenum kCurrentForce = 0x2700, kLastForce = 0x2800;                // get, set: real x3, N
inline constexpr HDenum kCurrentTorque = 0x2701, kLastTorque = 0x2801;              // get, set: real x3, mNm
inline constexpr HDenum kJointAngleReferences = 0x2702;  // real x3, rad; meaning not documented
inline constexpr HDenum kCurrentJointTorque = 0x2703, kLastJointTorque = 0x2802;    // get, set: real x3, mNm
inline constexpr HDenum kCurrentGimbalTorque = 0x2704, kLastGimbalTorque = 0x2803;  // get, set: real x3, mNm
inline constexpr HDenum kCurrentMotorDacValues = 0x2750,
                        kLastMotorDacValues = 0x2850;  // long, -32767..32766; deprecated

// --- facts and settings of a device
inline constexpr HDenum kVersion = 0x2500;  // this and the next four: string
inline constexpr HDenum kDeviceModelType = 0x2501;
inline constexpr HDenum kDeviceDriverVersion = 0x2502;
inline constexpr HDenum kDeviceVendor = 0x2503;
inline constexpr HDenum kDeviceSerialNumber = 0x2504;
inline constexpr HDenum kDeviceFirmwareVersion = 0x2505;      // type not certain: not used
inline constexpr HDenum kMaxWorkspaceDimensions = 0x2550;     // real x6: smallest x y z, largest x y z, mm
inline constexpr HDenum kUsableWorkspaceDimensions = 0x2551;  // likewise
inline constexpr HDenum kTabletopOffset = 0x2552;             // float, mm
inline constexpr HDenum kInputDof = 0x2553;                   // int
inline constexpr HDenum kOutputDof = 0x2554;                  // int
inline constexpr HDenum kCalibrationStyle = 0x2555;           // int, a set of bits
inline constexpr HDenum kUpdateRate = 0x2600;                 // int, Hz
inline constexpr HDenum kInstantaneousUpdateRate = 0x2601;    // int, Hz
inline constexpr HDenum kNominalMaxStiffness = 0x2602;        // real, N/mm
inline constexpr HDenum kNominalMaxForce = 0x2603;            // real, N
inline constexpr HDenum kNominalMaxContinuousForce = 0x2604;  // real, N
inline constexpr HDenum kMotorTemperature = 0x2605;           // real x OUTPUT_DOF, 0..1; 1 is too hot
inline constexpr HDenum kSoftwareVelocityLimit = 0x2606;      // get, set: real, mm/s; also a capability
inline constexpr HDenum kSoftwareForceImpulseLimit = 0x2607;  // get, set: real, N/ms; also a capability
inline constexpr HDenum kForceRampingRate = 0x2608;           // get, set: real, N/s
inline constexpr HDenum kNominalMaxDamping = 0x2609;          // real, 0..1
inline constexpr HDenum kNominalMaxTorqueStiffness = 0x2620;  // real
inline constexpr HDenum kNominalMaxTorqueDamping = 0x2621;
inline constexpr HDenum kNominalMaxTorqueForce = 0x2622;
inline constexpr HDenum kNominalMaxTorqueContinuousForce = 0x2623;
inline constexpr HDenum kUserStatusLight = 0x2900;  // int, 0..7

// --- capabilities: for hdEnable, hdDisable, hdIsEnabled, beside the two limits above
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

/// The 36 functions that libHD.so 3.0.0 exports: X(name, result, arguments).
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
  X(hdGetBooleanv, void, (HDenum name, HDboolean* values))                                     \
  X(hdGetIntegerv, void, (HDenum name, HDint* values))                                         \
  X(hdGetFloatv, void, (HDenum name, HDfloat* values))                                         \
  X(hdGetDoublev, void, (HDenum name, HDdouble* values))                                       \
  X(hdGetLongv, void, (HDenum name, HDlong* values))                                           \
  X(hdGetString, HDstring, (HDenum name))                                                      \
  X(hdSetBooleanv, void, (HDenum name, const HDboolean* values))                               \
  X(hdSetIntegerv, void, (HDenum name, const HDint* values))                                   \
  X(hdSetFloatv, void, (HDenum name, const HDfloat* values))                                   \
  X(hdSetDoublev, void, (HDenum name, const HDdouble* values))                                 \
  X(hdSetLongv, void, (HDenum name, const HDlong* values))                                     \
  X(hdCheckCalibration, HDenum, ())                                                            \
  X(hdCheckCalibrationStyle, HDenum, ())                                                       \
  X(hdUpdateCalibration, void, (HDenum style))                                                 \
  X(hdUpdateCalibrationMessage, void, (HDenum style))                                          \
  X(hdScaleGimbalAngles, void, (HDdouble x, HDdouble y, HDdouble z, HDdouble* transform16))    \
  X(hdDeploymentLicense, HDboolean, (const char* vendor, const char* application, const char* password)) \
  X(hdStartScheduler, void, ())                                                                \
  X(hdStopScheduler, void, ())                                                                 \
  X(hdSetSchedulerRate, void, (HDulong rate_hz))                                               \
  X(hdScheduleSynchronous, void, (HDSchedulerCallback callback, void* data, HDushort priority)) \
  X(hdScheduleAsynchronous, HDSchedulerHandle, (HDSchedulerCallback callback, void* data, HDushort priority)) \
  X(hdUnschedule, void, (HDSchedulerHandle handle))                                            \
  X(hdWaitForCompletion, HDboolean, (HDSchedulerHandle handle, HDWaitCode code))               \
  X(hdGetSchedulerTimeStamp, HDdouble, ())
// clang-format on

/// The functions, by the names that the library exports them under. Null until resolved.
struct Api {
#define VOXTOUCH_HD_MEMBER(name, result, arguments) result(*name) arguments = nullptr;
  VOXTOUCH_HD_FUNCTIONS(VOXTOUCH_HD_MEMBER)
#undef VOXTOUCH_HD_MEMBER
};

#define VOXTOUCH_HD_COUNT(name, result, arguments) +1
inline constexpr std::size_t kFunctionCount = 0 VOXTOUCH_HD_FUNCTIONS(VOXTOUCH_HD_COUNT);
#undef VOXTOUCH_HD_COUNT
static_assert(kFunctionCount == 36 && sizeof(Api) == kFunctionCount * sizeof(void*));

/// Fills `api` from `resolve(const char* name) -> void*` (dlsym); the name of the first function that is missing, or empty.
/// hdCheckCalibrationStyle stays null where a release has none.
template <class Resolve>
std::string_view resolve_api(Api& api, Resolve&& resolve) {
  std::string_view missing;
#define VOXTOUCH_HD_RESOLVE(name, result, arguments)                \
  api.name = reinterpret_cast<result(*) arguments>(resolve(#name)); \
  if (api.name == nullptr && missing.empty() && std::string_view(#name) != "hdCheckCalibrationStyle") missing = #name;
  VOXTOUCH_HD_FUNCTIONS(VOXTOUCH_HD_RESOLVE)
#undef VOXTOUCH_HD_RESOLVE
  return missing;
}

}  // namespace voxtouch::phantom::hd
