#include "nodes/rendering/external_source.hpp"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "core/effects/effect_change.hpp"
#include "nodes/rendering/ros_markers.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/realtime.hpp"

namespace voxtouch::rendering_node {
namespace {

constexpr std::size_t kMaxOthers = 16;
/// Minimum time between two polls of the topic. It bounds the cost of a flood of messages.
constexpr std::int64_t kPollNs = 500'000;

const effects::EffectSpec& effect_of(const scene::Scene& scene) {
  return *effects::external_of(scene.effects);
}

/// Full topic name in ROS form.
std::string topic_of(const std::string& text, const std::string& rig) {
  return qos::dds_name(qos::external_topic(text), rig).substr(std::strlen("rt"));
}

bus::Reader<msg::geometry_msgs_WrenchStamped> reader_of(const bus::Participant& participant,
                                                        const runtime::NodeOptions& options,
                                                        const std::string& text,
                                                        bus::Following* following) {
  const qos::Topic row = qos::external_topic(text);
  const std::string name = qos::dds_name(row, options.rig);
  for (const qos::Topic& own : qos::kTopics)
    if (own.path != qos::kExternalWrench.path && qos::dds_name(own, options.rig) == name)
      throw bus::Error(fmt::format(
          "Effect 'external' cannot read {}: the ring uses this topic. Choose another topic",
          name.substr(2)));
  if (!options.security.empty() && !text.empty())
    throw bus::Error(
        fmt::format("The rendering's keys do not permit to read {}. Remove `topic`, and write {} "
                    "with the tool's keys",
                    text, topic_of("", options.rig)));
  return {participant, row, options.rig, qos::profile(row.profile), following};
}

std::string names_of(const runtime::NodeRegistry& registry,
                     const std::set<bus::Guid>& participants) {
  std::string all;
  for (const bus::Guid& participant : participants)
    all += (all.empty() ? "" : " and ") + registry.name_of(participant);
  return all;
}

}  // namespace

ExternalSource::ExternalSource(const bus::Participant& participant,
                               const runtime::NodeOptions& options, const scene::Scene& scene)
    : topic_(topic_of(effect_of(scene).text, options.rig)),
      device_frame_(options.rig + "/device"),
      device_in_world_(scene.device.pose_WD.orientation),
      about_(effects::no_certificate_sentence(effect_of(scene).name)),
      following_(std::make_unique<bus::Following>(bus::Following::WhileUnbound::kTakeNothing)),
      reader_(reader_of(participant, options, effect_of(scene).text, following_.get())),
      records_(participant, qos::kExternalSample, options.rig,
               qos::profile(qos::kExternalSample.profile)),
      wait_set_(participant) {
  wait_set_.attach(reader_.condition());
  thread_ = std::thread([this] { run(); });
}

ExternalSource::~ExternalSource() {
  stop_.store(true, std::memory_order_release);
  thread_.join();
}

void ExternalSource::run() {
  runtime::ordinary_priority();
  constexpr int kMaxTakes = 64;
  while (!stop_.load(std::memory_order_acquire)) {
    wait_set_.wait(20'000'000);
    reader_.take_each(
        [this](const msg::geometry_msgs_WrenchStamped& message, dds_instance_handle_t writer) {
          if (following_->admits(writer))
            receive(message);  // otherwise it was stored while another writer was followed
        },
        kMaxTakes);
    runtime::sleep_until(runtime::monotonic_ns() + kPollNs);
  }
}

/// The writer's stamp refers to an unknown clock and is ignored.
void ExternalSource::receive(const msg::geometry_msgs_WrenchStamped& message) {
  const std::string_view frame = message.header.frame_id ? message.header.frame_id : "";
  const bool of_device = frame == device_frame_;
  if (!of_device && frame != kWorldFrame) {
    if (counters_[ExternalCounter::kWrongFrame] == 0.0) {
      FrameText text{};
      std::copy_n(frame.begin(), std::min(frame.size(), text.size() - 1), text.begin());
      bad_frame_.put(text);
    }
    return counters_.note(ExternalCounter::kWrongFrame);
  }
  Wrench wrench = runtime::from_msg(message.wrench);
  if (!wrench.finite())
    return counters_.note(ExternalCounter::kNotFinite);
  if (of_device)
    wrench = {device_in_world_ * wrench.force, device_in_world_ * wrench.torque};
  newest_.put({wrench, session_.load(std::memory_order_acquire), runtime::monotonic_ns()});
}

std::optional<Wrench> ExternalSource::take(const msg::DeviceState& next) noexcept {
  Arrived arrived;
  if (!newest_.take(arrived) || arrived.session != next.session_id)
    return std::nullopt;
  const std::int64_t now_ns = runtime::monotonic_ns();
  if (now_ns - arrived.at_ns > kMaxWaitNs) {
    counters_.note(ExternalCounter::kLate);
    return std::nullopt;
  }
  counters_.note(ExternalCounter::kTaken);
  records_.write({next.session_id, next.sequence_number, next.sample_time_ns,
                  runtime::to_msg(arrived.wrench)});
  return arrived.wrench;
}

void ExternalSource::poll() {
  const std::uint64_t session = session_.load(std::memory_order_acquire);
  if (session != bound_for_ || (bound_ && !following_->has_writer())) {
    following_->follow_none();
    bound_.reset();
    if (session != bound_for_)
      others_.clear();
    bound_for_ = session;
  }
  const std::vector<bus::Guid> all = reader_.matched();
  const std::set<bus::Guid> matched(all.begin(), all.end());
  if (!bound_)
    look_for_writer(matched);
  for (const bus::RefusedSamples& refused : following_->take_refused())
    if (others_.size() < kMaxOthers)
      others_.insert(refused.participant);
  if (bound_) {
    for (const bus::Guid& other : matched)
      if (others_.size() < kMaxOthers)
        others_.insert(other);
    others_.erase(*bound_);
  }
  std::erase_if(others_, [&](const bus::Guid& other) { return !matched.contains(other); });
  FrameText text{};
  if (bad_frame_.take(text))
    frame_ = effects::quotable(text.data());
}

void ExternalSource::look_for_writer(const std::set<bus::Guid>& matched) {
  conflicting_.clear();
  if (bound_for_ == 0)
    return;
  if (matched.size() > 1)
    conflicting_ = matched;
  if (matched.size() == 1 && following_->follow(*matched.begin()))
    bound_ = *matched.begin();
}

void ExternalSource::report_to(const runtime::NodeRegistry& registry, runtime::NodeReport& report,
                               runtime::StatusText& status) {
  poll();
  report.values["external"] = about_;
  report.values["external_topic"] = topic_;
  report.values["external_writer"] = bound_ ? registry.name_of(*bound_) : "";
  report.figures["external_foreign"] = {following_->refused(), "samples"};
  counters_.report_to(report.figures);
  status.set(runtime::StatusPriority::kFault, diagnostic(registry));
}

std::string ExternalSource::diagnostic(const runtime::NodeRegistry& registry) const {
  if (!conflicting_.empty())
    return fmt::format("{} writers on {}, limit 1; none is used: {}. Stop all but one",
                       conflicting_.size(), topic_, names_of(registry, conflicting_));
  if (!others_.empty() && bound_)
    return fmt::format(
        "wrenches of {} on {} are refused: this session's external wrench comes from {}",
        names_of(registry, others_), topic_, registry.name_of(*bound_));
  if (frame_.empty())
    return {};
  return fmt::format("wrench on {} in frame '{}' refused; valid frames: '{}' or '{}'", topic_,
                     frame_, kWorldFrame, device_frame_);
}

}  // namespace voxtouch::rendering_node
