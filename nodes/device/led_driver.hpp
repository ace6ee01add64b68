#pragma once
/// A simulated device whose operator is led by a page. Each sample first applies the newest target
/// of the page.
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "devices/driver.hpp"
#include "nodes/bus/followed_reader.hpp"
#include "nodes/runtime/node_host.hpp"
#include "nodes/runtime/role_binding.hpp"

namespace voxtouch::device_node {

/// Accepts the targets of the one participant with the role `page`. Targets of others are refused,
/// counted and reported by name.
class LedDriver final : public devices::Driver {
 public:
  /// `driver` must have been opened with DeviceOptions::is_led. Throws bus::Error.
  LedDriver(std::unique_ptr<devices::Driver> driver, const runtime::NodeHost& host,
            std::uint64_t session);

  const DeviceDescription& description() const noexcept override { return driver_->description(); }
  /// The newest target since the last call leads the operator from this sample on.
  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept override;
  devices::DeviceResult<void> write(const Wrench& command) noexcept override {
    return driver_->write(command);
  }
  void stop() noexcept override { driver_->stop(); }
  bool simulated() const noexcept override { return driver_->simulated(); }
  std::string_view serial() const noexcept override { return driver_->serial(); }

  /// Called by the monitor: binds the page, and reports its participant and refused targets.
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
