#pragma once
/// Devices on a command line that a recording stands for: `replay:BAG`, a bag's folder or one of
/// its files.
#include <memory>
#include <string>

#include "devices/device_options.hpp"
#include "devices/recorded/recorded_hand.hpp"

namespace voxtouch::device_node {

/// The hand in the bag behind `replay:BAG`: the samples of the session that has most of them, and
/// the device as it was described then. `settings`: with several rigs in the bag, `rig` chooses
/// one. Null for any other device. Throws std::runtime_error, a sentence: no bag, a damaged one,
/// one of another program or version, without device samples or a description. Holds the samples in
/// memory, 0.2 MB for each second.
std::shared_ptr<const recorded::RecordedHand> recorded_hand(
    const std::string& device, const devices::DeviceSettings& settings);

/// What is to be told of it: how long it lasts, and where the recording has no samples.
std::string about(const recorded::RecordedHand& hand, const std::string& device);

}  // namespace voxtouch::device_node
