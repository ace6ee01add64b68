#pragma once
/// Builds RViz and Foxglove markers of a ring: meshes, forces and points. It writes no messages.
#include <atomic>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/scene.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::rendering_node {

inline const std::string kWorldFrame = "world";
/// Length of an arrow for one newton [m], equal for all forces.
inline constexpr double kArrowMetresPerNewton = 0.02;

/// The header refers to `frame`, which must outlive it.
msg::std_msgs_Header ros_header(std::int64_t stamp_ns, const std::string& frame);
/// Frame of a moving object. At rest it coincides with W.
std::string object_frame(const std::string& rig, const scene::ObjectSpec& object);

/// A marker that stays until it is replaced. It is bound to a frame and moves with it, so it is
/// sent once.
struct LastingMarker {
  std::string name_space;
  std::int32_t id = 0;
  std::string frame;
  msg::std_msgs_ColorRGBA color{};
  /// Of triangles, in the frame [m]; empty for a text.
  std::vector<msg::geometry_msgs_Point> corners;
  std::string text;
  Vec3 position = Vec3::Zero();  ///< of the text, in the frame [m]
  double text_height_m = 0.0;
};

/// The meshes of a scene, large ones in parts. Adds a text if a mesh is drawn coarser than it is
/// rendered or cannot be read. Reads files until `stop`.
std::vector<LastingMarker> scene_markers(const scene::Scene& scene, const std::string& rig,
                                         const std::atomic<bool>& stop);

/// Schedules the lasting markers, one per message.
/// All are sent when a reader appears. They are sent again a second later, because DDS does not
/// report when both ends have discovered each other. After that they are sent every ten seconds,
/// for a viewer that was cleared.
class MarkerRounds {
 public:
  /// Sets the current markers; markers that are missing from the list are deleted.
  void replace(std::vector<LastingMarker> markers);
  void reader_came() noexcept { next_ = 0, begin_ns_ = 0, soon_again_ = true; }
  bool due(std::int64_t now_ns) const noexcept { return known_ && now_ns >= begin_ns_; }
  /// Markers of the next message. They refer to this object.
  std::vector<msg::visualization_msgs_Marker> markers(std::int64_t stamp_ns) const;
  /// Called after the markers have been written.
  void sent(std::int64_t now_ns) noexcept;

 private:
  std::vector<LastingMarker> markers_;
  std::set<std::pair<std::string, std::int32_t>> gone_;
  bool known_ = false, first_ = true, soon_again_ = true;
  std::size_t next_ = 0;
  std::int64_t begin_ns_ = 0;  ///< of the round [ns, monotonic]; 0 while a round is in progress
};

/// Forces and points of one moment. Missing markers are deleted; all markers expire if no more are
/// sent.
struct Moment {
  std::int64_t stamp_ns = 0;
  Vec3 hand, object;             ///< origins of T, in W [m]
  std::optional<Vec3> returned;  ///< force of the device, W axes [N]; empty if no command has come
  Vec3 contact = Vec3::Zero();   ///< contact force only, W axes [N]
  std::vector<msg::geometry_msgs_Point> points;  ///< in contact, in W [m]
};
/// Arrays that the message of a moment refers to.
struct MomentMarkers {
  explicit MomentMarkers(const Moment& moment);
  MomentMarkers(const MomentMarkers&) = delete;
  MomentMarkers& operator=(const MomentMarkers&) = delete;
  msg::geometry_msgs_Point arrows[2][2];
  std::vector<msg::visualization_msgs_Marker> all;
};

}  // namespace voxtouch::rendering_node
