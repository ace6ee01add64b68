#pragma once
/// Publishes frames, pose, wrench and markers for RViz, Foxglove, rqt and rosbag, and the clock in
/// lockstep. Reliable writers with a history of ten messages are used while they have a reader.
/// They never block.
#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "nodes/bus/writer.hpp"
#include "nodes/rendering/marker_outputs.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/display_sampler.hpp"
#include "nodes/runtime/spsc_queue.hpp"

namespace voxtouch::rendering_node {

enum class RosOutput : std::uint8_t { kTf, kTfStatic, kClock, kPose, kWrench, kMarkers };

/// Frames: `world` = W. `<rig>/device` = D (fixed). `<rig>/tool` = T at which contact was computed.
/// `<rig>/hand` = T as requested by the operator (with a virtual tool). `<rig>/object/<name>` for
/// each moving object.
class RosOutputs {
 public:
  RosOutputs(const bus::Participant& participant, const std::string& rig, const scene::Scene& scene,
             qos::TimeMode mode);
  ~RosOutputs();
  RosOutputs(const RosOutputs&) = delete;
  RosOutputs& operator=(const RosOutputs&) = delete;

  /// Called by the loop; real-time safe. A sample that is due is queued until it is written. If 64
  /// are queued, the next is skipped.
  void show(Shown shown) noexcept {
    if (!regular_.is_due(mode_ == qos::TimeMode::kRealTime ? runtime::monotonic_ns()
                                                           : shown.stamp_ns))
      return;
    if (mode_ == qos::TimeMode::kRealTime)
      shown.stamp_ns = runtime::realtime_ns();
    due_.push(shown);
  }
  /// The same for contact points: ten times a second, while they have a reader.
  bool requests_points() const noexcept { return markers_.requests_points(); }
  void show_points(const ShownPoints& points) noexcept { markers_.show_points(points); }
  /// Sets another scene. Any thread except the loop's: locks.
  void set_scene(const scene::Scene& scene);

  /// Number of messages written. Outputs without a reader write none.
  std::uint64_t made(RosOutput kind) const noexcept {
    return kind == RosOutput::kMarkers ? markers_.made()
                                       : made_[static_cast<std::size_t>(kind)].load();
  }

 private:
  void run();
  void write_due(bool tenth);
  void follow_scene();
  void write_moving();
  void write_pose();
  void write_wrench();
  void write_tf();
  void write_tf_static();
  void count(RosOutput kind) noexcept { ++made_[static_cast<std::size_t>(kind)]; }

  const std::string rig_;
  const qos::TimeMode mode_;
  std::mutex scene_mutex_;
  std::optional<scene::Scene> next_scene_;
  bus::Writer<msg::tf2_msgs_TFMessage> tf_, tf_static_;
  bus::Writer<msg::rosgraph_msgs_Clock> clock_;  ///< in lockstep only
  bus::Writer<msg::geometry_msgs_PoseStamped> pose_;
  bus::Writer<msg::geometry_msgs_WrenchStamped> wrench_;
  MarkerOutputs markers_;
  runtime::DisplaySampler regular_;  ///< loop only
  runtime::SpscQueue<Shown, 64> due_;
  std::array<std::atomic<std::uint64_t>, 5> made_{};
  std::atomic<bool> stop_{false};
  // Output thread only.
  scene::Scene scene_;
  Shown shown_;
  bool fresh_ = false;  ///< `shown_` is newer than the last markers
  std::thread thread_;
};

}  // namespace voxtouch::rendering_node
