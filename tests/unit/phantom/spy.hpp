#pragma once
/// Wraps the simulated library for the driver: records the calls in order, and returns wrong
/// answers on request.
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "devices/phantom/hd_library.hpp"

namespace voxtouch::phantom_test {

class Spy {
 public:
  /// The one spy; puts itself in the place of the functions the first time.
  static Spy& instance();

  /// Forgets calls and plans.
  void reset();
  std::vector<std::string> calls() const;
  /// The calls() that begin with one of these.
  std::vector<std::string> calls(const std::vector<std::string>& beginnings) const;

  /// hdInitDevice fails with this code as often as this.
  void fail_init(phantom::hd::HDerror code, int times);
  /// hdGetError returns this once, before the library's errors.
  void plant_error(phantom::hd::HDerror code);
  /// Changes the results of hdGetDoublev.
  void change_reading(std::function<void(phantom::hd::HDenum name, double* values)> change);
  /// hdStartScheduler does nothing.
  void swallow_start();

  // for the replaced functions
  void note(std::string call);
  phantom::hd::HDerror next_init_failure();
  phantom::hd::HDerror next_error();
  void touch(phantom::hd::HDenum name, double* values);
  bool start_swallowed() const;
  phantom::hd::Api real;

 private:
  Spy();
  mutable std::mutex mutex_;
  std::vector<std::string> calls_;
  std::vector<phantom::hd::HDerror> planted_;
  std::function<void(phantom::hd::HDenum, double*)> change_;
  phantom::hd::HDerror init_code_ = phantom::hd::kSuccess;
  int init_times_ = 0;
  bool swallow_start_ = false;
};

}  // namespace voxtouch::phantom_test
