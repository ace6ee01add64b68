#include "nodes/rendering/ros_outputs.hpp"

#include <sys/resource.h>

#include <utility>

#include "core/types/motion.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

constexpr std::int64_t kPeriodNs = runtime::HundredASecond::kPeriodNs;
constexpr std::int64_t kBehindNs =
    1'500'000;  ///< a period's first sample is there by then, at 1 kHz
constexpr std::uint64_t kMarkersEvery = 10;

msg::geometry_msgs_TransformStamped transform(std::int64_t stamp_ns, const std::string& child,
                                              const Pose& pose) {
  const auto p = runtime::to_msg(pose);
  return {ros_header(stamp_ns, kWorldFrame),
          runtime::lend(child),
          {runtime::to_vector(pose.position), p.orientation}};
}

}  // namespace

RosOutputs::RosOutputs(const bus::Participant& participant, const std::string& rig,
                       const scene::Scene& scene, qos::TimeMode mode)
    : participant_(participant),
      rig_(rig),
      device_frame_(rig + "/device"),
      tool_frame_(rig + "/tool"),
      hand_frame_(rig + "/hand"),
      mode_(mode),
      tf_(participant, qos::kTf, rig, qos::profile(qos::kTf.profile)),
      tf_static_(participant, qos::kTfStatic, rig, qos::profile(qos::kTfStatic.profile)),
      pose_(participant, qos::kPose, rig, qos::profile(qos::kPose.profile)),
      wrench_(participant, qos::kWrench, rig, qos::profile(qos::kWrench.profile)),
      markers_(participant, qos::kMarkers, rig, qos::profile(qos::kMarkers.profile)),
      scene_(scene) {
  if (mode == qos::TimeMode::kLockstep)
    clock_ = {participant, qos::kClock, rig, qos::profile(qos::kClock.profile)};
  thread_ = std::thread([this] {
    runtime::ordinary_priority();
    run();
  });
}

RosOutputs::~RosOutputs() {
  stop_.store(true, std::memory_order_release);
  thread_.join();
}

void RosOutputs::scene_is(const scene::Scene& scene) {
  const std::lock_guard lock(scene_mutex_);
  next_scene_ = scene;
}

/// At absolute deadlines, just behind the sample that is due. A pass that comes too late writes
/// what has waited.
void RosOutputs::run() {
  std::int64_t at_ns = runtime::monotonic_ns() / kPeriodNs * kPeriodNs + kBehindNs;
  std::uint64_t tenth = 0;
  for (std::uint64_t count = 0; !stop_.load(std::memory_order_acquire);) {
    try {
      write_due(count / kMarkersEvery != tenth);
    } catch (const std::exception&) {
      // What people look at must not end what they feel: this picture is left out.
    }
    tenth = count / kMarkersEvery;
    const runtime::Deadline next =
        runtime::next_deadline(at_ns, runtime::monotonic_ns(), kPeriodNs);
    at_ns = next.at_ns;
    count += 1 + next.skipped;
    runtime::sleep_until(at_ns);
  }
}

void RosOutputs::write_due(bool tenth) {
  follow_scene();
  if (tf_static_.matched_count() && made_tf_static_ == 0)
    write_tf_static();  // DDS keeps it for who comes later
  bool fresh = false;
  for (; const Shown* next = due_.front(); due_.pop(), fresh = true)
    shown_ = *next, write_moving();
  fresh_ = fresh_ || fresh;
  if (tenth)
    look_after_markers(std::exchange(fresh_, false));
}

void RosOutputs::write_moving() {
  if (clock_ && clock_.matched_count())
    ++made_clock_, clock_.write({ros_header(shown_.stamp_ns, kWorldFrame).stamp});
  if (tf_.matched_count())
    write_tf();
  if (pose_.matched_count())
    write_pose();
  if (wrench_.matched_count())
    write_wrench();
}

void RosOutputs::follow_scene() {
  const std::unique_lock lock(scene_mutex_, std::try_to_lock);
  if (!lock || !next_scene_ || reading_.valid())
    return;
  scene_ = std::move(*std::exchange(next_scene_, std::nullopt));
  is_read_ = false;
}

void RosOutputs::write_pose() {
  ++made_pose_;
  pose_.write({ros_header(shown_.stamp_ns, kWorldFrame), runtime::to_msg(shown_.object)});
}

