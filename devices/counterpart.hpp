#pragma once
/// A driver of hardware together with what stands where the hardware stands, so that both live and end as one device.
#include <memory>

#include "devices/driver.hpp"

namespace voxtouch::devices {

/// Hands every call on to the driver. A counterpart adds its own to what it needs to.
class Counterpart : public Driver {
 public:
  const DeviceDescription& description() const noexcept override { return driver_->description(); }
  DeviceResult<DeviceSample> read(std::chrono::microseconds timeout) noexcept override {
    return driver_->read(timeout);
  }
  DeviceResult<void> write(const Wrench& command) noexcept override { return driver_->write(command); }
  void stop() noexcept override {
    if (driver_) driver_->stop();
  }
  bool simulated() const noexcept override { return driver_->simulated(); }
  std::string trouble() const override { return driver_->trouble(); }

 protected:
  std::unique_ptr<Driver> driver_;  // set by whoever derives, before its constructor is over
};

}  // namespace voxtouch::devices
