#include "nodes/rendering/ros_markers.hpp"

#include <algorithm>
#include <cmath>

#include "nodes/console/log.hpp"
#include "nodes/mesh_import/display_mesh.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

namespace kind = msg::visualization_msgs_Marker_constants;

const std::string kNothing;
const std::string kReturned = "force_returned", kContact = "force_of_contact",
                  kPoints = "contact_points";
// Colours of Okabe and Ito, as on the page of voxtouch view.
constexpr msg::std_msgs_ColorRGBA kSceneColor{0.62F, 0.68F, 0.74F, 1.0F},
    kObjectColor{0.55F, 0.60F, 0.52F, 1.0F}, kToolColor{0.85F, 0.54F, 0.0F, 1.0F},
    kHandColor{0.49F, 0.54F, 0.59F, 0.35F}, kReturnedColor{0.84F, 0.37F, 0.0F, 1.0F},
    kContactColor{0.0F, 0.45F, 0.70F, 1.0F}, kPointColor{0.0F, 0.0F, 0.0F, 1.0F},
    kTextColor{0.6F, 0.35F, 0.0F, 1.0F};
constexpr std::size_t kTrianglesOfOne = 2000;  ///< 144 kB: capacity of a socket buffer
constexpr double kMinForceN = 1e-3;            ///< an arrow of length zero has no direction
constexpr std::int64_t kSoonNs = 1'000'000'000, kSeldomNs = 10'000'000'000;

msg::visualization_msgs_Marker marker(std::int64_t stamp_ns, const std::string& frame,
                                      const std::string& name_space, std::int32_t id,
                                      std::int32_t type, const msg::std_msgs_ColorRGBA& color) {
  msg::visualization_msgs_Marker m{};
  m.header = ros_header(stamp_ns, frame);
  m.ns = runtime::lend(name_space);
  m.id = id;
  m.type = type;
  m.action = kind::kAdd;
  m.pose.orientation.w = 1.0;
  m.scale = {1.0, 1.0, 1.0};
  m.color = color;
  for (char** text : {&m.texture_resource, &m.text, &m.mesh_resource, &m.mesh_file.filename,
                      &m.texture.header.frame_id, &m.texture.format})
    *text = runtime::lend(kNothing);
  return m;
}

msg::visualization_msgs_Marker deletion(std::int64_t stamp_ns, const std::string& name_space,
                                        std::int32_t id, std::int32_t action) {
  msg::visualization_msgs_Marker m =
      marker(stamp_ns, kWorldFrame, name_space, id, kind::kTriangleList, kSceneColor);
  m.action = action;
  return m;
}

template <class Points>
void lend_points(Points& points, msg::visualization_msgs_Marker& m) {
  m.points._buffer = std::data(points);
  m.points._length = m.points._maximum = static_cast<std::uint32_t>(std::size(points));
}

/// Corners of the triangles from `from` up to, excluding, `to`.
std::vector<msg::geometry_msgs_Point> corners_of(const mesh_import::DisplayMesh& mesh,
                                                 std::size_t from, std::size_t to) {
  std::vector<msg::geometry_msgs_Point> corners;
  corners.reserve(3 * (to - from));
  for (std::size_t n = 3 * from; n < 3 * to; ++n) {
    const float* at = &mesh.positions[3 * std::size_t{mesh.indices[n]}];
    corners.push_back({at[0], at[1], at[2]});
  }
  return corners;
}

/// Collects markers; ids are counted within a name space.
class Gathered {
 public:
  void add(const mesh_import::DisplayMesh& mesh, const std::string& name_space,
           const std::string& frame, const msg::std_msgs_ColorRGBA& color) {
    std::int32_t id =
        static_cast<std::int32_t>(std::ranges::count(all, name_space, &LastingMarker::name_space));
    for (std::size_t n = 0; n < mesh.triangles(); n += kTrianglesOfOne)
      all.push_back({name_space,
                     id++,
                     frame,
                     color,
                     corners_of(mesh, n, std::min(mesh.triangles(), n + kTrianglesOfOne)),
                     {}});
  }
  std::vector<LastingMarker> all;
};

/// Placed above all markers in W, at a tenth of their height.
LastingMarker text_above(const std::vector<LastingMarker>& all, std::string text) {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (const LastingMarker& m : all)
    for (const msg::geometry_msgs_Point& p : m.corners) {
      low = low.cwiseMin(Vec3(p.x, p.y, p.z));
      high = high.cwiseMax(Vec3(p.x, p.y, p.z));
    }
  const double height_m = std::max(0.001, 0.03 * (high - low).norm());
  return {.name_space = "note",
          .id = 0,
          .frame = kWorldFrame,
          .color = kTextColor,
          .corners = {},
          .text = std::move(text),
          .position = {0.5 * (low.x() + high.x()), 0.5 * (low.y() + high.y()),
                       high.z() + 2.0 * height_m},
          .text_height_m = height_m};
}

}  // namespace

