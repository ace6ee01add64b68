#pragma once
/// Internal to nodes/bag: records of an MCAP file (mcap.dev/spec) as bytes and back. All numbers
/// are little-endian.
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace voxtouch::bag::mcap {

static_assert(std::endian::native == std::endian::little,
              "numbers are copied with their bytes in memory");

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};
inline constexpr std::size_t kRecordHead = 1 + 8;  ///< opcode, length
inline constexpr std::size_t kMessageHead =
    2 + 4 + 8 + 8;  ///< channel, sequence, log time, publish time
inline constexpr std::size_t kFooterSize = kRecordHead + 8 + 8 + 4;  ///< a footer record

/// Readers of others take the time 0 for "none" (rosbags leaves out a chunk that begins with it),
/// and lockstep begins at 0. So a message of time 0 has this log time, in addition to the publish
/// time 0 that it really has.
inline constexpr std::uint64_t kLogTimeOfZero = 1;

/// Puts values one behind the other.
class Bytes {
 public:
  template <std::unsigned_integral T>
  void number(T value) {
    const auto* raw = reinterpret_cast<const std::byte*>(&value);
    data_.insert(data_.end(), raw, raw + sizeof value);
  }
  void raw(std::span<const std::byte> bytes) {
    data_.insert(data_.end(), bytes.begin(), bytes.end());
  }
  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    raw(std::as_bytes(std::span(text)));
  }
  /// Writes the opcode and a length that end() fills in. Returns the offset of the record.
  std::size_t begin(Op op) {
    const std::size_t at = data_.size();
    number(static_cast<std::uint8_t>(op));
    number(std::uint64_t{0});
    return at;
  }
  /// `at`: as begin() gave it.
  void end(std::size_t at) {
    patch(at + 1, static_cast<std::uint64_t>(data_.size() - at - kRecordHead));
  }
  template <std::unsigned_integral T>
  void patch(std::size_t at, T value) {
    std::memcpy(data_.data() + at, &value, sizeof value);
  }
  std::span<const std::byte> view() const noexcept { return data_; }
  std::size_t size() const noexcept { return data_.size(); }
  void clear() noexcept { data_.clear(); }

 private:
  std::vector<std::byte> data_;
};

/// Reads values in sequence. Beyond the end they are 0 or empty, and `good` stays false.
class Cursor {
 public:
  explicit Cursor(std::span<const std::byte> bytes) noexcept : rest_(bytes) {}
  template <std::unsigned_integral T>
  T number() noexcept {
    T value = 0;
    if (const auto raw = take(sizeof value); raw.size() == sizeof value)
      std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }
  std::span<const std::byte> take(std::uint64_t size) noexcept {
    if (size > rest_.size()) {
      good_ = false;
      rest_ = {};
      return {};
    }
    const auto taken = rest_.first(static_cast<std::size_t>(size));
    rest_ = rest_.subspan(static_cast<std::size_t>(size));
    return taken;
  }
  std::string_view text() noexcept {
    const auto raw = take(number<std::uint32_t>());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }
  std::span<const std::byte> rest() noexcept { return take(rest_.size()); }
  bool good() const noexcept { return good_; }
  bool empty() const noexcept { return rest_.empty(); }
  std::size_t left() const noexcept { return rest_.size(); }

 private:
  std::span<const std::byte> rest_;
  bool good_ = true;
};

struct Record {
  Op op{};
  std::span<const std::byte> content;
};
/// The next of consecutive records; empty at the end, or if the last one is incomplete.
inline std::optional<Record> next_record(Cursor& cursor) noexcept {
  if (cursor.left() < kRecordHead)
    return std::nullopt;
  const auto op = static_cast<Op>(cursor.number<std::uint8_t>());
  const auto content = cursor.take(cursor.number<std::uint64_t>());
  return cursor.good() ? std::optional(Record{op, content}) : std::nullopt;
}

}  // namespace voxtouch::bag::mcap
