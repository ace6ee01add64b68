#pragma once
/// What RViz, rqt and rosbag users look at: /tf, pose, wrench, markers. Written only while somebody reads them.
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "core/scene/scene.hpp"
#include "core/types/latest_value.hpp"
#include "nodes/bus/writer.hpp"

namespace voxtouch::rendering_node {

/// One frame of the ring, as the outputs show it.
struct Shown {
  std::int64_t time_ns = 0;
  Pose tool;      ///< T in W
  Wrench wrench;  ///< W axes
  Vec3 deepest_point = Vec3::Zero();
  bool contact = false;
};

/// Messages made so far: none of a kind that nobody reads.
struct RosOutputCounts {
  std::uint64_t tf = 0, pose = 0, wrench = 0, markers = 0;
};

/// Frames: `world` = W, `<rig>/device` = D, `<rig>/tool` = T.
class RosOutputs {
 public:
  RosOutputs(const bus::Participant& participant, const std::string& rig, const scene::Scene& scene);
  ~RosOutputs();
  RosOutputs(const RosOutputs&) = delete;
  RosOutputs& operator=(const RosOutputs&) = delete;

  /// From the loop; real-time safe.
  void show(const Shown& shown) noexcept { latest_.put(shown); }
  /// Other meshes from now on. From any thread but the loop's: locks.
  void set_static_meshes(std::vector<scene::MeshSpec> meshes);

  RosOutputCounts made() const noexcept {
    return {.tf = made_tf_.load(), .pose = made_pose_.load(), .wrench = made_wrench_.load(), .markers = made_markers_.load()};
  }

 private:
  void turn(std::uint64_t count);
  void write_pose(const Shown& shown);
  void write_wrench(const Shown& shown);
  void write_tf(const Shown& shown);
  void write_markers(const Shown& shown);

  std::string device_frame_, tool_frame_;
  Pose device_in_world_;
  std::mutex meshes_mutex_;
  std::vector<scene::MeshSpec> static_meshes_;
  bus::Writer<msg::tf2_msgs_TFMessage> tf_;
  bus::Writer<msg::geometry_msgs_PoseStamped> pose_;
  bus::Writer<msg::geometry_msgs_WrenchStamped> wrench_;
  bus::Writer<msg::visualization_msgs_MarkerArray> markers_;
  LatestValue<Shown> latest_;
  std::atomic<std::uint64_t> made_tf_{0}, made_pose_{0}, made_wrench_{0}, made_markers_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace voxtouch::rendering_node
