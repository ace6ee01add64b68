#include "tests/attack/network/garbage.hpp"

#include <iterator>

#include "tests/attack/network/draft.hpp"
#include "tests/attack/network/ghost.hpp"

namespace voxtouch::attack {
namespace {

// Submessages of RTPS 2.2 and of DDS Security; entities of discovery, liveliness and type lookup,
// and none.
constexpr std::uint8_t kSubmessages[] = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d,
                                         0x0e, 0x0f, 0x12, 0x13, 0x15, 0x16, 0x30,
                                         0x31, 0x32, 0x33, 0x34, 0x80, 0x81};
constexpr std::uint32_t kEntities[] = {0x000003c2, 0x000003c7, 0x000004c2, 0x000004c7, 0x000100c2,
                                       0x000100c7, 0x000200c2, 0x000200c7, 0x000300c3, 0x000300c4,
                                       0x000301c3, 0x000301c4, 0x000002c2, 0x00000103, 0x00000104,
                                       0x000001c1, 0};
// Parameters that discovery reads, including Cyclone's.
constexpr std::uint16_t kParameters[] = {
    0x0005, 0x0007, 0x0015, 0x0016, 0x001a, 0x001b, 0x001d, 0x001e, 0x0021, 0x0023, 0x0025,
    0x0029, 0x002b, 0x002c, 0x002d, 0x002e, 0x002f, 0x0030, 0x0031, 0x0032, 0x0033, 0x0034,
    0x0035, 0x0040, 0x0041, 0x0043, 0x0049, 0x0050, 0x0052, 0x0058, 0x0059, 0x005a, 0x0062,
    0x0070, 0x0071, 0x0072, 0x0073, 0x0074, 0x0075, 0x0077, 0x8001, 0x8002, 0x800f, 0x8019};

class Maker : public Draft {
 public:
  using Draft::Draft;

  std::size_t any_length() { return one_in(200) ? below(65508) : below(1473); }

  void header(const Neighbours& neighbours, bool spoofed) {
    for (const char c : {'R', 'T', 'P', 'S'})
      byte(static_cast<std::uint8_t>(c));
    byte(2), byte(one_in(10) ? any() : 1);
    one_in(2) ? (byte(1), byte(0x10)) : noise(2);  // Cyclone DDS, or any vendor
    if (!spoofed || neighbours.prefixes.empty())
      return noise(12);
    const GuidPrefix& prefix =
        *std::next(neighbours.prefixes.begin(),
                   static_cast<std::ptrdiff_t>(below(neighbours.prefixes.size())));
    append(prefix);
  }

  /// Four bytes, then as many as they declare, or not.
  void submessage(const Neighbours& neighbours) {
    byte(one_in(10) ? any() : one_of(kSubmessages));
    byte(one_in(2) ? 1 : any());
    const std::size_t length = below(100);
    number(static_cast<std::uint16_t>(one_in(4) ? any() : one_in(8) ? 0 : length));
    if (length >= 12 && !neighbours.prefixes.empty() &&
        one_in(4)) {  // as INFO_DST: the destination of the rest
      const GuidPrefix& prefix =
          *std::next(neighbours.prefixes.begin(),
                     static_cast<std::ptrdiff_t>(below(neighbours.prefixes.size())));
      append(prefix);
      return noise(length - prefix.size());
    }
    if (length < 8 || one_in(3))
      return noise(length);
    big_endian(one_of(kEntities)), big_endian(one_of(kEntities));
    if (length < 16 || one_in(2))
      return noise(length - 8);
    number<std::uint32_t>(0),
        number(static_cast<std::uint32_t>(one_in(2) ? below(20) : any()));  // a sequence number
    noise(length - 16);
  }

  /// DATA of a discovery writer: a list of parameters of random kind, length and content.
  void announcement() {
    byte(kData), byte(one_in(4) ? 0x05 | (any() & 0x0a) : 0x05);
    const std::size_t size_at = size();
    number<std::uint16_t>(0);
    number<std::uint16_t>(0), number(static_cast<std::uint16_t>(one_in(20) ? any() : 16));
    big_endian(one_in(2) ? 0 : one_of(kEntities)), big_endian(one_of(kEntities));
    number<std::uint32_t>(0), number(static_cast<std::uint32_t>(one_in(10) ? any() : 1 + below(5)));
    byte(0),
        byte(one_in(10)  ? any()
             : one_in(4) ? 1
                         : 3),
        number<std::uint16_t>(0);  // parameter list, or plain CDR
    for (std::uint64_t n = below(12); n > 0; --n) {
      number(one_in(10) ? static_cast<std::uint16_t>(any()) : one_of(kParameters));
      const std::size_t length = 4 * below(one_in(4) ? 60 : 8);
      number(static_cast<std::uint16_t>(one_in(20) ? any() : length));
      // small numbers are lengths, counts and enumerators; random ones rarely are
      for (std::size_t word = 0; word < length / 4; ++word)
        number(static_cast<std::uint32_t>(one_in(2) ? below(9) : any()));
    }
    if (!one_in(10))
      number<std::uint32_t>(1);  // end of the list
    set_length(size_at, size() - size_at - 2);
  }

  void flipped(const Bytes& announcement) {
    bytes_ = announcement;
    for (std::uint64_t n = 1 + below(16); n > 0; --n)
      bytes_[below(bytes_.size())] ^= static_cast<std::uint8_t>(1U << below(8));
    if (one_in(8))
      bytes_.resize(1 + below(bytes_.size()));
  }
};

}  // namespace

Bytes make_garbage(Garbage kind, std::uint64_t seed, std::uint64_t i,
                   const Neighbours& neighbours) {
  Maker maker(seed, i);
  const auto& announcements = neighbours.announcements;
  if (kind == Garbage::kGhosts)
    return make_ghost(seed, i / kGhostSteps, i % kGhostSteps, neighbours);
  if (kind == Garbage::kBytes) {
    maker.noise(maker.any_length());
  } else if (kind == Garbage::kFlipped && !announcements.empty()) {
    maker.flipped(announcements[maker.below(announcements.size())]);
  } else {
    const bool spoofed = kind == Garbage::kSpoofed;
    maker.header(neighbours, spoofed);
    const bool announcing = kind == Garbage::kDiscovery || (spoofed && maker.one_in(2));
    for (std::uint64_t n = 1 + maker.below(8); n > 0; --n)
      announcing && !maker.one_in(4) ? maker.announcement() : maker.submessage(neighbours);
  }
  return std::move(maker).take();
}

}  // namespace voxtouch::attack
