#include "nodes/view/ring_tap.hpp"

#include <unistd.h>

namespace voxtouch::view {
namespace {

constexpr int kMaxPerPoll = 256;  ///< rare messages per poll, so that a flood does not delay frames

/// The profile of taps, with a queue of one second: this process has the lowest priority.
const qos::Profile& tap() {
  static const qos::Profile profile = [] {
    qos::Profile deep = qos::profile(qos::ProfileId::kTap);
    deep.depth = 1024;
    return deep;
  }();
  return profile;
}

}  // namespace

RingTap::RingTap(const bus::Participant& participant, const runtime::NodeOptions& o)
    : registry_(participant, o.rig),
      states_(participant, qos::kDeviceState, o.rig, tap()),
      contacts_(participant, qos::kContactState, o.rig, tap()),
      commands_(participant, qos::kForceCommand, o.rig, tap()),
      plans_(participant, qos::kScenePlan, o.rig, qos::profile(qos::kScenePlan.profile)),
      designs_(participant, qos::kCouplingDesign, o.rig,
               qos::profile(qos::kCouplingDesign.profile)),
      devices_(participant, qos::kDeviceDescription, o.rig,
               qos::profile(qos::kDeviceDescription.profile)),
      changes_(participant, qos::kEffectChange, o.rig, tap()),
      answers_(participant, qos::kEffectChanged, o.rig, qos::profile(qos::kEffectChanged.profile)) {
}

void RingTap::take(Picture& picture, Facts& facts, NodeTable& nodes, std::int64_t now_ns) {
  registry_.update();
  nodes.update(registry_, now_ns);
  states_.take_each([&](const msg::DeviceState& m, const dds_sample_info_t& info) {
    picture.take(m, info.source_timestamp);
  });
  contacts_.take_each([&](const msg::ContactState& m) { picture.take(m); });
  commands_.take_each([&](const msg::ForceCommand& m, const dds_sample_info_t& info) {
    picture.take(m, info.source_timestamp);
  });
  devices_.take_each([&](const msg::DeviceDescription& m) { facts.take(m); }, kMaxPerPoll);
  plans_.take_each([&](const msg::ScenePlan& m) { facts.take(m); }, kMaxPerPoll);
  designs_.take_each([&](const msg::CouplingDesign& m) { facts.take(m); }, kMaxPerPoll);
  changes_.take_each([&](const msg::EffectChange& m) { facts.take(m); }, kMaxPerPoll);
  answers_.take_each([&](const msg::EffectChanged& m) { facts.take(m); }, kMaxPerPoll);
}

std::string RingTap::scene_file() const {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  const auto rendering = registry_.find("rendering");
  if (!rendering || rendering->host != host)
    return {};
  const auto file = rendering->values.find("scene_file");
  return file == rendering->values.end() ? std::string() : file->second;
}

}  // namespace voxtouch::view
