#pragma once
/// What RViz, Foxglove, rqt and rosbag users look at: frames, pose, wrench, markers, and in
/// lockstep the clock. Written only while somebody reads them, by reliable writers that keep the
/// last ten messages and wait for nobody.
#include <array>
#include <atomic>
#include <cstdint>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/types/latest_value.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/rendering/ros_markers.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/hundred_a_second.hpp"
#include "nodes/runtime/spsc_queue.hpp"

namespace voxtouch::rendering_node {

/// One frame of the ring, as the outputs show it.
struct Shown {
  std::int64_t stamp_ns = 0;  ///< of the sample, by the device's clock; `show` makes wall time of
                              ///< it, except in lockstep
  std::uint64_t session = 0;
  double scene_time_s = 0.0;  ///< where moving objects are
  Pose hand, object;  ///< T in W, where the hand is and where its contact was found; they differ
                      ///< where there is a virtual tool or a body
  Wrench wrench;      ///< as the coupling is told, W axes
  Vec3 contact_force = Vec3::Zero();  ///< of the contact alone, W axes
};

/// Points in contact, some of them where there are many.
struct ShownPoints {
  static constexpr std::size_t kMaxPoints = 64;
  std::array<Vec3, kMaxPoints> at;  ///< in W [m]
  std::size_t count = 0;
};

/// Messages made so far: none of a kind that nobody reads.
struct RosOutputCounts {
  std::uint64_t tf = 0, tf_static = 0, clock = 0, pose = 0, wrench = 0, markers = 0;
};

/// Frames: `world` = W, `<rig>/device` = D (does not move), `<rig>/tool` = T where its contact was
/// found, `<rig>/hand` = T where the hand is (with a virtual tool), `<rig>/object/<name>` of each
/// object that moves.
class RosOutputs {
 public:
  RosOutputs(const bus::Participant& participant, const std::string& rig, const scene::Scene& scene,
             qos::TimeMode mode);
  ~RosOutputs();
  RosOutputs(const RosOutputs&) = delete;
  RosOutputs& operator=(const RosOutputs&) = delete;

  /// From the loop; real-time safe. A sample that is due waits here until it is written, however
  /// late that is; where 64 wait, the next is left out.
  void show(Shown shown) noexcept {
    if (!regular_.is_due(runtime::monotonic_ns()))
      return;
    if (mode_ == qos::TimeMode::kRealTime)
      shown.stamp_ns = runtime::realtime_ns();
    due_.push(shown);
  }
  /// The same: ten times a second, while somebody draws them.
  bool wants_points() const noexcept { return wants_points_.load(std::memory_order_relaxed); }
  void show_points(const ShownPoints& points) noexcept {
    wants_points_.store(false, std::memory_order_relaxed);
    latest_points_.put(points);
  }
  /// Another scene from now on. From any thread but the loop's: locks.
  void scene_is(const scene::Scene& scene);

  RosOutputCounts made() const noexcept {
    return {.tf = made_tf_,
            .tf_static = made_tf_static_,
            .clock = made_clock_,
            .pose = made_pose_,
            .wrench = made_wrench_,
            .markers = made_markers_};
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
  void look_after_markers(bool fresh);
  void read_commands();
  bool write_markers(std::vector<msg::visualization_msgs_Marker>& all);

  const bus::Participant& participant_;
  const std::string rig_, device_frame_, tool_frame_, hand_frame_;
  const qos::TimeMode mode_;
  std::mutex scene_mutex_;
  std::optional<scene::Scene> next_scene_;
  bus::Writer<msg::tf2_msgs_TFMessage> tf_, tf_static_;
  bus::Writer<msg::rosgraph_msgs_Clock> clock_;  ///< in lockstep only
  bus::Writer<msg::geometry_msgs_PoseStamped> pose_;
  bus::Writer<msg::geometry_msgs_WrenchStamped> wrench_;
  bus::Writer<msg::visualization_msgs_MarkerArray> markers_;
  runtime::HundredASecond regular_;  ///< of the loop alone
  runtime::SpscQueue<Shown, 64> due_;
  LatestValue<ShownPoints> latest_points_;
  std::atomic<bool> wants_points_{false};
  std::atomic<std::uint64_t> made_tf_{0}, made_tf_static_{0}, made_clock_{0}, made_pose_{0},
      made_wrench_{0}, made_markers_{0};
  std::atomic<bool> stop_{false};
  // Of the thread alone.
  scene::Scene scene_;
  Shown shown_;
  bool fresh_ = false;  ///< `shown_` is newer than the last markers
  std::optional<bus::Reader<msg::ForceCommand>> commands_;  ///< while somebody draws forces
  std::optional<Vec3> returned_;
  MarkerRounds rounds_;
  std::future<std::vector<LastingMarker>> reading_;
  bool is_read_ = false;  ///< the scene's meshes, or they are being read
  std::uint32_t readers_so_far_ = 0;
  std::thread thread_;
};

}  // namespace voxtouch::rendering_node
