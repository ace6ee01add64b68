#pragma once
/// One initiated device with its servo loop, from the opening to the end, whatever fails between.
#include <optional>
#include <string>
#include <string_view>

#include "devices/phantom/hd_errors.hpp"
#include "devices/phantom/hd_library.hpp"
#include "devices/phantom/phantom_models.hpp"
#include "devices/phantom/phantom_options.hpp"

namespace voxtouch::phantom {

/// Order of the opening: initiate; encoders to zero (devices that have no other calibration);
/// ramping, clamping and, last, force output; callback at the highest priority; servo loop. Where a
/// calibration needs the servo loop (inkwell, automatic) it comes after that, and force output
/// after it. After each step the library's errors are taken and any of them ends the opening.
///
/// Order of the end, from wherever it got to: force output off, servo loop stopped, callback taken
/// out, device disabled.
class HdSession {
 public:
  /// Initiates the device and asks it. Throws DeviceOpenError: another session is open in this
  /// process, no device.
  HdSession(const HdLibrary& library, const PhantomOptions& options);
  ~HdSession();
  HdSession(const HdSession&) = delete;
  HdSession& operator=(const HdSession&) = delete;

  /// From here on `callback(data)` runs once a tick. Throws DeviceOpenError: calibration, servo
  /// loop, rate, a limit.
  void start(hd::HDSchedulerCallback callback, void* data);

  hd::HHD device() const noexcept { return claim_.device; }
  const PhantomFacts& facts() const noexcept { return facts_; }
  bool virtual_time() const noexcept { return virtual_time_; }

 private:
  /// Undone by its destructor, so that a constructor which throws leaves nothing open.
  struct Claim {
    explicit Claim(const hd::Api& functions);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
    const hd::Api& api;
    hd::HHD device = hd::kInvalidHandle;  // 0 is a device
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
