#include "nodes/rendering/ros_outputs.hpp"

#include <utility>

#include "core/types/motion.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

constexpr std::int64_t kPeriodNs = runtime::DisplaySampler::kPeriodNs;
/// At 1 kHz the first sample of a period has arrived by then.
constexpr std::int64_t kBehindNs = 1'500'000;
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
    : rig_(rig),
      mode_(mode),
      tf_(participant, qos::kTf, rig, qos::profile(qos::kTf.profile)),
      tf_static_(participant, qos::kTfStatic, rig, qos::profile(qos::kTfStatic.profile)),
      pose_(participant, qos::kPose, rig, qos::profile(qos::kPose.profile)),
      wrench_(participant, qos::kWrench, rig, qos::profile(qos::kWrench.profile)),
      markers_(participant, rig),
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

void RosOutputs::set_scene(const scene::Scene& scene) {
  const std::lock_guard lock(scene_mutex_);
  next_scene_ = scene;
}

/// Runs at absolute deadlines, shortly after the sample that is due. A late pass writes the waiting
/// samples.
void RosOutputs::run() {
  std::int64_t at_ns = runtime::monotonic_ns() / kPeriodNs * kPeriodNs + kBehindNs;
  std::uint64_t tenth = 0;
  for (std::uint64_t count = 0; !stop_.load(std::memory_order_acquire);) {
    try {
      write_due(count / kMarkersEvery != tenth);
    } catch (const std::exception&) {
      // A failure in the visualisation must not stop the haptic loop: this picture is skipped.
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
  if (tf_static_.matched_count() && made(RosOutput::kTfStatic) == 0)
    write_tf_static();  // DDS keeps it for late readers
  bool fresh = false;
  for (; const Shown* next = due_.front(); due_.pop(), fresh = true)
    shown_ = *next, write_moving();
  fresh_ = fresh_ || fresh;
  if (tenth)
    markers_.write_due(scene_, shown_, std::exchange(fresh_, false));
}

void RosOutputs::write_moving() {
  if (clock_ && clock_.matched_count())
    count(RosOutput::kClock), clock_.write({ros_header(shown_.stamp_ns, kWorldFrame).stamp});
  if (tf_.matched_count())
    write_tf();
  if (pose_.matched_count())
    write_pose();
  if (wrench_.matched_count())
    write_wrench();
}

void RosOutputs::follow_scene() {
  const std::unique_lock lock(scene_mutex_, std::try_to_lock);
  if (!lock || !next_scene_ || !markers_.idle())
    return;
  scene_ = std::move(*std::exchange(next_scene_, std::nullopt));
  markers_.read_again();
}

void RosOutputs::write_pose() {
  count(RosOutput::kPose);
  pose_.write({ros_header(shown_.stamp_ns, kWorldFrame), runtime::to_msg(shown_.object)});
}

void RosOutputs::write_wrench() {
  count(RosOutput::kWrench);
  // ROS displays a wrench in the frame of its header. That frame is T here, so the arrow starts at
  // the tool.
  const Quat back = shown_.object.orientation.conjugate();
  wrench_.write({ros_header(shown_.stamp_ns, rig_ + "/tool"),
                 runtime::to_msg(Wrench{back * shown_.wrench.force, back * shown_.wrench.torque})});
}

void RosOutputs::write_tf() {
  count(RosOutput::kTf);
  const std::string tool = rig_ + "/tool", hand = rig_ + "/hand";
  std::vector<std::string> names;  // owns the texts of the frames
  names.reserve(scene_.objects.size());
  std::vector<msg::geometry_msgs_TransformStamped> all{
      transform(shown_.stamp_ns, tool, shown_.object)};
  if (scene_.virtual_tool())
    all.push_back(transform(shown_.stamp_ns, hand, shown_.hand));
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
  count(RosOutput::kTfStatic);
  const std::int64_t stamp_ns = mode_ == qos::TimeMode::kLockstep ? 0 : runtime::realtime_ns();
  const std::string frame = rig_ + "/device";
  msg::geometry_msgs_TransformStamped device = transform(stamp_ns, frame, scene_.device.pose_WD);
  msg::tf2_msgs_TFMessage m{};
  m.transforms._buffer = &device;
  m.transforms._length = m.transforms._maximum = 1;
  tf_static_.write(m);
}

}  // namespace voxtouch::rendering_node
