#include "nodes/device/joint_outputs.hpp"

#include <algorithm>

#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/realtime.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::device_node {

JointOutputs::JointOutputs(const bus::Participant& participant, const std::string& rig,
                           const arm::ArmDescription& arm, qos::TimeMode mode)
    : urdf_(arm::to_urdf(arm)),
      mode_(mode),
      states_(participant, qos::kJointStates, rig, qos::profile(qos::kJointStates.profile)),
      description_(participant, qos::kRobotDescription, rig,
                   qos::profile(qos::kRobotDescription.profile)) {
  for (const arm::ArmJoint& joint : arm.joints)
    names_.emplace_back(joint.name);
  thread_ = std::thread([this] {
    runtime::ordinary_priority();
    run();
  });
}

JointOutputs::~JointOutputs() {
  stop_.store(true, std::memory_order_release);
  thread_.join();
}

void JointOutputs::show(std::span<const double> joints, std::int64_t sample_ns) noexcept {
  if (!regular_.is_due(mode_ == qos::TimeMode::kRealTime ? runtime::monotonic_ns() : sample_ns))
    return;
  Moment moment{.stamp_ns = mode_ == qos::TimeMode::kRealTime ? runtime::realtime_ns() : sample_ns};
  moment.count = static_cast<std::uint32_t>(std::min(joints.size(), kMaxJoints));
  std::copy_n(joints.begin(), moment.count, moment.at.begin());
  due_.push(moment);
}

void JointOutputs::run() {
  constexpr std::int64_t kPeriodNs = runtime::DisplaySampler::kPeriodNs, kBehindNs = 1'500'000;
  std::int64_t at_ns = runtime::monotonic_ns() / kPeriodNs * kPeriodNs + kBehindNs;
  for (bool is_described = false; !stop_.load(std::memory_order_acquire);) {
    if (!is_described && description_.matched_count() > 0) {  // DDS keeps it for late readers
      is_described = description_.write({runtime::lend(urdf_)});
    }
    for (; const Moment* next = due_.front(); due_.pop())
      if (states_.matched_count() > 0)
        write(*next);
    at_ns = runtime::next_deadline(at_ns, runtime::monotonic_ns(), kPeriodNs).at_ns;
    runtime::sleep_until(at_ns);
  }
}

void JointOutputs::write(const Moment& moment) {
  static char none[] = "";
  runtime::StringViews names(names_);
  msg::sensor_msgs_JointState state{};
  state.header = {runtime::to_time(moment.stamp_ns), none};
  names.into(state.name);
  state.position._buffer = const_cast<double*>(moment.at.data());
  state.position._length = state.position._maximum = moment.count;
  states_.write(state);
}

}  // namespace voxtouch::device_node
