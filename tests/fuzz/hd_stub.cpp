// Replaces the vendor's library; its answers come from the input.
#include "tests/fuzz/hd_stub.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

using namespace voxtouch::phantom::hd;

namespace {

struct State {
  const std::uint8_t* at = nullptr;
  std::size_t left = 0;
  HDSchedulerCallback callback = nullptr;
  void* callback_data = nullptr;
  std::array<double, 3> force{}, torque{};
  bool finite = true;
  int errors = 0;
  std::string text;
} g;

void fill(void* out, std::size_t size) {
  const std::size_t n = std::min(size, g.left);
  std::memset(out, 0, size);
  if (n > 0)
    std::memcpy(out, g.at, n);
  g.at += n, g.left -= n;
}
std::uint8_t byte() {
  std::uint8_t b = 0;
  fill(&b, 1);
  return b;
}

std::size_t count_of(HDenum name) {
  switch (name) {
    case kCurrentTransform:
      return 16;
    case kMotorTemperature:
      return 6;
    case kCurrentPosition:
    case kCurrentForce:
    case kCurrentTorque:
      return 3;
    default:
      return 1;
  }
}

/// The first byte selects: unchanged, whole doubles from the input, or a plausible value with the
/// input's noise.
void answer(HDenum name, double* values) {
  const std::size_t count = count_of(name);
  const std::uint8_t how = byte();
  if (how % 4 == 3)
    return;
  for (std::size_t i = 0; i < count; ++i) {
    if (how % 4 == 2) {
      fill(&values[i], sizeof(double));
    } else {
      const bool diagonal = name == kCurrentTransform && (i % 5 == 0);
      values[i] = (diagonal ? 1.0 : 0.0) +
                  (name == kCurrentTransform ? 1e-4 : 0.5) * static_cast<std::int8_t>(byte());
      if (name == kMotorTemperature)
        values[i] = byte() / 255.0;
    }
  }
}

void set(const double* values, std::array<double, 3>& out) {
  std::copy_n(values, 3, out.begin());
  for (const double x : out)
    g.finite = g.finite && std::isfinite(x);
}

}  // namespace

extern "C" {

void fuzz_hd_say(const std::uint8_t* data, std::size_t size) {
  g = State{};
  g.at = data, g.left = size;
}
void fuzz_hd_tick(void) {
  if (g.callback != nullptr)
    g.callback(g.callback_data);
}
bool fuzz_hd_last(double* force3, double* torque3) {
  std::copy_n(g.force.begin(), 3, force3);
  std::copy_n(g.torque.begin(), 3, torque3);
  const bool finite = g.finite;
  g.force.fill(0.0), g.torque.fill(0.0), g.finite = true;
  return finite;
}

HHD hdInitDevice(HDstring) { return byte() == 255 ? kInvalidHandle : 0; }
void hdDisableDevice(HHD) {}
void hdMakeCurrentDevice(HHD) {}
HHD hdGetCurrentDevice() { return 0; }
void hdBeginFrame(HHD) {}
void hdEndFrame(HHD) {}
HDErrorInfo hdGetError() {
  HDErrorInfo info;
  const std::uint8_t how = byte();
  if (how >= 224 && ++g.errors < 64) {
    constexpr HDerror kCodes[] = {kWarmMotors, kExceededMaxForce, kFrameError,  kInvalidValue,
                                  kForceError, kCommError,        kDeviceFault, 0xABCD};
    info.error_code = kCodes[how % 8];
  }
  return info;
}
HDstring hdGetErrorString(HDerror) { return byte() & 1 ? nullptr : "said the stub"; }
void hdEnable(HDenum) {}
void hdDisable(HDenum) {}
HDboolean hdIsEnabled(HDenum) { return byte() & 1; }
void hdGetIntegerv(HDenum, HDint* values) { fill(values, sizeof *values); }
void hdGetDoublev(HDenum name, HDdouble* values) { answer(name, values); }
HDstring hdGetString(HDenum) {
  const std::uint8_t how = byte();
  if (how & 1)
    return nullptr;
  constexpr const char* kNames[] = {"PHANTOM Omni", "PHANTOM Premium 3.0", "Touch",
                                    "\xff\x01 no text", ""};
  return kNames[how / 2 % 5];
}
void hdSetDoublev(HDenum name, const HDdouble* values) {
  if (name == kCurrentForce)
    set(values, g.force);
  if (name == kCurrentTorque)
    set(values, g.torque);
}
HDenum hdCheckCalibration() { return byte() < 240 ? kCalibrationOk : kCalibrationNeedsUpdate; }
void hdUpdateCalibration(HDenum) {}
void hdStartScheduler() { fuzz_hd_tick(); }
void hdStopScheduler() { g.callback = nullptr; }
void hdSetSchedulerRate(HDulong) {}
HDSchedulerHandle hdScheduleAsynchronous(HDSchedulerCallback callback, void* data, HDushort) {
  g.callback = callback, g.callback_data = data;
  return 1;
}
void hdUnschedule(HDSchedulerHandle) { g.callback = nullptr; }

}  // extern "C"
