#include "nodes/bus/opaque_discovery.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace voxtouch::bus {
namespace {

Guid to_guid(const dds_guid_t& dds) {
  Guid guid{};
  std::copy(std::begin(dds.v), std::end(dds.v), guid.begin());
  return guid;
}

Durability to_durability(dds_durability_kind_t kind) {
  switch (kind) {
    case DDS_DURABILITY_VOLATILE: return Durability::kVolatile;
    case DDS_DURABILITY_TRANSIENT_LOCAL: return Durability::kTransientLocal;
    case DDS_DURABILITY_TRANSIENT: return Durability::kTransient;
    case DDS_DURABILITY_PERSISTENT: return Durability::kPersistent;
  }
  return Durability::kVolatile;
}

Liveliness to_liveliness(dds_liveliness_kind_t kind) {
  switch (kind) {
    case DDS_LIVELINESS_AUTOMATIC: return Liveliness::kAutomatic;
    case DDS_LIVELINESS_MANUAL_BY_PARTICIPANT: return Liveliness::kManualByParticipant;
    case DDS_LIVELINESS_MANUAL_BY_TOPIC: return Liveliness::kManualByTopic;
  }
  return Liveliness::kAutomatic;
}

// A getter that returns false leaves the default in place: the writer did not announce that policy.
EndpointQos to_qos(const dds_qos_t* dds) {
  EndpointQos qos;
  dds_reliability_kind_t reliability{};
  dds_duration_t time = 0;
  if (dds_qget_reliability(dds, &reliability, &time)) {
    const bool reliable = reliability == DDS_RELIABILITY_RELIABLE;
    qos.reliability = reliable ? Reliability::kReliable : Reliability::kBestEffort;
    qos.max_blocking_ns = time;
  }
  dds_durability_kind_t durability{};
  if (dds_qget_durability(dds, &durability)) qos.durability = to_durability(durability);
  dds_history_kind_t history{};
  std::int32_t depth = 0;
  if (dds_qget_history(dds, &history, &depth)) {
    qos.history = history == DDS_HISTORY_KEEP_ALL ? History::kKeepAll : History::kKeepLast;
    qos.depth = depth;
  }
  std::int32_t samples = 0, instances = 0, per_instance = 0;
  if (dds_qget_resource_limits(dds, &samples, &instances, &per_instance)) qos.max_samples = samples;
  if (dds_qget_deadline(dds, &time)) qos.deadline_ns = time;
  if (dds_qget_lifespan(dds, &time)) qos.lifespan_ns = time;
  dds_liveliness_kind_t liveliness{};
  if (dds_qget_liveliness(dds, &liveliness, &time)) {
    qos.liveliness = to_liveliness(liveliness);
    qos.lease_ns = time;
  }
  return qos;
}

std::string user_data_of(const dds_qos_t* qos) {
  void* bytes = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &bytes, &size) || bytes == nullptr) return {};
  std::string text(static_cast<const char*>(bytes), size);
  dds_free(bytes);
  return text;
}

// The last byte of a GUID is the entity kind: user writer with key 0x02, without 0x03 (DDSI-RTPS, entity
// kinds).
bool is_keyed(const Guid& guid) { return (guid[15] & 0x3fU) == 0x02U; }

std::unexpected<OpaqueError> refused(dds_return_t code, fmt::format_string<const char*> sentence) {
  return std::unexpected(OpaqueError{code, fmt::format(sentence, dds_strretcode(code))});
}

void describe(dds_builtintopic_endpoint_t& endpoint, DiscoveredWriter& writer) {
  writer.participant = to_guid(endpoint.participant_key);
  if (endpoint.topic_name != nullptr) writer.topic = endpoint.topic_name;
  if (endpoint.type_name != nullptr) writer.type_name = endpoint.type_name;
  if (endpoint.qos != nullptr) {
    writer.qos = to_qos(endpoint.qos);
    writer.user_data = user_data_of(endpoint.qos);
  }
  const dds_typeinfo_t* type_information = nullptr;  // stays the endpoint's
  writer.has_type_information =
      dds_builtintopic_get_endpoint_type_info(&endpoint, &type_information) == DDS_RETCODE_OK &&
      type_information != nullptr;
}

}  // namespace

OpaqueResult<WriterDiscovery> WriterDiscovery::create(dds_entity_t participant, const dds_listener_t* listener) {
  const dds_entity_t reader = dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, listener);
  if (reader < 0) return refused(reader, "DDS does not tell of the writers on the network: {}.");
  return WriterDiscovery(OwnedEntity(reader));
}

OpaqueResult<std::size_t> WriterDiscovery::take(const std::function<void(const DiscoveredWriter&)>& f) {
  constexpr std::size_t kBatch = 32;
  std::size_t taken = 0;
  while (true) {
    std::array<void*, kBatch> samples{};  // null: DDS lends its own
    std::array<dds_sample_info_t, kBatch> info{};
    const dds_return_t n = dds_take(entity_.get(), samples.data(), info.data(), kBatch, kBatch);
    if (n < 0) return refused(n, "DDS does not hand over the list of writers: {}.");
    if (n == 0) return taken;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      auto& endpoint = *static_cast<dds_builtintopic_endpoint_t*>(samples[i]);
      DiscoveredWriter writer;
      writer.guid = to_guid(endpoint.key);
      writer.keyed = is_keyed(writer.guid);
      writer.alive = info[i].valid_data && info[i].instance_state == DDS_ALIVE_INSTANCE_STATE;
      if (info[i].valid_data) describe(endpoint, writer);
      f(writer);
    }
    dds_return_loan(entity_.get(), samples.data(), n);
    taken += static_cast<std::size_t>(n);
  }
}

}  // namespace voxtouch::bus
