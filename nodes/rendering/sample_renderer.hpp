#pragma once
/// Computes the contact that answers a device sample, in the node and in a replay.
#include <cstdint>
#include <optional>

#include "core/rendering/device_mapping.hpp"
#include "core/rendering/live_scene.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

/// Answers device samples with contact states.
/// It uses no DDS, threads or clocks: equal samples and changes give bit-identical answers.
/// Real-time safe. Between two samples the scene and its effects may be changed through `live`.
class SampleRenderer {
 public:
  SampleRenderer(const scene::WorkspaceMapping& device, rendering::BuiltScene& first) noexcept
      : live_(first),
        mapping_(device) {}

  /// Discards all samples. The session starts with its first valid sample, or at `begin_ns` on the
  /// device's clock.
  void begin_session(std::optional<std::int64_t> begin_ns = {}) noexcept;
  /// Sets the external wrench, in W, from the sample `next` on. Ignored until the session has a
  /// valid sample.
  void take_external(const Wrench& wrench, const msg::DeviceState& next) noexcept;
  /// The contact of one sample, without `time_spent_ns`. For up to kMaxRepeats unusable samples it
  /// repeats the contact of the last valid pose; a device holds a command equally long.
  msg::ContactState answer(const msg::DeviceState& state) noexcept;

  rendering::LiveScene& live() noexcept { return live_; }
  const rendering::SceneFrame& frame() const noexcept { return frame_; }  ///< of the last answer
  const rendering::ToolState& tool() const noexcept { return mapping_.tool(); }

 private:
  msg::ContactState message(const msg::DeviceState& state, bool good, bool fading) noexcept;

  static constexpr int kMaxRepeats = 3;
  rendering::LiveScene live_;
  rendering::DeviceMapping mapping_;
  rendering::SceneFrame frame_;
  std::optional<std::int64_t>
      session_begin_ns_;  ///< device clock of the first valid sample that was answered
  int refused_in_a_row_ = 0;
};

}  // namespace voxtouch::rendering_node
