#pragma once
/// Moves the hand of a simulated device to targets from one page at a time.
#include <cstdint>
#include <mutex>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "core/scene/scene.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::view {

/// The first page that sends a target controls the hand until it closes, or until it is idle for
/// kIdleTimeoutNs and another page sends a target. All but the constructor are thread-safe.
class HandLead {
 public:
  static constexpr std::int64_t kIdleTimeoutNs = 10'000'000'000;
  /// A page sends 60 targets a second. Of a client that sends more, the others are ignored.
  static constexpr double kTargetsPerS = 66.0;
  static constexpr double kBurst = 6.0;  ///< targets that may arrive at once

  /// Throws bus::Error.
  HandLead(const bus::Participant& participant, const runtime::NodeOptions& options);
  ~HandLead();
  HandLead(const HandLead&) = delete;
  HandLead& operator=(const HandLead&) = delete;

  /// Sets the frames of the device.
  void set_scene(const scene::Scene& scene);
  /// Sets the newest sample of the ring's device.
  void set_state(const msg::DeviceState& state);
  /// Claims the role `page` in the device's session. Call it at most ten times a second.
  void claim();

  /// Sets the target of page `page`, T in W: {"p": [x, y, z], "q": [x, y, z, w]}. Throws
  /// nlohmann::json::exception for other JSON.
  void set_target(std::uint64_t page, const nlohmann::json& target, std::int64_t now_ns);
  void close(std::uint64_t page);
  /// {"page": page in control, or null, "target": [x, y, z, qx, qy, qz, qw] in W, or null}.
  nlohmann::json to_json() const;

 private:
  bool is_within_rate(std::int64_t now_ns);

  struct DeviceFrames {
    Pose pose_WD, pose_PT;
    double position_scale = 1.0;
  };
  mutable std::mutex mutex_;
  bus::Writer<msg::OperatorTarget> targets_;
  runtime::StatusWriter status_;
  std::optional<DeviceFrames> frames_;
  std::optional<msg::DeviceState> state_;
  std::optional<std::uint64_t> controlling_page_;
  std::optional<Pose> target_;  ///< T in W
  std::int64_t target_time_ns_ = 0;
  double allowance_ = kBurst;  ///< targets that may be sent at allowance_time_ns_
  std::int64_t allowance_time_ns_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace voxtouch::view
