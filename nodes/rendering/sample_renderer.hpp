#pragma once
/// From a device sample to the contact that answers it, in the node and in a replay.
#include <cstdint>
#include <optional>

#include "core/rendering/device_mapping.hpp"
#include "core/rendering/live_scene.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

/// No DDS, thread or clock: the same samples and changes give bit-identical answers. Real-time
/// safe. Between two samples the scene and its effects may be changed through `live`.
class SampleRenderer {
 public:
  SampleRenderer(const scene::WorkspaceMapping& device, rendering::BuiltScene& first) noexcept
      : live_(first),
        mapping_(device) {}

  /// Forgets all samples. A session begins with its first good sample, or began at `begin_ns` on
  /// the device's clock.
  void begin_session(std::optional<std::int64_t> begin_ns = {}) noexcept;
  /// From outside the ring, in W, from the sample `next` on. Ignored before a session's first good
  /// sample.
  void take_external(const Wrench& wrench, const msg::DeviceState& next) noexcept;
  /// The contact of one sample, without `time_spent_ns`. An unusable sample is answered with the
  /// last good pose's contact for kMaxRepeats samples, as long as a device holds a command.
  msg::ContactState answer(const msg::DeviceState& state) noexcept;

  rendering::LiveScene& live() noexcept { return live_; }
  const rendering::SceneFrame& frame() const noexcept { return frame_; }  ///< of the last answer
  const rendering::ToolState& tool() const noexcept {
    return mapping_.tool();
  }  ///< of the last answer

 private:
  msg::ContactState message(const msg::DeviceState& state, bool good, bool fading) noexcept;

  static constexpr int kMaxRepeats = 3;
  rendering::LiveScene live_;
  rendering::DeviceMapping mapping_;
  rendering::SceneFrame frame_;
  std::optional<std::int64_t>
      session_begin_ns_;  ///< device clock of the first good sample answered
  int refused_in_a_row_ = 0;
};

}  // namespace voxtouch::rendering_node
