#pragma once
/// The newest sample of the ring and the strip charts of its last seconds: messages in, JSON for
/// the page out. One thread; no clock.
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/scene/scene.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::view {

/// Length of a chart row. A row holds the largest values of its interval, so no peak is lost.
inline constexpr std::int64_t kRowNs = 8'000'000;
/// History that a new page receives.
inline constexpr double kPastS = 10.0;

/// Latency from the device's write of a sample to the write of its command.
class LatencyCounts {
 public:
  static constexpr double kBinUs = 25.0;
  static constexpr std::size_t kBins = 41;  ///< the last one holds all larger values

  /// Write times of sample and command, by one clock; 0: unknown.
  void sample(std::uint64_t sequence, std::int64_t written_ns) noexcept;
  void command(std::uint64_t sequence, std::int64_t written_ns) noexcept;
  void clear() noexcept { *this = {}; }
  /// Median, 99th percentile [us] and counts of the last seconds; null without samples.
  nlohmann::json to_json() const;

 private:
  static constexpr std::size_t kKept = 256, kRecent = 10'000;
  struct Written {
    std::uint64_t sequence = ~std::uint64_t{0};
    std::int64_t at_ns = 0;
  };
  std::array<Written, kKept> written_{};
  std::deque<float> recent_us_;
};

class Picture {
 public:
  /// `written_ns`: write time, or 0 if unknown.
  void take(const msg::DeviceState& state, std::int64_t written_ns);
  void take(const msg::ContactState& contact);
  void take(const msg::ForceCommand& command, std::int64_t written_ns);
  void clear() { *this = {}; }

  /// Whether a message arrived since the last frame.
  bool has_update() const noexcept { return has_update_; }
  /// The newest sample, and the chart rows since the last frame. `scene`, if not null, defines the
  /// frame of the device and the path of moving objects.
  nlohmann::json frame(const scene::Scene* scene);
  /// All rows of the last kPastS.
  nlohmann::json past(const scene::Scene* scene);
  nlohmann::json latency() const { return latency_.to_json(); }
  const std::optional<msg::DeviceState>& state() const noexcept { return state_; }
  const std::optional<msg::ContactState>& contact() const noexcept { return contact_; }

 private:
  struct Row {
    std::optional<msg::ForceCommand> command;  ///< with the largest force
    std::optional<msg::ContactState> contact;  ///< with the largest depth, then force
  };
  void begin(std::uint64_t session, std::int64_t sample_time_ns);
  Row* row(std::int64_t sample_time_ns);
  void close_rows(const scene::Scene* scene);
  nlohmann::json row_json(std::int64_t index, const Row& row, const scene::Scene* scene) const;

  std::uint64_t session_ = 0;
  std::optional<std::int64_t> begin_ns_;  ///< device's clock at the start of the session
  bool has_update_ = false;
  double time_s_ = 0.0;  ///< of the newest sample, since the start of the session
  std::optional<msg::DeviceState> state_;
  std::optional<msg::ContactState> contact_;
  std::optional<msg::ForceCommand> command_;
  std::map<std::int64_t, Row> open_;   ///< rows that may change
  std::int64_t closed_to_ = -1;        ///< rows up to this one are final
  std::deque<nlohmann::json> closed_;  ///< of the last kPastS
  std::size_t unsent_rows_ = 0;        ///< number of rows in `closed_` not sent
  LatencyCounts latency_;
};

}  // namespace voxtouch::view
