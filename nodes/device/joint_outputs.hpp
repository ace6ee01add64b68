#pragma once
/// Publishes /joint_states and /robot_description of an arm for ROS tools, while they have a
/// reader.
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <thread>

#include "devices/arm/arm_description.hpp"
#include "devices/driver.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/display_sampler.hpp"
#include "nodes/runtime/spsc_queue.hpp"

namespace voxtouch::device_node {

class JointOutputs {
 public:
  JointOutputs(const bus::Participant& participant, const std::string& rig,
               const arm::ArmDescription& arm, qos::TimeMode mode);
  ~JointOutputs();
  JointOutputs(const JointOutputs&) = delete;
  JointOutputs& operator=(const JointOutputs&) = delete;

  /// Called by the loop: joint angles [rad] of the sample at `sample_ns`, by the device's clock.
  /// Real-time safe.
  void show(std::span<const double> joints, std::int64_t sample_ns) noexcept;

 private:
  static constexpr std::size_t kMaxJoints = 8;
  struct Moment {
    std::int64_t stamp_ns = 0;
    std::array<double, kMaxJoints> at{};
    std::uint32_t count = 0;
  };
  void run();
  void write(const Moment& moment);

  const std::string urdf_;
  std::vector<std::string> names_;
  const qos::TimeMode mode_;
  bus::Writer<msg::sensor_msgs_JointState> states_;
  bus::Writer<msg::std_msgs_String> description_;
  runtime::DisplaySampler regular_;
  runtime::SpscQueue<Moment, 64> due_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// A driver whose joints are published. All calls except `lead_hand` are forwarded.
class JointPublishingDriver final : public devices::Driver {
 public:
  JointPublishingDriver(std::unique_ptr<devices::Driver> driver,
                        const bus::Participant& participant, const std::string& rig,
                        const arm::ArmDescription& arm, qos::TimeMode mode)
      : outputs_(participant, rig, arm, mode),
        driver_(std::move(driver)) {}
  const DeviceDescription& description() const noexcept override { return driver_->description(); }
  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept override {
    auto sample = driver_->read(timeout);
    if (sample && sample->pose_valid)
      outputs_.show(driver_->joints(), sample->time_ns);
    return sample;
  }
  devices::DeviceResult<void> write(const Wrench& command) noexcept override {
    return driver_->write(command);
  }
  void stop() noexcept override { driver_->stop(); }
  bool simulated() const noexcept override { return driver_->simulated(); }
  std::string last_error() const override { return driver_->last_error(); }
  std::string_view serial() const noexcept override { return driver_->serial(); }
  const arm::ArmDescription* arm_description() const noexcept override {
    return driver_->arm_description();
  }
  std::span<const double> joints() const noexcept override { return driver_->joints(); }

 private:
  JointOutputs outputs_;
  std::unique_ptr<devices::Driver> driver_;  ///< destroyed first
};

}  // namespace voxtouch::device_node
