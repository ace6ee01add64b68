#pragma once
/// The messages of the last seconds, in memory. One thread; no clock.
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "nodes/bag/bag_metadata.hpp"
#include "nodes/bag/error.hpp"

namespace voxtouch::view {

struct RecentMessage {
  std::size_t topic = 0;        ///< index
  std::int64_t written_ns = 0;  ///< when its writer wrote it
  std::vector<std::byte> bytes;
};

class RecentMessages {
 public:
  static constexpr std::int64_t kKeptNs = 10'000'000'000;
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

  /// `latched`: for each topic, whether its last value holds until the next one.
  explicit RecentMessages(std::vector<bool> latched)
      : latched_(std::move(latched)),
        values_(latched_.size()) {}

  void add(std::size_t topic, std::int64_t written_ns, std::span<const std::byte> bytes);
  /// Those of the last kKeptNs, by time. Values that were written before come first, at the time of
  /// the first one.
  std::vector<RecentMessage> all() const;

 private:
  std::vector<bool> latched_;
  std::vector<std::optional<RecentMessage>> values_;  ///< the last one that left the window
  std::deque<RecentMessage> messages_;
  std::int64_t newest_ns_ = 0;
  std::size_t bytes_ = 0;
};

/// Writes a recording to `folder`, which must not contain anything. Error: the disk refuses a part
/// of it; the folder is removed then.
bag::Result<void> write_recording(const std::filesystem::path& folder,
                                  const std::vector<bag::TopicInfo>& topics,
                                  const std::vector<RecentMessage>& messages);

}  // namespace voxtouch::view
