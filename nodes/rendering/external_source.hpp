#pragma once
/// Wrench of the effect `external`. It comes from one writer outside the ring and is read next to
/// the loop.
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

/// Follows one participant outside the ring that publishes the external wrench.
/// Once a session has begun, the only participant with a writer on the topic is followed until that
/// writer leaves or another session begins. If several participants have writers, none is followed.
/// Samples of other participants are refused, counted and reported by name. Without DDS Security a
/// participant may be forged; the bounds of the effect still hold.
class ExternalSource {
 public:
  /// Requires a scene with the effect. Throws bus::Error if its topic belongs to the ring or if the
  /// keys grant no right to it.
  ExternalSource(const bus::Participant& participant, const runtime::NodeOptions& options,
                 const scene::Scene& scene);
  ~ExternalSource();
  ExternalSource(const ExternalSource&) = delete;
  ExternalSource& operator=(const ExternalSource&) = delete;

  // Called by the loop. Real-time safe.
  void begin_session(std::uint64_t session) noexcept {
    session_.store(session, std::memory_order_release);
  }
  /// Takes the newest unread wrench of the session, in W, and records it for the sample `next`. A
  /// value that waited longer than kMaxWaitNs is skipped.
  std::optional<Wrench> take(const msg::DeviceState& next) noexcept;
  /// Adds the energy that the effect gave to the operator in one sample, in W [J]. Negative: energy
  /// taken.
  void count_energy(double joules) noexcept {
    counters_.note(ExternalCounter::kEnergyGeneratedJ, joules);
  }
  static constexpr std::int64_t kMaxWaitNs = 100'000'000;

  // Called by the monitor.
  void report_to(const runtime::NodeRegistry& registry, runtime::NodeReport& report,
                 runtime::StatusText& status);

 private:
  struct Arrived {
    Wrench wrench;  ///< in W
    std::uint64_t session = 0;
    std::int64_t at_ns = 0;
  };
  using FrameText = std::array<char, 65>;

  void run();
  void receive(const msg::geometry_msgs_WrenchStamped& message);
  void poll();
  /// Describes refused writers or a refused frame; empty if there are none.
  std::string diagnostic(const runtime::NodeRegistry& registry) const;
  void look_for_writer(const std::set<bus::Guid>& matched);

  const std::string topic_, device_frame_;
  const Quat device_in_world_;
  const std::string about_;
  std::unique_ptr<bus::Following> following_;  ///< outlives the reader, which polls it
  bus::Reader<msg::geometry_msgs_WrenchStamped> reader_;
  bus::Writer<msg::ExternalSample> records_;  ///< which sample used which value, for a replay
  bus::WaitSet wait_set_;
  LatestValue<Arrived> newest_;
  LatestValue<FrameText> bad_frame_;
  std::atomic<std::uint64_t> session_{0};
  runtime::Counters<kExternalTable> counters_;
  // Owned by the monitor.
  std::optional<bus::Guid> bound_;
  std::uint64_t bound_for_ = 0;  ///< session of the binding
  std::set<bus::Guid> conflicting_, others_;
  std::string frame_;  ///< the first refused frame
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::rendering_node
