#pragma once
/// What RViz and Foxglove draw of a ring: meshes, forces and points, as markers. Makes messages;
/// writes none.
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
/// Length of an arrow for one newton [m], of each force alike.
inline constexpr double kArrowMetresPerNewton = 0.02;

/// Lends `frame`, which outlives it.
msg::std_msgs_Header ros_header(std::int64_t stamp_ns, const std::string& frame);
/// Frame of a moving object: where it is at rest, the frame is W.
std::string object_frame(const std::string& rig, const scene::ObjectSpec& object);

/// A marker that stays until another takes its place. Bound to a frame, it moves along and need not
/// be sent again.
struct LastingMarker {
  std::string name_space;
  std::int32_t id = 0;
  std::string frame;
  msg::std_msgs_ColorRGBA color{};
  std::vector<msg::geometry_msgs_Point> corners;  ///< of triangles, in the frame [m]; empty: a text
  std::string text;
  Vec3 position = Vec3::Zero();  ///< of the text, in the frame [m]
  double text_height_m = 0.0;
};

/// The meshes of a scene, large ones in parts, and a text where one is drawn coarser than it is
/// rendered or cannot be read. Reads files, until `stop`.
std::vector<LastingMarker> scene_markers(const scene::Scene& scene, const std::string& rig,
                                         const std::atomic<bool>& stop);

/// When which of the lasting markers is sent: all of them, one a message, to a reader that has
/// come, once more a second later (DDS does not say when both ends know each other), and then every
/// ten seconds, for a viewer that was cleared.
class MarkerRounds {
 public:
  /// What is there from now on; what is gone is deleted.
  void replace(std::vector<LastingMarker> markers);
  void reader_came() noexcept { next_ = 0, begin_ns_ = 0, soon_again_ = true; }
  bool due(std::int64_t now_ns) const noexcept { return known_ && now_ns >= begin_ns_; }
  /// The next message's; they point into this object.
  std::vector<msg::visualization_msgs_Marker> markers(std::int64_t stamp_ns) const;
  /// They have been written.
  void sent(std::int64_t now_ns) noexcept;

 private:
  std::vector<LastingMarker> markers_;
  std::set<std::pair<std::string, std::int32_t>> gone_;
  bool known_ = false, first_ = true, soon_again_ = true;
  std::size_t next_ = 0;
  std::int64_t begin_ns_ = 0;  ///< of the round [ns, monotonic]; 0 while one is under way
};

/// Forces and points of one moment. What is not there now is deleted; all of it goes by itself
/// where no more come.
struct Moment {
  std::int64_t stamp_ns = 0;
  Vec3 hand, object;  ///< origins of T, in W [m]
  std::optional<Vec3>
      returned;  ///< force of the device, W axes [N]; nothing where no command has come
  Vec3 contact = Vec3::Zero();                   ///< force of the contact alone, W axes [N]
  std::vector<msg::geometry_msgs_Point> points;  ///< in contact, in W [m]
};
/// Arrays that a message of a moment points into.
struct MomentMarkers {
  explicit MomentMarkers(const Moment& moment);
  MomentMarkers(const MomentMarkers&) = delete;
  MomentMarkers& operator=(const MomentMarkers&) = delete;
  msg::geometry_msgs_Point arrows[2][2];
  std::vector<msg::visualization_msgs_Marker> all;
};

}  // namespace voxtouch::rendering_node
