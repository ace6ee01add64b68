#pragma once
/// A device that plays a recorded hand: it goes where the recording went and takes no notice of the
/// force that it is commanded.
#include <memory>

#include "devices/device_options.hpp"
#include "devices/driver.hpp"
#include "devices/recorded/recorded_hand.hpp"

namespace voxtouch::recorded {

/// Time moves by one period with each `read`. Commands are checked as a device's are, and then
/// dropped: the loop is open, so that a run with this device says nothing about stability or about
/// what a hand would have done. No clock: the same calls give the same bits.
class RecordedDevice final : public devices::Driver {
 public:
  /// Throws as HandPlayer does.
  RecordedDevice(RecordedHand hand, double speed) : player_(std::move(hand), speed) {}

  const DeviceDescription& description() const noexcept override { return player_.description(); }
  devices::DeviceResult<devices::DeviceSample> read(std::chrono::microseconds) noexcept override {
    return player_.sample(next_++);
  }
  devices::DeviceResult<void> write(const Wrench& command) noexcept override;
  void stop() noexcept override {}
  bool simulated() const noexcept override { return true; }
  std::uint64_t recorded_samples() const noexcept override { return player_.count(); }

 private:
  HandPlayer player_;
  std::uint64_t next_ = 0;
};

/// The device "replay:BAG" of options.recorded; its setting `speed` is 1 unless given; `rig` is for
/// whoever reads the bag. Throws devices::DeviceOpenError.
std::unique_ptr<devices::Driver> open_recorded(const devices::DeviceOptions& options);
/// The description of the device that was recorded.
DeviceDescription describe_recorded(const devices::DeviceOptions& options);

}  // namespace voxtouch::recorded
