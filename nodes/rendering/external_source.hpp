#pragma once
/// The wrench of the effect `external`: from one writer outside the ring, read next to the loop.
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/types/latest_value.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/counters.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/status_text.hpp"

namespace voxtouch::rendering_node {

enum class ExternalCounter : std::uint8_t {
  kTaken,
  kNotFinite,
  kWrongFrame,
  kLate,
  kEnergyGeneratedJ
};
inline constexpr auto kExternalTable = [] {
  using enum ExternalCounter;
  return std::to_array<runtime::CounterRow<ExternalCounter>>({
      {kTaken, "external_samples", "samples"},
      {kNotFinite, "external_not_finite", "samples"},
      {kWrongFrame, "external_wrong_frame", "samples"},
      {kLate, "external_late", "samples"},
      {kEnergyGeneratedJ, "external_energy_generated_j", "J"},
  });
}();

/// Once a session has begun, the only participant with a writer on the topic is followed until its
/// writer has gone or another session begins. Of several none is. The samples of others are
/// refused, counted and named. Without DDS Security a participant may be forged; the effect's
/// bounds hold all the same.
class ExternalSource {
 public:
  /// The scene has the effect. Throws bus::Error where its topic is one of the ring's own, or the
  /// keys give no right to it.
  ExternalSource(const bus::Participant& participant, const runtime::NodeOptions& options,
                 const scene::Scene& scene);
  ~ExternalSource();
  ExternalSource(const ExternalSource&) = delete;
  ExternalSource& operator=(const ExternalSource&) = delete;

  // Of the loop. Real-time safe.
  void begin_session(std::uint64_t session) noexcept {
    session_.store(session, std::memory_order_release);
  }
  /// The newest value of the session that has not been taken yet, W, recorded as of the sample
  /// `next`. One that waited for longer than kMaxWaitNs is skipped.
  std::optional<Wrench> take(const msg::DeviceState& next) noexcept;
  /// Energy that the effect gave to the hand in one sample, in W [J]; below 0: taken.
  void count_energy(double joules) noexcept {
    counters_.note(ExternalCounter::kEnergyGeneratedJ, joules);
  }
  static constexpr std::int64_t kMaxWaitNs = 100'000'000;

  // The monitor.
  void report_to(const runtime::NodeRegistry& registry, runtime::NodeReport& report,
                 runtime::StatusText& status);

 private:
  struct Arrived {
    Wrench wrench;  ///< W
    std::uint64_t session = 0;
    std::int64_t at_ns = 0;
  };
  using FrameText = std::array<char, 65>;

  void run();
  void receive(const msg::geometry_msgs_WrenchStamped& message);
  void look();
  /// Which writers or which frame is refused; empty: none.
  std::string diagnostic(const runtime::NodeRegistry& registry) const;
  void look_for_writer(const std::set<bus::Guid>& matched);

  const std::string topic_, device_frame_;
  const Quat device_in_world_;
  const std::string about_;
  std::unique_ptr<bus::Following> following_;  ///< outlives the reader, which asks it
  bus::Reader<msg::geometry_msgs_WrenchStamped> reader_;
  bus::Writer<msg::ExternalSample> records_;  ///< which sample saw which value, for a replay
  bus::WaitSet wait_set_;
  LatestValue<Arrived> newest_;
  LatestValue<FrameText> bad_frame_;
  std::atomic<std::uint64_t> session_{0};
  runtime::Counters<kExternalTable> counters_;
  // Of the monitor.
  std::optional<bus::Guid> bound_;
  std::uint64_t bound_for_ = 0;  ///< session
  std::set<bus::Guid> conflicting_, others_;
  std::string frame_;  ///< refused first
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::rendering_node
