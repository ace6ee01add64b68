#include "nodes/rendering/ros_outputs.hpp"

#include <chrono>

#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

const std::string kWorld = "world";
constexpr double kMetresPerNewton = 0.02;  // length of the force arrow

msg::std_msgs_Header header(std::int64_t time_ns, const std::string& frame) {
  return {{static_cast<std::int32_t>(time_ns / 1'000'000'000), static_cast<std::uint32_t>(time_ns % 1'000'000'000)},
          runtime::lend(frame)};
}

msg::geometry_msgs_TransformStamped transform(std::int64_t time_ns, const std::string& child, const Pose& pose) {
  const auto p = runtime::to_msg(pose);
  return {header(time_ns, kWorld), runtime::lend(child), {runtime::to_vector(pose.position), p.orientation}};
}

/// A marker with what every marker needs; `empty` outlives the write.
msg::visualization_msgs_Marker marker(std::int64_t time_ns, const std::string& name_space, std::int32_t id,
                                      std::int32_t type, const std::string& empty) {
  msg::visualization_msgs_Marker m{};
  m.header = header(time_ns, kWorld);
  m.ns = runtime::lend(name_space);
  m.id = id;
  m.type = type;
  m.pose.orientation.w = 1.0;
  m.scale = {1.0, 1.0, 1.0};
  m.color = {0.6F, 0.6F, 0.6F, 1.0F};
  for (char** text : {&m.texture_resource, &m.text, &m.mesh_resource, &m.mesh_file.filename, &m.texture.header.frame_id,
                      &m.texture.format})
    *text = runtime::lend(empty);
  return m;
}

}  // namespace

RosOutputs::RosOutputs(const bus::Participant& participant, const std::string& rig, const scene::Scene& scene)
    : device_frame_(rig + "/device"), tool_frame_(rig + "/tool"), device_in_world_(scene.device.pose_WD),
      static_meshes_(scene.static_meshes), tf_(participant, qos::kTf, rig, qos::profile(qos::kTf.profile)),
      pose_(participant, qos::kPose, rig, qos::profile(qos::kPose.profile)),
      wrench_(participant, qos::kWrench, rig, qos::profile(qos::kWrench.profile)),
      markers_(participant, qos::kMarkers, rig, qos::profile(qos::kMarkers.profile)), thread_([this] {
        runtime::ordinary_priority();
        for (std::uint64_t count = 0; !stop_.load(std::memory_order_acquire); ++count) {
          try {
            turn(count);
          } catch (const std::exception&) {
            // What people look at must not end what they feel: this picture is left out.
          }
          std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
      }) {}

RosOutputs::~RosOutputs() {
  stop_.store(true, std::memory_order_release);
  thread_.join();
}

void RosOutputs::set_static_meshes(std::vector<scene::MeshSpec> meshes) {
  const std::lock_guard lock(meshes_mutex_);
  static_meshes_ = std::move(meshes);
}

void RosOutputs::turn(std::uint64_t count) {
  Shown shown;
  if (!latest_.take(shown)) return;
  if (pose_.matched_count()) write_pose(shown);
  if (wrench_.matched_count()) write_wrench(shown);
  if (tf_.matched_count()) write_tf(shown);
  if (count % 10 == 0 && markers_.matched_count()) write_markers(shown);
}

void RosOutputs::write_pose(const Shown& shown) {
  ++made_pose_;
  pose_.write({header(shown.time_ns, kWorld), runtime::to_msg(shown.tool)});
}

void RosOutputs::write_wrench(const Shown& shown) {
  ++made_wrench_;
  // ROS shows a wrench in the frame that its header names: T here, so the arrow starts at the tool.
  const Quat back = shown.tool.orientation.conjugate();
  wrench_.write({header(shown.time_ns, tool_frame_),
                 runtime::to_msg(Wrench{back * shown.wrench.force, back * shown.wrench.torque})});
}

void RosOutputs::write_tf(const Shown& shown) {
  ++made_tf_;
  msg::geometry_msgs_TransformStamped both[] = {transform(shown.time_ns, device_frame_, device_in_world_),
                                                transform(shown.time_ns, tool_frame_, shown.tool)};
  msg::tf2_msgs_TFMessage m{};
  m.transforms._buffer = both;
  m.transforms._length = m.transforms._maximum = 2;
  tf_.write(m);
}

void RosOutputs::write_markers(const Shown& shown) {
  ++made_markers_;
  static const std::string empty, force = "force", point = "contact_point", meshes = "static";
  namespace kind = msg::visualization_msgs_Marker_constants;
  std::vector<msg::visualization_msgs_Marker> all;
  msg::geometry_msgs_Point arrow[] = {runtime::to_point(shown.tool.position),
                                      runtime::to_point(shown.tool.position + kMetresPerNewton * shown.wrench.force)};
  all.push_back(marker(shown.time_ns, force, 0, kind::kArrow, empty));
  all.back().points._buffer = arrow;
  all.back().points._length = all.back().points._maximum = 2;
  all.back().scale = {0.002, 0.004, 0.0};
  all.back().color = {0.9F, 0.2F, 0.1F, 1.0F};
  all.push_back(marker(shown.time_ns, point, 0, kind::kSphere, empty));
  all.back().pose.position = runtime::to_point(shown.deepest_point);
  all.back().scale = {0.004, 0.004, 0.004};
  all.back().color = {0.9F, 0.7F, 0.1F, shown.contact ? 1.0F : 0.0F};
  const std::vector<scene::MeshSpec> shown_meshes = [this] {
    const std::lock_guard lock(meshes_mutex_);
    return static_meshes_;
  }();
  std::vector<std::string> resources;
  resources.reserve(shown_meshes.size());
  for (const scene::MeshSpec& mesh : shown_meshes) {
    resources.push_back("file://" + mesh.path.string());
    all.push_back(
        marker(shown.time_ns, meshes, static_cast<std::int32_t>(resources.size()), kind::kMeshResource, empty));
    all.back().mesh_resource = runtime::lend(resources.back());
    all.back().pose = runtime::to_msg(mesh.pose);
    all.back().scale = {mesh.scale, mesh.scale, mesh.scale};
  }
  msg::visualization_msgs_MarkerArray m{};
  m.markers._buffer = all.data();
  m.markers._length = m.markers._maximum = static_cast<std::uint32_t>(all.size());
  markers_.write(m);
}

}  // namespace voxtouch::rendering_node
