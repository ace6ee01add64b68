#include "nodes/device/recording.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/registry.hpp"
#include "nodes/bag/bag_reader.hpp"
#include "nodes/bus/message_bytes.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/runtime/device_message.hpp"
#include "qos/topics.hpp"

namespace voxtouch::device_node {
namespace {

std::string rig_asked(const devices::DeviceSettings& settings) {
  const auto asked =
      std::ranges::find(settings, "rig", &std::pair<std::string, std::string>::first);
  return asked == settings.end() ? "" : asked->second;
}

/// Takes device samples and descriptions of a bag, of the rigs as they come.
class HandsInBag {
 public:
  HandsInBag(const bag::BagReader& bag, std::string name, std::string rig)
      : bag_(bag),
        name_(std::move(name)),
        rig_(std::move(rig)) {
    const std::string samples = "/" + std::string(qos::kDeviceState.path);
    for (const bag::TopicInfo& topic : bag.topics())
      if (topic.type == qos::kDeviceState.type && topic.name.ends_with(samples))
        rigs_.insert(topic.name.substr(1, topic.name.size() - samples.size() - 1));
    if (rigs_.empty())
      throw std::runtime_error(fmt::format(
          "{} has no device samples (a topic /<rig>/{}): it is not the recording of a ring.", name_,
          qos::kDeviceState.path));
    if (rig_.empty() && rigs_.size() > 1)
      throw std::runtime_error(
          fmt::format("{} holds several rigs: {}. Choose one with --device-option rig=NAME.", name_,
                      fmt::join(rigs_, ", ")));
    if (rig_.empty())
      rig_ = *rigs_.begin();
    if (!rigs_.contains(rig_))
      throw std::runtime_error(
          fmt::format("{} holds no rig '{}', but {}.", name_, rig_, fmt::join(rigs_, ", ")));
  }

  recorded::RecordedHand longest() && {
    const std::string samples = topic_of(qos::kDeviceState),
                      descriptions = topic_of(qos::kDeviceDescription);
    const auto& topics = bag_.topics();
    using Times = std::numeric_limits<std::int64_t>;
    const auto read =
        bag_.for_each_between(Times::min(), Times::max(), [&](const bag::BagMessage& m) {
          if (topics[m.topic].name == samples)
            take_sample(m.bytes);
          if (topics[m.topic].name == descriptions)
            take_description(m.bytes);
          return true;
        });
    if (!read)
      throw std::runtime_error(read.error().sentence);
    const auto most = std::ranges::max_element(
        sessions_, {}, [](const auto& session) { return session.second.size(); });
    if (most == sessions_.end())
      throw std::runtime_error(fmt::format("{} holds no device samples of rig '{}'.", name_, rig_));
    const auto described = descriptions_.find(most->first);
    if (described == descriptions_.end())
      throw std::runtime_error(fmt::format("{} does not say what device gave its samples (/{}/{}).",
                                           name_, rig_, qos::kDeviceDescription.path));
    recorded::RecordedHand hand{described->second, {}};
    for (const auto& [number, sample] : most->second)
      if (hand.samples.empty() || sample.time_ns > hand.samples.back().time_ns)
        hand.samples.push_back(sample);
    return hand;
  }

 private:
  std::string topic_of(const qos::Topic& topic) const {
    return fmt::format("/{}/{}", rig_, topic.path);
  }
  [[noreturn]] void strange(std::string_view what) const {
    throw std::runtime_error(
        fmt::format("{} holds a {} that this version does not read: it was recorded by another "
                    "version of voxtouch, or is damaged.",
                    name_, what));
  }

  void take_sample(std::span<const std::byte> bytes) {
    msg::DeviceState m;
    if (!bus::read_stream(bytes, m))
      strange("DeviceState");
    devices::DeviceSample sample{m.sample_time_ns, runtime::from_msg(m.pose),
                                 runtime::from_msg(m.twist), m.buttons,
                                 (m.flags & msg::device_state::kFlagPoseHeld) == 0};
    if (Quat unit = sample.pose.orientation; !sample.pose.position.allFinite() ||
                                             !sample.twist.finite() ||
                                             !normalise_within(unit, 0.99, 1.01))
      strange("pose of the device");
    sessions_[m.session_id].try_emplace(m.sequence_number,
                                        sample);  // DDS may have given the recorder one twice
  }

  void take_description(std::span<const std::byte> bytes) {
    const auto keep = [this](const msg::DeviceDescription& m) {
      const DeviceDescription device = runtime::from_msg(m);
      if (what_is_wrong(device).empty())
        descriptions_.try_emplace(m.session_id, device);
    };
    if (!bus::read_message<msg::DeviceDescription>(bytes, keep))
      strange("DeviceDescription");
  }

  const bag::BagReader& bag_;
  std::string name_, rig_;
  std::set<std::string> rigs_;
  std::map<std::uint64_t, std::map<std::uint64_t, devices::DeviceSample>>
      sessions_;                                             ///< by session and number
  std::map<std::uint64_t, DeviceDescription> descriptions_;  ///< by session, the first that will do
};

}  // namespace

std::shared_ptr<const recorded::RecordedHand> recorded_hand(
    const std::string& device, const devices::DeviceSettings& settings) {
  if (!devices::is_recording(device))
    return nullptr;
  const std::string path = device.substr(devices::kRecordedPrefix.size());
  const auto bag = bag::BagReader::open(path);
  if (!bag)
    throw std::runtime_error(bag.error().sentence);
  return std::make_shared<const recorded::RecordedHand>(
      HandsInBag(*bag, path, rig_asked(settings)).longest());
}

std::string about(const recorded::RecordedHand& hand, const std::string& device) {
  const double period_ns = 1e9 / hand.description.rate_hz;
  std::uint64_t gaps = 0;
  double longest_ns = 0.0;
  for (std::size_t i = 1; i < hand.samples.size(); ++i) {
    const auto step_ns = static_cast<double>(hand.samples[i].time_ns - hand.samples[i - 1].time_ns);
    if (step_ns < 1.5 * period_ns)
      continue;
    ++gaps;
    longest_ns = std::max(longest_ns, step_ns);
  }
  const double lasts_s =
      1e-9 * static_cast<double>(hand.samples.back().time_ns - hand.samples.front().time_ns);
  const std::string bridged =
      gaps == 0
          ? ""
          : fmt::format(
                " It has {} gaps, the longest {:.0f} ms, which are bridged in straight lines.",
                gaps, 1e-6 * longest_ns);
  return fmt::format(
      "the hand is a recording of {:.1f} s ({}): it goes where it went then, whatever force is "
      "commanded. What is commanded can be looked at; of stability and "
      "of what a person would feel this run says nothing.{}",
      lasts_s, device.substr(devices::kRecordedPrefix.size()), bridged);
}

}  // namespace voxtouch::device_node
