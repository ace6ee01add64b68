#pragma once
/// A simulated device whose hand a page leads: the page's targets go to the hand before each
/// sample.
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "devices/driver.hpp"
#include "nodes/bus/followed_reader.hpp"
#include "nodes/runtime/node_host.hpp"
#include "nodes/runtime/role_binding.hpp"

namespace voxtouch::device_node {

/// Takes the targets of the one participant that has the role `page`; those of all others are
/// refused, counted and named. All else is the driver's own.
class LedDriver final : public devices::Driver {
 public:
  /// `driver` has been opened with DeviceOptions::is_led. Throws bus::Error.
  LedDriver(std::unique_ptr<devices::Driver> driver, const runtime::NodeHost& host,
            std::uint64_t session);

  const DeviceDescription& description() const noexcept override { return driver_->description(); }
  /// The newest target that has come since the last call leads the hand from this sample on.
  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept override;
  devices::DeviceResult<void> write(const Wrench& command) noexcept override {
    return driver_->write(command);
  }
  void stop() noexcept override { driver_->stop(); }
  bool simulated() const noexcept override { return driver_->simulated(); }
  std::string_view serial() const noexcept override { return driver_->serial(); }

  /// Of the monitor's thread: binds the page, reports who it is and whose targets are refused.
  void report_to(const runtime::NodeRegistry& registry, runtime::NodeReport& report,
                 runtime::StatusText& status);

 private:
  std::unique_ptr<devices::Driver> driver_;
  const std::uint64_t session_;
  bus::FollowedReader<msg::OperatorTarget> targets_;
  runtime::RoleBinding page_;
  std::atomic<std::uint64_t> taken_{0};
};

}  // namespace voxtouch::device_node
