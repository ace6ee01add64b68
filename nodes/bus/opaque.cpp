#include "nodes/bus/opaque.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "nodes/bus/opaque_serdata.hpp"

namespace voxtouch::bus {
namespace {

struct QosDelete {
  void operator()(dds_qos_t* qos) const noexcept { dds_delete_qos(qos); }
};
using QosPointer = std::unique_ptr<dds_qos_t, QosDelete>;

dds_durability_kind_t to_dds(Durability durability) {
  switch (durability) {
    case Durability::kVolatile: return DDS_DURABILITY_VOLATILE;
    case Durability::kTransientLocal: return DDS_DURABILITY_TRANSIENT_LOCAL;
    case Durability::kTransient: return DDS_DURABILITY_TRANSIENT;
    case Durability::kPersistent: return DDS_DURABILITY_PERSISTENT;
  }
  return DDS_DURABILITY_VOLATILE;
}

dds_liveliness_kind_t to_dds(Liveliness liveliness) {
  switch (liveliness) {
    case Liveliness::kAutomatic: return DDS_LIVELINESS_AUTOMATIC;
    case Liveliness::kManualByParticipant: return DDS_LIVELINESS_MANUAL_BY_PARTICIPANT;
    case Liveliness::kManualByTopic: return DDS_LIVELINESS_MANUAL_BY_TOPIC;
  }
  return DDS_LIVELINESS_AUTOMATIC;
}

QosPointer make_qos(const EndpointQos& value, bool writer) {
  QosPointer qos(dds_create_qos());
  const bool reliable = value.reliability == Reliability::kReliable;
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       value.max_blocking_ns);
  dds_qset_durability(qos.get(), to_dds(value.durability));
  const auto history = value.history == History::kKeepAll ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST;
  dds_qset_history(qos.get(), history, value.depth);
  if (value.history == History::kKeepAll)
    dds_qset_resource_limits(qos.get(), value.max_samples, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_deadline(qos.get(), value.deadline_ns);
  dds_qset_liveliness(qos.get(), to_dds(value.liveliness), value.lease_ns);
  if (writer) {
    dds_qset_lifespan(qos.get(), value.lifespan_ns);
    dds_qset_writer_data_lifecycle(qos.get(), false);
    // what is kept for late readers has its own history setting
    if (value.durability != Durability::kVolatile)
      dds_qset_durability_service(qos.get(), 0, history, value.depth, value.max_samples, DDS_LENGTH_UNLIMITED,
                                  DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

std::unexpected<OpaqueError> refused(dds_return_t code, std::string what) {
  return std::unexpected(OpaqueError{code, fmt::format("{}: {}.", what, dds_strretcode(code))});
}

InstanceState to_state(dds_instance_state_t state) {
  if (state == DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE) return InstanceState::kDisposed;
  return state == DDS_ALIVE_INSTANCE_STATE ? InstanceState::kAlive : InstanceState::kNoWriters;
}

RawSample to_raw(const ddsi_serdata* serdata, const dds_sample_info_t& info) {
  RawSample raw;
  raw.source_time_ns = info.source_timestamp;
  raw.publication_handle = info.publication_handle;
  raw.state = to_state(info.instance_state);
  raw.valid = info.valid_data;
  if (info.valid_data && serdata != nullptr) {
    raw.bytes = as_opaque(serdata).bytes();
    raw.reception_time_ns = as_opaque(serdata).reception_time_ns;
  }
  return raw;
}

}  // namespace

OpaqueResult<OpaqueTopic> OpaqueTopic::create(dds_entity_t participant, const std::string& name,
                                              const std::string& type_name) {
  ddsi_sertype* type = make_opaque_sertype(type_name.c_str());
  const dds_entity_t topic = dds_create_topic_sertype(participant, name.c_str(), &type, nullptr, nullptr, nullptr);
  if (topic < 0) {
    ddsi_sertype_unref(type);  // only a topic that exists takes it over
    return refused(topic, fmt::format("DDS does not make topic '{}' of type '{}'", name, type_name));
  }
  return OpaqueTopic(participant, OwnedEntity(topic), name, type_name);
}

OpaqueResult<OpaqueReader> OpaqueReader::create(const OpaqueTopic& topic, const EndpointQos& qos,
                                                const dds_listener_t* listener) {
  const QosPointer dds_qos = make_qos(qos, false);
  const dds_entity_t reader = dds_create_reader(topic.participant(), topic.handle(), dds_qos.get(), listener);
  if (reader < 0) return refused(reader, fmt::format("DDS does not make a reader on '{}'", topic.name()));
  return OpaqueReader(OwnedEntity(reader));
}

OpaqueResult<std::size_t> OpaqueReader::take_each(Each each, void* context, std::size_t max) {
  constexpr std::size_t kBatch = 64;
  std::array<ddsi_serdata*, kBatch> serdata{};
  std::array<dds_sample_info_t, kBatch> info{};
  std::size_t taken = 0;
  while (taken < max) {
    const auto want = static_cast<std::uint32_t>(std::min(kBatch, max - taken));
    const dds_return_t n = dds_takecdr(entity_.get(), serdata.data(), want, info.data(), DDS_ANY_STATE);
    if (n < 0) return refused(n, "DDS does not hand over the samples of a reader");
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      each(context, to_raw(serdata[i], info[i]));
      if (serdata[i] != nullptr) ddsi_serdata_unref(serdata[i]);
    }
    taken += static_cast<std::size_t>(n);
    if (n == 0 || static_cast<std::uint32_t>(n) < want) break;
  }
  return taken;
}

std::size_t OpaqueReader::matched_writers() const noexcept {
  dds_subscription_matched_status_t status{};
  if (dds_get_subscription_matched_status(entity_.get(), &status) != DDS_RETCODE_OK) return 0;
  return status.current_count;
}

OpaqueResult<OpaqueWriter> OpaqueWriter::create(const OpaqueTopic& topic, const EndpointQos& qos) {
  const QosPointer dds_qos = make_qos(qos, true);
  const dds_entity_t writer = dds_create_writer(topic.participant(), topic.handle(), dds_qos.get(), nullptr);
  if (writer < 0) return refused(writer, fmt::format("DDS does not make a writer on '{}'", topic.name()));
  return OpaqueWriter(OwnedEntity(writer), topic.name());
}

OpaqueResult<void> OpaqueWriter::write(std::span<const std::byte> bytes, std::int64_t source_time_ns) {
  if (bytes.size() < 4)
    return refused(DDS_RETCODE_BAD_PARAMETER,
                   fmt::format("A message of {} bytes for '{}' has no encapsulation header and is not written",
                               bytes.size(), topic_));
  const OpaqueBytes sample = bytes;  // what from_sample expects behind the pointer
  const dds_return_t code = dds_write_ts(entity_.get(), &sample, source_time_ns);
  if (code < 0)
    return refused(code, fmt::format("DDS does not write a message of {} bytes on '{}'", bytes.size(), topic_));
  return {};
}

std::size_t OpaqueWriter::matched_readers() const noexcept {
  dds_publication_matched_status_t status{};
  if (dds_get_publication_matched_status(entity_.get(), &status) != DDS_RETCODE_OK) return 0;
  return status.current_count;
}

}  // namespace voxtouch::bus