msg::std_msgs_Header ros_header(std::int64_t stamp_ns, const std::string& frame) {
  return {{static_cast<std::int32_t>(stamp_ns / 1'000'000'000),
           static_cast<std::uint32_t>(stamp_ns % 1'000'000'000)},
          runtime::lend(frame)};
}

std::string object_frame(const std::string& rig, const scene::ObjectSpec& object) {
  return object.moves ? rig + "/object/" + object.name : kWorldFrame;
}

std::vector<LastingMarker> scene_markers(const scene::Scene& scene, const std::string& rig,
                                         const std::atomic<bool>& stop) {
  const std::vector<mesh_import::DisplayMesh> meshes =
      mesh_import::read_display_meshes(scene, stop);
  Gathered gathered;
  std::string text;
  for (std::size_t n = 0; n < meshes.size(); ++n) {
    if (!meshes[n].note.empty()) {
      console::log("markers: {}\n", meshes[n].note);
      text += (text.empty() ? "" : "\n") + meshes[n].note;
    }
    if (n == scene.static_meshes.size()) {
      gathered.add(meshes[n], "tool", rig + "/tool", kToolColor);
      if (scene.virtual_tool())
        gathered.add(meshes[n], "hand", rig + "/hand", kHandColor);
    } else if (const std::uint32_t object = scene.static_meshes[n].object; object == 0) {
      gathered.add(meshes[n], "scene", kWorldFrame, kSceneColor);
    } else {
      const scene::ObjectSpec& spec = scene.objects[object - 1];
      gathered.add(meshes[n], "object/" + spec.name, object_frame(rig, spec), kObjectColor);
    }
  }
  if (!text.empty())
    gathered.all.push_back(text_above(gathered.all, std::move(text)));
  return std::move(gathered.all);
}

void MarkerRounds::replace(std::vector<LastingMarker> markers) {
  for (const LastingMarker& m : markers_)
    gone_.emplace(m.name_space, m.id);
  markers_ = std::move(markers);
  for (const LastingMarker& m : markers_)
    gone_.erase({m.name_space, m.id});
  known_ = true;
  reader_came();
}

std::vector<msg::visualization_msgs_Marker> MarkerRounds::markers(std::int64_t stamp_ns) const {
  std::vector<msg::visualization_msgs_Marker> out;
  if (next_ == 0) {  // removes markers of an earlier ring or scene
    if (first_)
      out.push_back(deletion(stamp_ns, kNothing, 0, kind::kDeleteall));
    for (const auto& [name_space, id] : gone_)
      out.push_back(deletion(stamp_ns, name_space, id, kind::kDelete));
  }
  if (next_ >= markers_.size())
    return out;
  const LastingMarker& lasting = markers_[next_];
  const bool is_text = lasting.corners.empty();
  msg::visualization_msgs_Marker m =
      marker(stamp_ns, lasting.frame, lasting.name_space, lasting.id,
             is_text ? kind::kTextViewFacing : kind::kTriangleList, lasting.color);
  m.frame_locked = true;
  if (is_text) {
    m.text = runtime::lend(lasting.text);
    m.pose.position = runtime::to_point(lasting.position);
    m.scale.z = lasting.text_height_m;
  } else {
    // DDS only reads them.
    m.points._buffer = const_cast<msg::geometry_msgs_Point*>(lasting.corners.data());
    m.points._length = m.points._maximum = static_cast<std::uint32_t>(lasting.corners.size());
  }
  out.push_back(m);
  return out;
}

void MarkerRounds::sent(std::int64_t now_ns) noexcept {
  first_ = false;
  if (++next_ < markers_.size())
    return;
  next_ = 0;
  begin_ns_ = now_ns + (soon_again_ ? kSoonNs : kSeldomNs);
  soon_again_ = false;
}

MomentMarkers::MomentMarkers(const Moment& moment) {
  const auto add = [&](const std::string& name_space, std::int32_t type,
                       const msg::std_msgs_ColorRGBA& color, auto& points, bool is_there) {
    all.push_back(marker(moment.stamp_ns, kWorldFrame, name_space, 0, type, color));
    all.back().lifetime.sec = 1;
    all.back().action = is_there ? kind::kAdd : kind::kDelete;
    if (is_there)
      lend_points(points, all.back());
  };
  const auto arrow = [&](const std::string& name_space, const msg::std_msgs_ColorRGBA& color,
                         auto& ends, const Vec3& from, const Vec3& force) {
    ends[0] = runtime::to_point(from),
    ends[1] = runtime::to_point(from + kArrowMetresPerNewton * force);
    const double size_n = force.norm();  // any participant may have sent the command
    add(name_space, kind::kArrow, color, ends, size_n >= kMinForceN && std::isfinite(size_n));
    all.back().scale = {0.002, 0.004, 0.0};  // shaft and head [m]
  };
  arrow(kReturned, kReturnedColor, arrows[0], moment.hand, moment.returned.value_or(Vec3::Zero()));
  arrow(kContact, kContactColor, arrows[1], moment.object, moment.contact);
  // DDS only reads the points; their owner outlives the message.
  auto& points = const_cast<std::vector<msg::geometry_msgs_Point>&>(moment.points);
  add(kPoints, kind::kSphereList, kPointColor, points, !points.empty());
  all.back().scale = {0.001, 0.001, 0.001};
}

}  // namespace voxtouch::rendering_node
