#pragma once
/// A fault's rows as a rosbag2 folder, so that whatever opens the bag of a run opens them.
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

/// The ring's streams are of fixed size and without padding: their CDR is the struct behind four
/// bytes that say "little endian".
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

/// Makes FOLDER/NODE_N, the next N that is not there, with the messages and fault.json, and says
/// where. Throws a sentence where the disk refuses. Blocks for the disk.
std::filesystem::path write_fault_bag(const std::filesystem::path& folder,
                                      const FaultContext& context,
                                      const std::vector<FaultTopic>& topics,
                                      const std::vector<FaultMessage>& messages);

/// A sentence for each record in FOLDER, by name; nothing where it is not there.
std::vector<std::string> fault_records_in(const std::filesystem::path& folder);

}  // namespace voxtouch::faults
