#pragma once
/// One initiated device with its servo loop, from opening to closing, with clean-up after any
/// failure.
#include <optional>
#include <string>
#include <string_view>

#include "devices/phantom/hd_errors.hpp"
#include "devices/phantom/hd_library.hpp"
#include "devices/phantom/phantom_models.hpp"
#include "devices/phantom/phantom_options.hpp"

namespace voxtouch::phantom {

/// Opens and closes a device in the required order.
/// Opening: initiate; zero the encoders (devices without other calibration); set ramping, clamping
/// and, last, force output; schedule the callback at the highest priority; start the servo loop. A
/// calibration that needs the servo loop (inkwell, automatic) follows it, and force output follows
/// the calibration. The errors of the library are read after each step, and any of them aborts the
/// opening.
/// Closing, from any state: force output off, servo loop stopped, callback removed, device
/// disabled.
class HdSession {
 public:
  /// Initiates the device and reads its properties. Throws DeviceOpenError if another session is
  /// open in this process or there is no device.
  HdSession(const HdLibrary& library, const PhantomOptions& options);
  ~HdSession();
  HdSession(const HdSession&) = delete;
  HdSession& operator=(const HdSession&) = delete;

  /// From now on `callback(data)` runs once per tick. Throws DeviceOpenError: calibration, servo
  /// loop, rate, a limit.
  void start(hd::HDSchedulerCallback callback, void* data);

  hd::HHD device() const noexcept { return claim_.device; }
  const PhantomFacts& facts() const noexcept { return facts_; }
  bool virtual_time() const noexcept { return virtual_time_; }

 private:
  /// Released by its destructor, so that a throwing constructor leaves nothing open.
  struct Claim {
    explicit Claim(const hd::Api& functions);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
    const hd::Api& api;
    hd::HHD device = hd::kInvalidHandle;  // 0 is a valid device
    bool initiated = false, scheduled = false, started = false;
    hd::HDSchedulerHandle callback = 0;
  };

  void initiate();
  bool initiate(const char* name, std::string& tried);
  void ask();
  std::optional<double> number(hd::HDenum name);
  std::optional<int> integer(hd::HDenum name);
  void calibrate_encoders();
  void calibrate_running(hd::HDenum style);
  void enable_forces();
  void pause();
  void must(std::string_view what);

  const HdLibrary& library_;
  const hd::Api& api_;
  const PhantomOptions& options_;
  Claim claim_;
  PhantomFacts facts_;
  bool virtual_time_ = false;
};

}  // namespace voxtouch::phantom
