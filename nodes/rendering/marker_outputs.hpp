#pragma once
/// Publishes scene, tool and force markers for RViz and Foxglove while they have a reader.
#include <array>
#include <atomic>
#include <cstdint>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "core/types/latest_value.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/rendering/ros_markers.hpp"

namespace voxtouch::rendering_node {

/// One frame of the ring for the ROS outputs.
struct Shown {
  /// Of the sample, by the device's clock. `show` converts it to wall time, except in lockstep.
  std::int64_t stamp_ns = 0;
  std::uint64_t session = 0;
  double scene_time_s = 0.0;  ///< time of the moving objects
  /// T in W: `hand` as requested by the operator, `object` at which contact was computed. They
  /// differ with a virtual tool or a rigid body.
  Pose hand, object;
  Wrench wrench;                      ///< as sent to the coupling, W axes
  Vec3 contact_force = Vec3::Zero();  ///< contact force only, W axes
};

/// Points in contact, thinned out if there are many.
struct ShownPoints {
  static constexpr std::size_t kMaxPoints = 64;
  std::array<Vec3, kMaxPoints> at;  ///< in W [m]
  std::size_t count = 0;
};

/// Used by one thread of ordinary priority. Only the points come from the loop.
class MarkerOutputs {
 public:
  MarkerOutputs(const bus::Participant& participant, const std::string& rig);
  ~MarkerOutputs() { stop_.store(true); }
  MarkerOutputs(const MarkerOutputs&) = delete;
  MarkerOutputs& operator=(const MarkerOutputs&) = delete;

  // Called by the loop, ten times a second while points are drawn. Real-time safe.
  bool requests_points() const noexcept { return requests_points_.load(std::memory_order_relaxed); }
  void show_points(const ShownPoints& points) noexcept {
    requests_points_.store(false, std::memory_order_relaxed);
    latest_points_.put(points);
  }

  /// Writes what is due. `fresh`: `shown` has changed since the last call.
  void write_due(const scene::Scene& scene, const Shown& shown, bool fresh);
  /// Whether no mesh is being read, so that another scene may follow.
  bool idle() const noexcept { return !reading_.valid(); }
  void read_again() noexcept { is_read_ = false; }
  /// Number of messages; any thread.
  std::uint64_t made() const noexcept { return made_.load(); }

 private:
  void read_commands(const scene::Scene& scene, std::uint64_t session);
  bool write(std::vector<msg::visualization_msgs_Marker>& all);

  const bus::Participant& participant_;
  const std::string rig_;
  bus::Writer<msg::visualization_msgs_MarkerArray> markers_;
  std::optional<bus::Reader<msg::ForceCommand>> commands_;  ///< exists while forces are drawn
  std::optional<Vec3> returned_;
  MarkerRounds rounds_;
  LatestValue<ShownPoints> latest_points_;
  std::atomic<bool> requests_points_{false}, stop_{false};
  std::atomic<std::uint64_t> made_{0};
  bool is_read_ = false;  ///< the meshes of the scene have been read or are being read
  std::uint32_t readers_so_far_ = 0;
  std::future<std::vector<LastingMarker>> reading_;
};

}  // namespace voxtouch::rendering_node
