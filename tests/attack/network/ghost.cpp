#include "tests/attack/network/ghost.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "qos/topics.hpp"
#include "tests/attack/network/draft.hpp"

namespace voxtouch::attack {
namespace {

constexpr std::uint8_t kHeartbeat = 7, kGap = 8, kDataFragment = 0x16;
constexpr std::uint32_t kPublications = 0x000003c2, kSubscriptions = 0x000004c2,
                        kLookupRequest = 0x000300c3, kLookupReply = 0x000301c3;
constexpr std::uint16_t kTopicName = 0x05, kTypeName = 0x07, kReliability = 0x1a,
                        kDurability = 0x1d, kDeadline = 0x23, kTypeInformation = 0x75,
                        kEndpointGuid = 0x5a, kSentinel = 0x01, kStatusInfo = 0x71;
constexpr std::uint64_t kWriters = 4, kReaders = 2;

GuidPrefix prefix_of(std::uint64_t seed, std::uint64_t ghost) {
  Draft draft(~seed, ghost);
  draft.noise(12);
  const Bytes bytes = std::move(draft).take();
  GuidPrefix prefix{};
  std::copy(bytes.begin(), bytes.end(), prefix.begin());
  return prefix;
}

const qos::Topic& topic_of(std::uint64_t ghost, std::uint64_t endpoint) {
  return qos::kTopics[(kWriters * ghost + endpoint) % std::size(qos::kTopics)];
}

std::string dds_type(std::string_view ros_type) {
  const std::size_t slash = ros_type.find('/');
  return std::string(ros_type.substr(0, slash)) +
         "::msg::dds_::" + std::string(ros_type.substr(ros_type.rfind('/') + 1)) + "_";
}

constexpr std::uint32_t writer_id(std::uint64_t n) {
  return static_cast<std::uint32_t>((n + 1) << 8 | 0x03);
}
constexpr std::uint32_t reader_id(std::uint64_t n) {
  return static_cast<std::uint32_t>((n + 17) << 8 | 0x04);
}

class Ghost : public Draft {
 public:
  Ghost(std::uint64_t seed, std::uint64_t ghost, std::uint64_t step)
      : Draft(seed ^ 0x67686f7374, ghost * kGhostSteps + step),
        ghost_(ghost),
        step_(step),
        prefix_(prefix_of(seed, ghost)) {}

  void announce(const Neighbours& neighbours) {
    if (neighbours.announcements.empty())
      return;
    bytes_ = neighbours.announcements[below(neighbours.announcements.size())];
    GuidPrefix old{};
    std::copy_n(bytes_.begin() + 8, old.size(), old.begin());
    for (auto at = bytes_.begin();
         (at = std::search(at, bytes_.end(), old.begin(), old.end())) != bytes_.end();)
      at = std::copy(prefix_.begin(), prefix_.end(), at);
  }

  void endpoint(bool writes, std::uint64_t n) {
    const qos::Topic& topic = topic_of(ghost_, n);
    const std::uint32_t discovery = writes ? kPublications : kSubscriptions;
    heartbeat(discovery, n + 1);
    const std::size_t from = data(discovery, n + 1, 3, false);
    parameter(kEndpointGuid, 16), append(prefix_), big_endian(writes ? writer_id(n) : reader_id(n));
    text(kTopicName, qos::dds_name(topic, "haptic")), text(kTypeName, dds_type(topic.type));
    parameter(kReliability, 12), number<std::uint32_t>(2), number<std::uint32_t>(0),
        number<std::uint32_t>(0);
    if (writes) {  // satisfies any reader's request
      parameter(kDurability, 4), number<std::uint32_t>(1);
      parameter(kDeadline, 8), number<std::uint32_t>(0), number<std::uint32_t>(1);
    }
    if (one_in(2))
      words(kTypeInformation, 40);
    if (one_in(4))
      words(static_cast<std::uint16_t>(below(0x90)), 12);
    number(kSentinel), number<std::uint16_t>(0);
    end(from);
  }

  void sample(std::uint64_t n, std::uint64_t sequence_number) {
    heartbeat(writer_id(n), sequence_number);
    const std::size_t from =
        data(writer_id(n), sequence_number, one_in(8) ? 1 + below(255) : 1, one_in(8));
    fill(4 * below(one_in(20) ? 15000 : 200));
    end(from);
  }

  void lookup() {
    const std::uint32_t writer = one_in(2) ? kLookupRequest : kLookupReply;
    heartbeat(writer, 1);
    const std::size_t from = data(writer, 1, one_in(4) ? 1 : 7, false);
    append(prefix_), big_endian(kLookupRequest), number<std::uint32_t>(0), number<std::uint32_t>(1);
    fill(4 * below(100));
    end(from);
  }

