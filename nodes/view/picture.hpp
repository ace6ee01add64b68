#pragma once
/// What of the ring can be seen now, and the strip charts of its last seconds: messages in, JSON
/// for the page out. One thread; no clock.
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/scene/scene.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::view {

/// The charts show one row for each stretch of this length, with the largest values in it: no peak
/// is lost.
inline constexpr std::int64_t kRowNs = 8'000'000;
/// How much of the past a page gets that comes later.
inline constexpr double kPastS = 10.0;

/// How long samples took from the device's write to the write of their command.
class LatencyCounts {
 public:
  static constexpr double kBinUs = 25.0;
  static constexpr std::size_t kBins = 41;  ///< the last one holds all that took longer

  /// When the device wrote a sample and the coupling its command, by one clock; 0: not known.
  void sample(std::uint64_t sequence, std::int64_t written_ns) noexcept;
  void command(std::uint64_t sequence, std::int64_t written_ns) noexcept;
  void clear() noexcept { *this = {}; }
  /// Median and 99th percentile [us] and the counts of the last seconds; null where there are none.
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
  /// `written_ns`: when its writer wrote it, or 0 where that is not known.
  void take(const msg::DeviceState& state, std::int64_t written_ns);
  void take(const msg::ContactState& contact);
  void take(const msg::ForceCommand& command, std::int64_t written_ns);
  /// As if nothing had ever come.
  void forget() { *this = {}; }

  /// Something has come since the last frame.
  bool has_news() const noexcept { return news_; }
  /// The newest sample, and the rows of the charts that are new since the last frame. `scene` (if
  /// known) says how the device lies in the world and where moving objects are.
  nlohmann::json frame(const scene::Scene* scene);
  /// All rows of the last kPastS.
  nlohmann::json past(const scene::Scene* scene);
  nlohmann::json latency() const { return latency_.to_json(); }
  const std::optional<msg::DeviceState>& state() const noexcept { return state_; }
  const std::optional<msg::ContactState>& contact() const noexcept { return contact_; }

 private:
  struct Row {
    std::optional<msg::ForceCommand> command;  ///< with the largest force
    std::optional<msg::ContactState> contact;  ///< the deepest, or the one with the largest force
  };
  void begin(std::uint64_t session, std::int64_t sample_time_ns);
  Row* row(std::int64_t sample_time_ns);
  void close_rows(const scene::Scene* scene);
  nlohmann::json row_json(std::int64_t index, const Row& row, const scene::Scene* scene) const;

  std::uint64_t session_ = 0;
  std::optional<std::int64_t> begin_ns_;  ///< device's clock at the session's begin
  bool news_ = false;
  double time_s_ = 0.0;  ///< of the newest sample, since the session's begin
  std::optional<msg::DeviceState> state_;
  std::optional<msg::ContactState> contact_;
  std::optional<msg::ForceCommand> command_;
  std::map<std::int64_t, Row> open_;   ///< rows that may still change
  std::int64_t closed_to_ = -1;        ///< rows up to this one have been given away
  std::deque<nlohmann::json> closed_;  ///< of the last kPastS
  std::size_t fresh_ = 0;              ///< how many of them no frame has had
  LatencyCounts latency_;
};

}  // namespace voxtouch::view
