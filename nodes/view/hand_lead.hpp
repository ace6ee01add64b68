#pragma once
/// The hand of a simulated device, led from pages: one of them at a time.
#include <cstdint>
#include <mutex>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "core/scene/scene.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::view {

/// The first page that aims has the hand until it closes, or has not aimed for kKeptNs while
/// another one does. All but the constructor may be called from any thread.
class HandLead {
 public:
  static constexpr std::int64_t kKeptNs = 10'000'000'000;

  /// Throws bus::Error.
  HandLead(const bus::Participant& participant, const runtime::NodeOptions& options);
  ~HandLead();
  HandLead(const HandLead&) = delete;
  HandLead& operator=(const HandLead&) = delete;

  /// How the device lies in W.
  void set_scene(const scene::Scene& scene);
  /// The newest sample of the ring's device.
  void see(const msg::DeviceState& state);
  /// Ten times a second or less: claims the role `page` in the device's session.
  void claim();

  /// Where page `page` wants the tool to be, T in W: {"p": [x, y, z], "q": [x, y, z, w]}. Throws
  /// nlohmann::json::exception for what is no such thing.
  void aim(std::uint64_t page, const nlohmann::json& target, std::int64_t now_ns);
  void close(std::uint64_t page);
  /// {"page": who has the hand, or null, "target": [x, y, z, qx, qy, qz, qw] in W, or null}.
  nlohmann::json to_json() const;

 private:
  struct Place {
    Pose pose_WD, pose_PT;
    double position_scale = 1.0;
  };
  mutable std::mutex mutex_;
  bus::Writer<msg::OperatorTarget> targets_;
  runtime::StatusWriter status_;
  std::optional<Place> place_;
  std::optional<msg::DeviceState> state_;
  std::optional<std::uint64_t> page_;
  std::optional<Pose> target_;  ///< T in W
  std::int64_t aimed_ns_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace voxtouch::view