  void bookkeeping(std::uint64_t n) {
    const std::size_t from = submessage(one_in(2) ? kHeartbeat : kGap, 1);
    big_endian(0), big_endian(one_in(2) ? writer_id(n) : kPublications);
    fill(8 + 4 * below(20));
    end(from);
  }

  void fragment(std::uint64_t n) {
    const std::size_t from = submessage(kDataFragment, 1);
    number<std::uint16_t>(0), number<std::uint16_t>(28), big_endian(0), big_endian(writer_id(n));
    number<std::uint32_t>(0), number(static_cast<std::uint32_t>(1 + below(20)));
    number(static_cast<std::uint32_t>(one_in(4) ? any() : 1 + below(8)));  // first fragment
    number(static_cast<std::uint16_t>(below(4))),
        number(static_cast<std::uint16_t>(one_in(4) ? any() : 64));  // how many, size
    number(
        static_cast<std::uint32_t>(one_in(4) ? any() : below(2000)));  // bytes of the whole sample
    fill(4 * below(60));
    end(from);
  }

  void header() {
    for (const char c : {'R', 'T', 'P', 'S'})
      byte(static_cast<std::uint8_t>(c));
    byte(2), byte(1), byte(1), byte(0x10), append(prefix_);
  }

 private:
  std::size_t submessage(std::uint8_t kind, std::uint64_t flags) {
    byte(kind), byte(flags), number<std::uint16_t>(0);
    return size();
  }
  void end(std::size_t from) { set_length(from - 2, size() - from); }

  /// Without it a reader stores the samples of a reliable writer without delivery: samples 1 to
  /// `last` are available.
  void heartbeat(std::uint32_t writer, std::uint64_t last) {
    const std::size_t from = submessage(kHeartbeat, 3);
    big_endian(0), big_endian(writer), number<std::uint32_t>(0), number<std::uint32_t>(1);
    number<std::uint32_t>(0), number(static_cast<std::uint32_t>(last)),
        number(static_cast<std::uint32_t>(step_));
    end(from);
  }
  /// All before the payload, with the encapsulation of the payload; returns the argument of end().
  std::size_t data(std::uint32_t writer, std::uint64_t sequence_number, std::uint64_t encoding,
                   bool status) {
    const std::size_t from = submessage(kData, status ? 7 : 5);
    number<std::uint16_t>(0), number<std::uint16_t>(16), big_endian(0), big_endian(writer);
    number<std::uint32_t>(0), number(static_cast<std::uint32_t>(sequence_number));
    if (status)
      parameter(kStatusInfo, 4), number(static_cast<std::uint32_t>(any())), number(kSentinel),
          number<std::uint16_t>(0);
    byte(0), byte(encoding), number<std::uint16_t>(0);
    return from;
  }
  void parameter(std::uint16_t id, std::uint16_t size) { number(id), number(size); }
  void text(std::uint16_t id, const std::string& value) {
    const std::size_t padded = (value.size() + 1 + 3) / 4 * 4;
    parameter(id, static_cast<std::uint16_t>(4 + padded)),
        number(static_cast<std::uint32_t>(value.size() + 1)), append(value);
    for (std::size_t n = value.size(); n < padded; ++n)
      byte(0);
  }
  void words(std::uint16_t id, std::uint64_t most) {
    const std::uint64_t count = below(most);
    parameter(id, static_cast<std::uint16_t>(4 * count)), fill(4 * count);
  }
  /// Words that are small as often as not: small numbers are lengths, counts and enumerators.
  void fill(std::uint64_t count) {
    for (std::uint64_t word = 0; word < count / 4; ++word)
      number(static_cast<std::uint32_t>(one_in(2) ? below(9) : any()));
  }

  std::uint64_t ghost_, step_;
  GuidPrefix prefix_;
};

}  // namespace

Bytes make_ghost(std::uint64_t seed, std::uint64_t ghost, std::uint64_t step,
                 const Neighbours& neighbours) {
  Ghost draft(seed, ghost, step);
  if (neighbours.announcements.empty())
    return {};
  if (step == 0) {
    draft.announce(neighbours);
    return std::move(draft).take();
  }
  draft.header();
  const std::uint64_t n = step - 1;
  if (n < kWriters)
    draft.endpoint(true, n);
  else if (n < kWriters + kReaders)
    draft.endpoint(false, n - kWriters);
  else if (n < kWriters + kReaders + 6)
    draft.sample(n % kWriters, 1 + (n - kWriters - kReaders) / kWriters);
  else if (n == 12)
    draft.lookup();
  else if (n == 13)
    draft.bookkeeping(draft.below(kWriters));
  else
    draft.fragment(draft.below(kWriters));
  return std::move(draft).take();
}

}  // namespace voxtouch::attack
