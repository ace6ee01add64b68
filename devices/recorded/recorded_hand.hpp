#pragma once
/// A hand's way as a device gave it once: what a recorded device plays.
#include <cstdint>
#include <vector>

#include "core/types/device_description.hpp"
#include "devices/driver.hpp"

namespace voxtouch::recorded {

constexpr double kMinSpeed = 0.01, kMaxSpeed = 10.0;  ///< times as fast as recorded

/// One session of a recording. Whoever reads the recording fills it in.
struct RecordedHand {
  DeviceDescription description;  ///< of the device that was recorded
  std::vector<devices::DeviceSample>
      samples;  ///< in D, by time, each later than the one before; finite
};

/// The recorded samples at even steps, `speed` times as fast as they were made: sample k stands for
/// `speed * k` periods after the first. A step that falls on a recorded sample within 1 us is that
/// sample, bit for bit (at speed 1 that is each sample of a device in simulated time); between two
/// samples position and twist go in a straight line, the orientation along the shortest arc, and
/// the buttons are the earlier one's. Twists are `speed` times the recorded ones [m/s, rad/s].
/// Stamps count from 0 in periods of the device.
class HandPlayer {
 public:
  /// Throws std::runtime_error, a sentence: no sample, samples that are not finite, lie before time
  /// 0 or do not go forward in time, a speed outside kMinSpeed to kMaxSpeed.
  HandPlayer(RecordedHand hand, double speed);

  const DeviceDescription& description() const noexcept { return hand_.description; }
  std::uint64_t count() const noexcept { return count_; }  ///< samples in all, at least 1
  /// Sample k; the last one, at rest, from count() on. Takes the samples in order: going back in k
  /// searches anew. Real-time safe.
  devices::DeviceSample sample(std::uint64_t k) noexcept;

 private:
  devices::DeviceSample played(devices::DeviceSample sample, std::uint64_t k) const noexcept;

  RecordedHand hand_;
  double speed_, period_ns_;
  std::uint64_t count_ = 0;
  std::size_t at_ = 0;  ///< the last sample that is not later than the one given out last
};

}  // namespace voxtouch::recorded
