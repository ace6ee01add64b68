#include "nodes/bus/ros_discovery.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

namespace voxtouch::bus {
namespace {

std::string_view text_of(const dds_qos_t* qos, void** keeper) {
  std::size_t size = 0;
  return qos && dds_qget_userdata(qos, keeper, &size) && *keeper
             ? std::string_view(static_cast<const char*>(*keeper), size)
             : std::string_view();
}

/// Calls f(const T&, user data) for each entry of a built-in topic.
template <class T, class F>
void each_announced(dds_entity_t reader, F&& f) {
  void* lent[1] = {nullptr};
  dds_sample_info_t info;
  while (dds_take(reader, lent, &info, 1, 1) == 1) {
    const T& one = *static_cast<const T*>(lent[0]);
    if (info.valid_data && info.instance_state == DDS_ALIVE_INSTANCE_STATE) {
      void* data = nullptr;
      f(one, text_of(one.qos, &data));
      dds_free(data);
    }
    dds_return_loan(reader, lent, 1);
  }
}

Guid guid_of(const dds_guid_t& key) {
  Guid guid{};
  std::copy(std::begin(key.v), std::end(key.v), guid.begin());
  return guid;
}

}  // namespace

RosDiscovery::RosDiscovery(const Participant& own)
    : own_(own),
      participants_(
          dds_create_reader(own.get(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
          "cannot list participants"),
      readers_(dds_create_reader(own.get(), DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
               "cannot list readers") {}

void RosDiscovery::poll() {
  // Readers before participants: DDS announces a participant before its readers, so the owner of
  // each reader is then known.
  std::vector<std::pair<Guid, bool>> found;  // owner, has the hash
  each_announced<dds_builtintopic_endpoint_t>(
      readers_.get(), [&](const auto& one, std::string_view user_data) {
        if (std::string_view(one.topic_name) == "ros_discovery_info")
          found.emplace_back(guid_of(one.participant_key), user_data.contains("typehash="));
      });
  each_announced<dds_builtintopic_participant_t>(
      participants_.get(), [&](const auto& one, std::string_view user_data) {
        if (user_data.contains("voxtouch="))
          own_nodes_.insert(guid_of(one.key));
        if (guid_of(one.key) == own_.guid())
          return;
        ++(user_data.starts_with("enclave=") || user_data.contains(";enclave=") ? ros_ : others_);
      });
  for (const auto& [owner, has_hash] : found)
    if (!own_nodes_.contains(owner))
      (has_hash ? has_later_ : has_humble_) = true;
}

std::string RosDiscovery::mismatch(RosGraph graph) const {
  if (has_humble_ && has_later_)
    return "ROS 2 Humble and a later release share the domain: one of them does not list the "
           "ring's nodes";
  if (has_humble_ && graph != RosGraph::kHumble)
    return "ROS 2 Humble is on the domain: use --ros humble to list the ring's nodes there";
  if (has_later_ && graph == RosGraph::kHumble)
    return "ROS 2 later than Humble is on the domain: remove --ros humble to list the ring's nodes "
           "there";
  return {};
}

}  // namespace voxtouch::bus
