#pragma once
/// What a typed writer and a typed reader share: topic, QoS by table, and who has matched them.
#include <string>
#include <string_view>
#include <vector>

#include "nodes/bus/following.hpp"
#include "nodes/bus/participant.hpp"
#include "qos/topics.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {

/// The type's hash as user data of an endpoint, as ROS 2 announces it from Iron on.
void announce(dds_qos_t* qos, const msg::AnyType& type);

/// Topic entity plus endpoint entity, and the endpoint's entry in the graph that ROS 2 tools show.
/// Throws Error where the row's type is not `type`.
struct EndpointEntities {
  Entity topic, endpoint;
  GraphEntry entry;
};
/// A writer or reader of the row's topic with the profile's policies, announced to ROS tools by its
/// entry in the graph. Throw Error.
EndpointEntities make_writer(const Participant& participant, const qos::Topic& row,
                             std::string_view rig, const qos::Profile& profile,
                             const msg::AnyType& type);
/// `following` (if given) is asked about each sample before it is stored; it must outlive the
/// reader.
EndpointEntities make_reader(const Participant& participant, const qos::Topic& row,
                             std::string_view rig, const qos::Profile& profile,
                             const msg::AnyType& type, Following* following = nullptr);

/// Participants whose readers (writers) this writer (reader) has matched. Not for the loop.
std::vector<Guid> matched_readers(dds_entity_t writer);
std::vector<Guid> matched_writers(dds_entity_t reader);
std::vector<dds_instance_handle_t> matched_writer_handles(dds_entity_t reader);
std::vector<dds_instance_handle_t> matched_reader_handles(dds_entity_t writer);
/// The participant of the writer with instance handle `writer`, as this reader has matched it; all
/// zero if it has gone.
Guid participant_of_writer(dds_entity_t reader, dds_instance_handle_t writer);
/// Whether that writer is matched with the reader now.
bool writer_is_matched(dds_entity_t reader, dds_instance_handle_t writer);

}  // namespace voxtouch::bus
