#include "tests/support/bag_hash.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {
namespace {

constexpr std::uint64_t kFnvOffset = 0xcbf29ce484222325U;
constexpr std::uint64_t kFnvPrime = 0x100000001b3U;

std::uint64_t fnv1a(std::uint64_t hash, std::span<const std::byte> bytes) noexcept {
  for (const std::byte byte : bytes)
    hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * kFnvPrime;
  return hash;
}

// The length first, in a fixed byte order: "ab","c" and "a","bc" differ.
std::uint64_t add_message(std::uint64_t hash, std::span<const std::byte> bytes) noexcept {
  std::byte length[8];
  for (unsigned i = 0; i < 8; ++i)
    length[i] = static_cast<std::byte>(bytes.size() >> (8 * i));
  return fnv1a(fnv1a(hash, length), bytes);
}

}  // namespace

std::optional<std::uint64_t> ring_sequence_number(std::span<const std::byte> bytes) noexcept {
  constexpr std::size_t kAt = 4 + 8;  // behind the encapsulation header and session_id
  if (bytes.size() < kAt + 8)
    return std::nullopt;
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data() + kAt, 8);
  // representation identifier: odd is little-endian
  const bool little = (bytes[1] & std::byte{1}) != std::byte{0};
  return little == (std::endian::native == std::endian::little) ? value : __builtin_bswap64(value);
}

Result<TopicHash> hash_topic(const WholeBag& bag, std::string_view topic, const KeyOf& key) {
  auto messages = bag.read_topic(topic, WholeBag::Order::kArrival);
  if (!messages)
    return std::unexpected(messages.error());
  std::vector<std::pair<std::uint64_t, const StoredMessage*>> order;
  order.reserve(messages->size());
  for (const auto& message : *messages) {
    const auto place = key ? key(message.bytes) : std::optional<std::uint64_t>(0);
    if (!place)
      return refuse(
          "Message {} of '{}' ({} bytes) holds no sequence number; hash the topic in order of "
          "arrival.",
          order.size(), topic, message.bytes.size());
    order.emplace_back(*place, &message);
  }
  std::ranges::stable_sort(order, {}, &decltype(order)::value_type::first);
  TopicHash result{kFnvOffset, order.size()};
  for (const auto& [place, message] : order)
    result.hash = add_message(result.hash, message->bytes);
  return result;
}

}  // namespace voxtouch::bag
