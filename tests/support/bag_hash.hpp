#pragma once
/// A hash of the messages of a topic, equal for two runs with bit-identical results, for any
/// recorder timing.
#include <functional>
#include <optional>

#include "tests/support/whole_bag.hpp"

namespace voxtouch::bag {

/// The place of a message in its topic, from its bytes (CDR with encapsulation header); nothing if
/// it has none.
using KeyOf = std::function<std::optional<std::uint64_t>(std::span<const std::byte>)>;

/// sequence_number of DeviceState, ContactState, ForceCommand and ValidationReport: the second
/// uint64, in the message's byte order. The type is not checked: the caller must know it.
std::optional<std::uint64_t> ring_sequence_number(std::span<const std::byte> bytes) noexcept;

struct TopicHash {
  std::uint64_t hash = 0;
  std::uint64_t messages = 0;
  bool operator==(const TopicHash&) const = default;
};

/// FNV-1a (64 bit) over length and bytes of each message, in the order of `key`, equal keys in
/// order of arrival; without a key in order of arrival, as for latched topics. Recording times do
/// not enter. Errors: no such topic; a message that has no key.
Result<TopicHash> hash_topic(const WholeBag& bag, std::string_view topic, const KeyOf& key = {});

}  // namespace voxtouch::bag
