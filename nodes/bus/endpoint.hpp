#pragma once
/// Common parts of typed writers and readers: topic, QoS from the table, matched participants.
#include <string>
#include <string_view>
#include <vector>

#include "nodes/bus/following.hpp"
#include "nodes/bus/participant.hpp"
#include "qos/topics.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {

/// Adds the type hash to the user data of an endpoint, as ROS 2 does since Iron.
void announce(dds_qos_t* qos, const msg::AnyType& type);

/// Topic entity, endpoint entity and the endpoint's entry in the graph of ROS 2 tools. Throws Error
/// if the type of the row is not `type`.
struct EndpointEntities {
  Entity topic, endpoint;
  GraphEntry entry;
};
/// Creates a writer or reader of the row's topic with the policies of the profile, and enters it in
/// the ROS graph. Both throw Error.
EndpointEntities make_writer(const Participant& participant, const qos::Topic& row,
                             std::string_view rig, const qos::Profile& profile,
                             const msg::AnyType& type);
/// `following` (optional) is the sample filter of the reader, which it must outlive.
EndpointEntities make_reader(const Participant& participant, const qos::Topic& row,
                             std::string_view rig, const qos::Profile& profile,
                             const msg::AnyType& type, Following* following = nullptr);

/// Participants whose readers (writers) this writer (reader) has matched. Not for the loop.
std::vector<Guid> matched_readers(dds_entity_t writer);
std::vector<Guid> matched_writers(dds_entity_t reader);
std::vector<dds_instance_handle_t> matched_writer_handles(dds_entity_t reader);
std::vector<dds_instance_handle_t> matched_reader_handles(dds_entity_t writer);
/// The participant of the writer with instance handle `writer`, as matched by this reader; all zero
/// if it has left.
Guid participant_of_writer(dds_entity_t reader, dds_instance_handle_t writer);
/// Whether that writer is currently matched with the reader.
bool writer_is_matched(dds_entity_t reader, dds_instance_handle_t writer);

}  // namespace voxtouch::bus
