#include "nodes/rendering/marker_outputs.hpp"

#include <sys/resource.h>

#include <utility>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"

namespace voxtouch::rendering_node {

MarkerOutputs::MarkerOutputs(const bus::Participant& participant, const std::string& rig)
    : participant_(participant),
      rig_(rig),
      markers_(participant, qos::kMarkers, rig, qos::profile(qos::kMarkers.profile)) {}

/// Without a reader, neither meshes nor the command reader exist.
void MarkerOutputs::write_due(const scene::Scene& scene, const Shown& shown, bool fresh) {
  if (markers_.matched_count() == 0)
    return commands_.reset(), returned_.reset();
  if (!is_read_) {
    is_read_ = true;
    reading_ = std::async(std::launch::async, [this, scene] {
      setpriority(PRIO_PROCESS, 0, 19);  // this thread only
      return scene_markers(scene, rig_, stop_);
    });
  }
  if (reading_.valid() && reading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    rounds_.replace(reading_.get());
  if (const std::uint32_t readers = markers_.ever_matched();
      readers != std::exchange(readers_so_far_, readers))
    rounds_.reader_came();
  if (const std::int64_t now_ns = runtime::monotonic_ns(); rounds_.due(now_ns)) {
    auto lasting = rounds_.markers(shown.stamp_ns);
    if (write(lasting))
      rounds_.sent(now_ns);
  }
  if (!fresh)
    return;
  read_commands(scene, shown.session);
  ShownPoints points;
  latest_points_.take(points);
  requests_points_.store(true, std::memory_order_relaxed);
  Moment moment{.stamp_ns = shown.stamp_ns,
                .hand = shown.hand.position,
                .object = shown.object.position,
                .returned = returned_,
                .contact = shown.contact_force,
                .points = {}};
  for (std::size_t n = 0; n < points.count; ++n)
    moment.points.push_back(runtime::to_point(points.at[n]));
  MomentMarkers markers(moment);
  write(markers.all);
}

/// The newest command of the session since the last poll, in W axes.
void MarkerOutputs::read_commands(const scene::Scene& scene, std::uint64_t session) {
  if (!commands_)
    commands_.emplace(participant_, qos::kForceCommand, rig_, qos::profile(qos::ProfileId::kTap));
  returned_.reset();
  commands_->take_each([&](const msg::ForceCommand& command) {
    if (command.session_id == session)
      returned_ = scene.device.pose_WD.orientation * runtime::from_msg(command.wrench.force);
  });
}

bool MarkerOutputs::write(std::vector<msg::visualization_msgs_Marker>& all) {
  ++made_;
  msg::visualization_msgs_MarkerArray m{};
  m.markers._buffer = all.data();
  m.markers._length = m.markers._maximum = static_cast<std::uint32_t>(all.size());
  return markers_.write(m);
}

}  // namespace voxtouch::rendering_node
