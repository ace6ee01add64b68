#pragma once
/// From a device sample to the contact that answers it: what the node does to each sample, and a
/// replay once more.
#include <cstdint>
#include <optional>

#include "core/rendering/device_mapping.hpp"
#include "core/rendering/live_scene.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

/// No DDS, thread or clock: the same samples and changes give the same bits. Real-time safe.
/// Between two samples the scene and its effects may be changed through `live`.
class SampleRenderer {
 public:
  /// `first` is the scene that runs first; who owns it, see LiveScene.
  SampleRenderer(const scene::WorkspaceMapping& device, rendering::BuiltScene& first) noexcept
      : live_(first),
        mapping_(device) {}

  /// Another device session: all samples so far are forgotten. It begins with its first good
  /// sample, or began at `begin_ns` on the device's clock, with samples that are not known any
  /// more.
  void begin_session(std::optional<std::int64_t> begin_ns = {}) noexcept;
  /// Somebody outside the ring wants this felt, in W, and the sample that is answered next is the
  /// first to see it. Nothing before a session's first good sample.
  void take_external(const Wrench& wrench, const msg::DeviceState& next) noexcept;
  /// The contact of one sample; `time_spent_ns` is left to who has a clock. A sample that cannot be
  /// used is answered with the last good pose's contact for kMaxRepeats samples, as long as a
  /// device holds a command.
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
