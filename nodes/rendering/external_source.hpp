#pragma once
/// Whom the effect `external` follows: one writer of one topic outside the ring, read beside the
/// loop.
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
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::rendering_node {

/// The rule. The participant that is the only one with a writer on the topic, once a session has
/// begun, is followed until its writer has gone or another session begins; then the next one is.
/// Where several are there while nobody is followed, nobody is. The samples of all others are
/// refused, counted and named. Nothing proves who a participant is: without DDS Security a forged
/// one passes, and the effect's bounds hold all the same.
class ExternalSource {
 public:
  /// For the scene's effect `external`, which there is. Throws bus::Error where its topic is one of
  /// the ring's own, or one to which the keys give no right.
  ExternalSource(const bus::Participant& participant, const runtime::NodeOptions& options,
                 const scene::Scene& scene);
  ~ExternalSource();
  ExternalSource(const ExternalSource&) = delete;
  ExternalSource& operator=(const ExternalSource&) = delete;

  // Of the loop. Real-time safe.
  void begin_session(std::uint64_t session) noexcept {
    session_.store(session, std::memory_order_release);
  }
  /// The newest value of this session that has not been taken yet, W. One that waited for a sample
  /// for longer than kMaxWaitNs is left out.
  std::optional<Wrench> take(std::uint64_t session) noexcept;
  static constexpr std::int64_t kMaxWaitNs = 100'000'000;

  // Of the housekeeping.
  void report_to(const runtime::NodeRegistry& registry, runtime::NodeReport& report);
  /// What a person must know: who is refused, or which frame. Empty: nothing.
  std::string trouble(const runtime::NodeRegistry& registry) const;

 private:
  struct Arrived {
    Wrench wrench;  ///< W
    std::uint64_t session = 0;
    std::int64_t at_ns = 0;
  };
  using FrameText = std::array<char, 65>;
  static constexpr auto kRelaxed = std::memory_order_relaxed;

  void run();
  void receive(const msg::geometry_msgs_WrenchStamped& message);
  void look();
  void look_for_writer(const std::set<bus::Guid>& matched);

  const std::string topic_, device_frame_;
  const Quat device_in_world_;
  const std::string about_;
  std::unique_ptr<bus::Following> following_;  ///< outlives the reader, which asks it
  bus::Reader<msg::geometry_msgs_WrenchStamped> reader_;
  bus::WaitSet wait_set_;
  LatestValue<Arrived> newest_;
  LatestValue<FrameText> bad_frame_;
  std::atomic<std::uint64_t> session_{0}, taken_{0}, late_{0}, not_finite_{0}, wrong_frame_{0};
  // Of the housekeeping alone.
  std::optional<bus::Guid> bound_;
  std::uint64_t bound_for_ = 0;  ///< session
  std::set<bus::Guid> rivals_, others_;
  std::string frame_;  ///< that was refused first
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::rendering_node
