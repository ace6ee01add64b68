#include "nodes/view/last_seconds.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "nodes/bus/endpoint.hpp"
#include "qos/topics.hpp"
#include "voxtouch_msgs/all_types.hpp"
#include "voxtouch_msgs/definitions.hpp"

namespace voxtouch::view {
namespace {

std::vector<const qos::Topic*> recorded_topics() {
  std::vector<const qos::Topic*> rows;
  for (const qos::Topic& row : qos::kTopics)
    if ((row.readers & qos::kLogger) != 0)
      rows.push_back(&row);
  return rows;
}

bool is_latched(const qos::Topic& row) { return row.profile == qos::ProfileId::kLatched; }

std::vector<bool> latched_topics() {
  std::vector<bool> latched;
  for (const qos::Topic* row : recorded_topics())
    latched.push_back(is_latched(*row));
  return latched;
}

/// With room for a second of the ring: this process has the lowest priority.
qos::Profile profile_of(const qos::Topic& row) {
  if (is_latched(row))
    return qos::profile(row.profile);
  qos::Profile tap = qos::profile(qos::ProfileId::kTap);
  tap.depth = 1024;
  return tap;
}

double seconds_of(const std::vector<RecentMessage>& messages) {
  return messages.empty()
             ? 0.0
             : 1e-9 * static_cast<double>(messages.back().written_ns - messages.front().written_ns);
}

LastSeconds::Answer write(const std::vector<bag::TopicInfo>& topics,
                          const std::vector<RecentMessage>& messages, const std::string& scene,
                          const SaveActions& actions) {
  const std::filesystem::path folder = actions.make_folder(scene);
  if (const auto written = write_recording(folder, topics, messages); !written)
    return {false, "Not saved. " + written.error().sentence};
  const std::string saved =
      fmt::format("{:.1f} s saved to {}", seconds_of(messages), folder.string());
  try {
    actions.report(folder);
  } catch (const std::exception& error) {
    return {true, fmt::format("{}, without a report: {}", saved, error.what())};
  }
  return {true, saved + ", with report.html."};
}

}  // namespace

LastSeconds::LastSeconds(const bus::Participant& participant, const runtime::NodeOptions& options,
                         const SaveActions& actions)
    : actions_(actions),
      recent_(latched_topics()) {
  for (const qos::Topic* row : recorded_topics()) {
    const msg::AnyType& type =
        *std::ranges::find(msg::kAllTypes, row->type, &msg::AnyType::ros_name);
    const std::string name = qos::dds_name(*row, options.rig);
    const qos::Qos qos = qos::make_qos(profile_of(*row), qos::Endpoint::kReader, 0.0);
    bus::announce(qos.get(), type);
    bus::RawReader reader(participant.get(), name, *type.descriptor, qos.get());
    bus::GraphEntry graph_entry = participant.enter(reader.get(), qos::Endpoint::kReader);
    sources_.push_back({std::move(reader), std::move(graph_entry)});
    constexpr std::size_t kRosPrefix = 2;  // "rt"
    topics_.push_back({.name = name.substr(kRosPrefix),
                       .type = std::string(type.ros_name),
                       .offered_qos = {},
                       .type_hash = std::string(type.hash),
                       .definition = std::string(msg::definition_of(type.ros_name))});
  }
}

void LastSeconds::take() {
  for (std::size_t n = 0; n < sources_.size(); ++n)
    sources_[n].reader.take([&](std::span<const std::byte> bytes, const dds_sample_info_t& info) {
      recent_.add(n, info.source_timestamp, bytes);
    });
}

void LastSeconds::save(const std::string& scene) {
  std::vector<RecentMessage> messages = recent_.all();
  if (saving_.valid())
    refusal_ = Answer{false, "Not saved: another recording is being saved."};
  else if (messages.empty())
    refusal_ = Answer{false, "Not saved: the ring has sent nothing."};
  else
    saving_ =
        std::async(std::launch::async, [this, scene, messages = std::move(messages)]() -> Answer {
          try {
            return write(topics_, messages, scene, actions_);
          } catch (const std::exception& error) {
            return {false, fmt::format("Not saved. {}", error.what())};
          }
        });
}

std::optional<LastSeconds::Answer> LastSeconds::poll() {
  if (refusal_)
    return std::exchange(refusal_, std::nullopt);
  if (!saving_.valid() || saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  return saving_.get();
}

}  // namespace voxtouch::view
