#include "nodes/bus/service_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace voxtouch::bus {
namespace {

constexpr dds_duration_t kPatience = DDS_MSECS(100);

/// Announces the hash of the type, and a unique name common to both endpoints, by which clients
/// identify the server.
qos::Qos service_qos(qos::Endpoint endpoint, const std::string& server, const msg::AnyType& type) {
  qos::Qos qos = qos::make_qos(qos::profile(qos::ProfileId::kService), endpoint, 0.0);
  const std::string words = "serviceid=" + server + ";typehash=" + std::string(type.hash) + ";";
  dds_qset_userdata(qos.get(), words.data(), words.size());
  return qos;
}

Entity make_topic(const Participant& participant, const std::string& name,
                  const msg::AnyType& type) {
  return Entity(
      dds_create_topic(participant.get(), type.descriptor, name.c_str(), nullptr, nullptr),
      "topic " + name + " cannot be created");
}

/// Announced by a client: its participant, and the common name of its two endpoints.
struct Client {
  Guid participant{};
  std::string id;
  bool operator==(const Client&) const = default;
};

/// Returns nothing if the endpoint has left.
std::optional<Client> client_of(dds_builtintopic_endpoint_t* endpoint) {
  if (!endpoint)
    return {};
  Client client;
  std::copy(std::begin(endpoint->participant_key.v), std::end(endpoint->participant_key.v),
            client.participant.begin());
  void* words = nullptr;
  std::size_t size = 0;
  if (endpoint->qos && dds_qget_userdata(endpoint->qos, &words, &size) && words) {
    const std::string_view text(static_cast<const char*>(words), size);
    constexpr std::string_view kKey = "clientid=";
    if (const std::size_t at = text.find(kKey); at != std::string_view::npos)
      client.id = text.substr(at + kKey.size(), text.find(';', at) - at - kKey.size());
    dds_free(words);
  }
  dds_builtintopic_free_endpoint(endpoint);
  return client;
}

}  // namespace

ServiceEndpoints::ServiceEndpoints(const Participant& participant, const qos::Service& row,
                                   std::string_view rig, std::string_view node,
                                   const msg::AnyType& request, const msg::AnyType& response,
                                   bool (*fits)(const void*)) {
  const std::string requested = qos::request_name(row, rig, node),
                    answered = qos::reply_name(row, rig, node);
  const std::string server =
      fmt::format("{:02x}.{}", fmt::join(participant.guid(), ""), std::string_view(row.path));
  requests_.topic = make_topic(participant, requested, request);
  dds_topic_filter filter{};
  filter.mode = DDS_TOPIC_FILTER_SAMPLE;
  filter.f.sample = fits;
  if (dds_set_topic_filter_extended(requests_.topic.get(), &filter) != DDS_RETCODE_OK)
    throw Error("the reader on " + requested + " cannot be set to refuse requests");
  requests_.endpoint =
      Entity(dds_create_reader(participant.get(), requests_.topic.get(),
                               service_qos(qos::Endpoint::kReader, server, request).get(), nullptr),
             "a reader on " + requested + " cannot be created");
  requests_.entry = participant.enter(requests_.endpoint.get(), qos::Endpoint::kReader);
  unread_ = Entity(dds_create_readcondition(requests_.endpoint.get(), DDS_ANY_STATE),
                   "cannot create a read condition");
  replies_.topic = make_topic(participant, answered, response);
  replies_.endpoint = Entity(
      dds_create_writer(participant.get(), replies_.topic.get(),
                        service_qos(qos::Endpoint::kWriter, server, response).get(), nullptr),
      "a writer on " + answered + " cannot be created");
  replies_.entry = participant.enter(replies_.endpoint.get(), qos::Endpoint::kWriter);
}

bool ServiceEndpoints::knows(const Caller& caller) const {
  const std::optional<Client> client =
      client_of(dds_get_matched_publication_data(requests_.endpoint.get(), caller.writer));
  if (!client)
    return false;
  const std::vector<dds_instance_handle_t> readers =
      matched_reader_handles(replies_.endpoint.get());
  return std::any_of(readers.begin(), readers.end(), [&](dds_instance_handle_t reader) {
    return client_of(dds_get_matched_subscription_data(replies_.endpoint.get(), reader)) == client;
  });
}

void ServiceEndpoints::reply(const Caller& caller, std::function<void(dds_entity_t writer)> send) {
  if (knows(caller))
    return send(replies_.endpoint.get());
  if (waiting_.size() == kMaxWaiting)
    waiting_.pop_front();
  waiting_.push_back({caller, dds_time() + kPatience, std::move(send)});
}

void ServiceEndpoints::send_waiting() {
  const dds_time_t now = dds_time();
  std::erase_if(waiting_, [&](const Waiting& one) {
    const bool is_known = knows(one.caller);
    if (is_known)
      one.send(replies_.endpoint.get());
    return is_known || now > one.until;
  });
}

}  // namespace voxtouch::bus