void RosOutputs::write_wrench() {
  ++made_wrench_;
  // ROS shows a wrench in the frame that its header names: T here, so the arrow starts at the tool.
  const Quat back = shown_.object.orientation.conjugate();
  wrench_.write({ros_header(shown_.stamp_ns, tool_frame_),
                 runtime::to_msg(Wrench{back * shown_.wrench.force, back * shown_.wrench.torque})});
}

void RosOutputs::write_tf() {
  ++made_tf_;
  std::vector<std::string> names;  // keeps the text of the frames
  names.reserve(scene_.objects.size());
  std::vector<msg::geometry_msgs_TransformStamped> all{
      transform(shown_.stamp_ns, tool_frame_, shown_.object)};
  if (scene_.virtual_tool())
    all.push_back(transform(shown_.stamp_ns, hand_frame_, shown_.hand));
  for (const scene::ObjectSpec& object : scene_.objects) {
    if (!object.moves)
      continue;
    names.push_back(object_frame(rig_, object));
    all.push_back(
        transform(shown_.stamp_ns, names.back(),
                  {motion_at(*object.moves, shown_.scene_time_s).position, Quat::Identity()}));
  }
  msg::tf2_msgs_TFMessage m{};
  m.transforms._buffer = all.data();
  m.transforms._length = m.transforms._maximum = static_cast<std::uint32_t>(all.size());
  tf_.write(m);
}

void RosOutputs::write_tf_static() {
  ++made_tf_static_;
  const std::int64_t stamp_ns = mode_ == qos::TimeMode::kLockstep ? 0 : runtime::realtime_ns();
  msg::geometry_msgs_TransformStamped device =
      transform(stamp_ns, device_frame_, scene_.device.pose_WD);
  msg::tf2_msgs_TFMessage m{};
  m.transforms._buffer = &device;
  m.transforms._length = m.transforms._maximum = 1;
  tf_static_.write(m);
}

/// Nothing of it is there before somebody has come to see it: neither meshes nor the reader of
/// commands.
void RosOutputs::look_after_markers(bool fresh) {
  if (markers_.matched_count() == 0)
    return commands_.reset(), returned_.reset();
  if (!is_read_) {
    is_read_ = true;
    reading_ = std::async(std::launch::async, [this, scene = scene_] {
      setpriority(PRIO_PROCESS, 0,
                  19);  // this thread alone: whoever feels comes before those who look
      return scene_markers(scene, rig_, stop_);
    });
  }
  if (reading_.valid() && reading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    rounds_.replace(reading_.get());
  if (const std::uint32_t readers = markers_.ever_matched();
      readers != std::exchange(readers_so_far_, readers))
    rounds_.reader_came();
  if (const std::int64_t now_ns = runtime::monotonic_ns(); rounds_.due(now_ns)) {
    auto lasting = rounds_.markers(shown_.stamp_ns);
    if (write_markers(lasting))
      rounds_.sent(now_ns);
  }
  if (!fresh)
    return;
  read_commands();
  ShownPoints points;
  latest_points_.take(points);
  wants_points_.store(true, std::memory_order_relaxed);
  Moment moment{.stamp_ns = shown_.stamp_ns,
                .hand = shown_.hand.position,
                .object = shown_.object.position,
                .returned = returned_,
                .contact = shown_.contact_force,
                .points = {}};
  for (std::size_t n = 0; n < points.count; ++n)
    moment.points.push_back(runtime::to_point(points.at[n]));
  MomentMarkers markers(moment);
  write_markers(markers.all);
}

/// The newest command of the session since the last look, turned from the device's axes into the
/// world's; its size is what the device gives.
void RosOutputs::read_commands() {
  if (!commands_)
    commands_.emplace(participant_, qos::kForceCommand, rig_, qos::profile(qos::ProfileId::kTap));
  returned_.reset();
  commands_->take_each([this](const msg::ForceCommand& command) {
    if (command.session_id == shown_.session)
      returned_ = scene_.device.pose_WD.orientation * runtime::from_msg(command.wrench.force);
  });
}

bool RosOutputs::write_markers(std::vector<msg::visualization_msgs_Marker>& all) {
  ++made_markers_;
  msg::visualization_msgs_MarkerArray m{};
  m.markers._buffer = all.data();
  m.markers._length = m.markers._maximum = static_cast<std::uint32_t>(all.size());
  return markers_.write(m);
}

}  // namespace voxtouch::rendering_node
