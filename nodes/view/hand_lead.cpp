#include "nodes/view/hand_lead.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/types/motion.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/view/rounded.hpp"

namespace voxtouch::view {

using nlohmann::json;

HandLead::HandLead(const bus::Participant& participant, const runtime::NodeOptions& options)
    : targets_(participant, qos::kOperatorTarget, options.rig,
               qos::profile(qos::kOperatorTarget.profile)),
      status_(participant, "page", options.rig) {}

HandLead::~HandLead() {
  if (!state_)
    return;
  runtime::NodeReport report;
  report.session_id = state_->session_id;
  report.state = runtime::NodeState::kStopped;
  report.message = "stopped on request; the hand rests";
  status_.publish(report, false);
  status_.flush();
}

void HandLead::set_scene(const scene::Scene& scene) {
  const std::lock_guard lock(mutex_);
  frames_ = DeviceFrames{scene.device.pose_WD, scene.device.pose_PT, scene.device.position_scale};
}

void HandLead::set_state(const msg::DeviceState& state) {
  const std::lock_guard lock(mutex_);
  if (state_ && state_->session_id != state.session_id)
    target_.reset();
  state_ = state;
}

void HandLead::claim() {
  const std::lock_guard lock(mutex_);
  if (!state_)
    return;
  runtime::NodeReport report;
  report.session_id = state_->session_id;
  report.state = runtime::NodeState::kRunning;
  report.message = controlling_page_ ? fmt::format("page {} controls the hand", *controlling_page_)
                                     : "no page controls the hand";
  report.figures["targets"] = {sequence_, "targets"};
  status_.publish(report, false);
}

void HandLead::set_target(std::uint64_t page, const json& target, std::int64_t now_ns) {
  const auto p = target.at("p").get<std::array<double, 3>>();
  const auto q = target.at("q").get<std::array<double, 4>>();
  Pose pose{Vec3(p[0], p[1], p[2]), Quat(q[3], q[0], q[1], q[2])};
  if (!pose.position.allFinite() || !normalise_within(pose.orientation, 0.5, 2.0))
    return;
  const std::lock_guard lock(mutex_);
  if (controlling_page_ && *controlling_page_ != page && now_ns - target_time_ns_ < kIdleTimeoutNs)
    return;
  if (!frames_ || !state_ || !is_within_rate(now_ns))
    return;
  controlling_page_ = page, target_ = pose, target_time_ns_ = now_ns;
  Motion rest;
  rest.path = {pose.position}, rest.orientation = pose.orientation;
  rest = motion_in_device(rest, frames_->pose_WD, frames_->pose_PT, frames_->position_scale);
  msg::OperatorTarget message{};
  message.session_id = state_->session_id;
  message.sequence_number = sequence_++;
  message.sample_time_ns = state_->sample_time_ns;
  message.pose = runtime::to_msg(Pose{rest.path.front(), rest.orientation});
  targets_.write(message);
}

bool HandLead::is_within_rate(std::int64_t now_ns) {
  const double elapsed_s = 1e-9 * static_cast<double>(now_ns - allowance_time_ns_);
  allowance_ = std::min(allowance_ + kTargetsPerS * elapsed_s, kBurst);
  allowance_time_ns_ = now_ns;
  if (allowance_ < 1.0)
    return false;
  allowance_ -= 1.0;
  return true;
}

void HandLead::close(std::uint64_t page) {
  const std::lock_guard lock(mutex_);
  if (controlling_page_ == page)
    controlling_page_.reset();
}

json HandLead::to_json() const {
  const std::lock_guard lock(mutex_);
  json target;
  if (target_) {
    const Vec3& p = target_->position;
    const Quat& q = target_->orientation;
    for (const double x : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()})
      target.push_back(rounded(x));
  }
  return {{"page", controlling_page_ ? json(*controlling_page_) : json()},
          {"target", std::move(target)}};
}

}  // namespace voxtouch::view
