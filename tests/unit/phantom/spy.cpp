#include "spy.hpp"

#include <utility>

namespace voxtouch::phantom_test {
namespace {

using namespace phantom::hd;

Spy& spy() { return Spy::instance(); }

std::string hex(HDenum value) {
  char text[16];
  std::snprintf(text, sizeof text, "%04x", value);
  return text;
}

}  // namespace

Spy::Spy() {
  // The library's functions are the driver's for the whole process; in tests they may be exchanged,
  // since none is called yet.
  auto& api = const_cast<Api&>(phantom::HdLibrary::load(VOXTOUCH_HD_SIM_LIBRARY).api());
  real = api;
  api.hdInitDevice = [](HDstring name) -> HHD {
    spy().note(std::string("init ") + (name != nullptr ? name : "null"));
    if (const HDerror code = spy().next_init_failure(); code != kSuccess) {
      spy().plant_error(code);
      return kInvalidHandle;
    }
    return spy().real.hdInitDevice(name);
  };
  api.hdDisableDevice = [](HHD device) {
    spy().note("disable-device"), spy().real.hdDisableDevice(device);
  };
  api.hdBeginFrame = [](HHD device) { spy().note("begin"), spy().real.hdBeginFrame(device); };
  api.hdEndFrame = [](HHD device) { spy().note("end"), spy().real.hdEndFrame(device); };
  api.hdEnable = [](HDenum what) { spy().note("enable " + hex(what)), spy().real.hdEnable(what); };
  api.hdDisable = [](HDenum what) {
    spy().note("disable " + hex(what)), spy().real.hdDisable(what);
  };
  api.hdSetDoublev = [](HDenum name, const HDdouble* values) {
    spy().note("set " + hex(name) + " " + std::to_string(values[0]));
    spy().real.hdSetDoublev(name, values);
  };
  api.hdGetDoublev = [](HDenum name, HDdouble* values) {
    spy().real.hdGetDoublev(name, values);
    spy().touch(name, values);
  };
  api.hdUpdateCalibration = [](HDenum style) {
    spy().note("calibrate " + std::to_string(style)), spy().real.hdUpdateCalibration(style);
  };
  api.hdScheduleAsynchronous = [](HDSchedulerCallback callback, void* data, HDushort priority) {
    spy().note("schedule " + std::to_string(priority));
    return spy().real.hdScheduleAsynchronous(callback, data, priority);
  };
  api.hdUnschedule = [](HDSchedulerHandle handle) {
    spy().note("unschedule"), spy().real.hdUnschedule(handle);
  };
  api.hdStartScheduler = [] {
    spy().note("start");
    if (!spy().start_swallowed())
      spy().real.hdStartScheduler();
  };
  api.hdStopScheduler = [] { spy().note("stop"), spy().real.hdStopScheduler(); };
  api.hdGetError = []() -> HDErrorInfo {
    if (const HDerror code = spy().next_error(); code != kSuccess)
      return {code, 0, kInvalidHandle};
    return spy().real.hdGetError();
  };
}

Spy& Spy::instance() {
  static Spy* const one = new Spy;
  return *one;
}

void Spy::reset() {
  const std::lock_guard lock(mutex_);
  calls_.clear();
  planted_.clear();
  change_ = {};
  init_times_ = 0;
  swallow_start_ = false;
}

std::vector<std::string> Spy::calls() const {
  const std::lock_guard lock(mutex_);
  return calls_;
}

std::vector<std::string> Spy::calls(const std::vector<std::string>& beginnings) const {
  std::vector<std::string> some;
  for (const std::string& call : calls())
    for (const std::string& beginning : beginnings)
      if (call.starts_with(beginning)) {
        some.push_back(call);
        break;
      }
  return some;
}

void Spy::fail_init(HDerror code, int times) {
  const std::lock_guard lock(mutex_);
  init_code_ = code, init_times_ = times;
}

void Spy::plant_error(HDerror code) {
  const std::lock_guard lock(mutex_);
  planted_.push_back(code);
}

void Spy::change_reading(std::function<void(HDenum, double*)> change) {
  const std::lock_guard lock(mutex_);
  change_ = std::move(change);
}

void Spy::swallow_start() {
  const std::lock_guard lock(mutex_);
  swallow_start_ = true;
}

void Spy::note(std::string call) {
  const std::lock_guard lock(mutex_);
  calls_.push_back(std::move(call));
}

HDerror Spy::next_init_failure() {
  const std::lock_guard lock(mutex_);
  return init_times_ > 0 ? (--init_times_, init_code_) : kSuccess;
}

HDerror Spy::next_error() {
  const std::lock_guard lock(mutex_);
  if (planted_.empty())
    return kSuccess;
  const HDerror code = planted_.back();
  planted_.pop_back();
  return code;
}

void Spy::touch(HDenum name, double* values) {
  const std::lock_guard lock(mutex_);
  if (change_)
    change_(name, values);
}

bool Spy::start_swallowed() const {
  const std::lock_guard lock(mutex_);
  return swallow_start_;
}

}  // namespace voxtouch::phantom_test
