#pragma once
/// Writes the recorded rows of a fault as a rosbag2 folder, which the tools for the bag of a run
/// can open.
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::faults {

struct FaultTopic {
  std::string name;  ///< with its rig, "/haptic/device/state"
  std::string_view type, hash;
};
template <class T>
FaultTopic topic_of(std::string name) {
  return {std::move(name), msg::Type<T>::ros_name, msg::Type<T>::hash};
}

struct FaultMessage {
  std::size_t topic = 0;  ///< index
  std::int64_t time_ns = 0;
  std::vector<std::byte> bytes;
};

/// Streams of the ring have fixed size and no padding. Their CDR is the struct after a four-byte
/// header for little endian.
template <class T>
FaultMessage message_of(std::size_t topic, std::int64_t time_ns, const T& message) {
  constexpr std::array kLittleEndian{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  FaultMessage out{topic, time_ns, std::vector<std::byte>(sizeof kLittleEndian + sizeof message)};
  std::memcpy(out.bytes.data(), kLittleEndian.data(), sizeof kLittleEndian);
  std::memcpy(out.bytes.data() + sizeof kLittleEndian, &message, sizeof message);
  return out;
}

struct FaultContext {
  std::string node, rig, reason;
};

/// Creates FOLDER/NODE_N, with the smallest free N, containing the messages and fault.json. Returns
/// its path. Throws, with a sentence, on a disk error. Blocks on the disk.
std::filesystem::path write_fault_bag(const std::filesystem::path& folder,
                                      const FaultContext& context,
                                      const std::vector<FaultTopic>& topics,
                                      const std::vector<FaultMessage>& messages);

/// A sentence for each record in FOLDER, by name; empty if the folder does not exist.
std::vector<std::string> fault_records_in(const std::filesystem::path& folder);

}  // namespace voxtouch::faults
