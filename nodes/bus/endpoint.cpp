#include "nodes/bus/endpoint.hpp"

#include <algorithm>
#include <cstring>

namespace voxtouch::bus {
namespace {

Entity make_topic(const Participant& participant, const qos::Topic& row, std::string_view rig,
                  const msg::AnyType& type) {
  const std::string name = qos::dds_name(row, rig);
  if (type.ros_name != row.type)
    throw Error("topic " + name + " carries " + std::string(row.type) + ", not " +
                std::string(type.ros_name));
  return Entity(
      dds_create_topic(participant.get(), type.descriptor, name.c_str(), nullptr, nullptr),
      "topic " + name + " cannot be created");
}

qos::Qos qos_of(const qos::Topic& row, const qos::Profile& profile, qos::Endpoint endpoint,
                const msg::AnyType& type) {
  qos::Qos qos = qos::make_qos(profile, endpoint, row.rate_hz > 0 ? 1.0 / row.rate_hz : 0.0);
  announce(qos.get(), type);
  return qos;
}

Guid to_guid(const dds_builtintopic_guid_t& key) {
  Guid guid{};
  std::memcpy(guid.data(), key.v, guid.size());
  return guid;
}

template <class List>
std::vector<dds_instance_handle_t> matched_handles(dds_entity_t endpoint, List list) {
  // The call returns the total number, even if it exceeds the given capacity.
  std::vector<dds_instance_handle_t> handles(64);
  auto count = list(endpoint, handles.data(), handles.size());
  while (count > static_cast<dds_return_t>(handles.size())) {
    handles.resize(static_cast<std::size_t>(count));
    count = list(endpoint, handles.data(), handles.size());
  }
  handles.resize(static_cast<std::size_t>(std::max(count, 0)));
  return handles;
}

/// Common to both directions; `List` and `Data` are the two DDS calls.
template <class List, class Data>
std::vector<Guid> matched(dds_entity_t endpoint, List list, Data data) {
  std::vector<Guid> guids;
  for (const dds_instance_handle_t handle : matched_handles(endpoint, list))
    if (dds_builtintopic_endpoint_t* peer = data(endpoint, handle)) {
      guids.push_back(to_guid(peer->participant_key));
      dds_builtintopic_free_endpoint(peer);
    }
  return guids;
}

}  // namespace

void announce(dds_qos_t* qos, const msg::AnyType& type) {
  const std::string hash = "typehash=" + std::string(type.hash) + ";";
  dds_qset_userdata(qos, hash.data(), hash.size());
}

EndpointEntities make_writer(const Participant& participant, const qos::Topic& row,
                             std::string_view rig, const qos::Profile& profile,
                             const msg::AnyType& type) {
  Entity topic = make_topic(participant, row, rig, type);
  const qos::Qos qos = qos_of(row, profile, qos::Endpoint::kWriter, type);
  Entity writer(dds_create_writer(participant.get(), topic.get(), qos.get(), nullptr),
                "a writer on " + qos::dds_name(row, rig) + " cannot be created");
  GraphEntry entry = participant.enter(writer.get(), qos::Endpoint::kWriter);
  return {std::move(topic), std::move(writer), std::move(entry)};
}

EndpointEntities make_reader(const Participant& participant, const qos::Topic& row,
                             std::string_view rig, const qos::Profile& profile,
                             const msg::AnyType& type, Following* following) {
  Entity topic = make_topic(participant, row, rig, type);
  if (following) {
    const dds_topic_filter filter = following->filter();
    if (dds_set_topic_filter_extended(topic.get(), &filter) != DDS_RETCODE_OK)
      throw Error("the reader on " + qos::dds_name(row, rig) +
                  " cannot be set to follow one writer");
  }
  const qos::Qos qos = qos_of(row, profile, qos::Endpoint::kReader, type);
  Entity reader(dds_create_reader(participant.get(), topic.get(), qos.get(), nullptr),
                "a reader on " + qos::dds_name(row, rig) + " cannot be created");
  if (following)
    following->attach(reader.get());
  GraphEntry entry = participant.enter(reader.get(), qos::Endpoint::kReader);
  return {std::move(topic), std::move(reader), std::move(entry)};
}

std::vector<Guid> matched_readers(dds_entity_t writer) {
  return matched(writer, dds_get_matched_subscriptions, dds_get_matched_subscription_data);
}

std::vector<Guid> matched_writers(dds_entity_t reader) {
  return matched(reader, dds_get_matched_publications, dds_get_matched_publication_data);
}

std::vector<dds_instance_handle_t> matched_writer_handles(dds_entity_t reader) {
  return matched_handles(reader, dds_get_matched_publications);
}

std::vector<dds_instance_handle_t> matched_reader_handles(dds_entity_t writer) {
  return matched_handles(writer, dds_get_matched_subscriptions);
}

Guid participant_of_writer(dds_entity_t reader, dds_instance_handle_t writer) {
  Guid guid{};
  if (dds_builtintopic_endpoint_t* peer = dds_get_matched_publication_data(reader, writer)) {
    guid = to_guid(peer->participant_key);
    dds_builtintopic_free_endpoint(peer);
  }
  return guid;
}

bool writer_is_matched(dds_entity_t reader, dds_instance_handle_t writer) {
  dds_builtintopic_endpoint_t* peer = dds_get_matched_publication_data(reader, writer);
  if (peer)
    dds_builtintopic_free_endpoint(peer);
  return peer != nullptr;
}

}  // namespace voxtouch::bus
