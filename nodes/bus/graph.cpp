#include "nodes/bus/graph.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {
namespace {

using HumbleInfo = msg::rmw_dds_common_humble_ParticipantEntitiesInfo;
using IronInfo = msg::rmw_dds_common_ParticipantEntitiesInfo;

Guid guid_of(dds_entity_t entity) {
  dds_guid_t dds{};
  dds_get_guid(entity, &dds);
  Guid guid{};
  std::copy(std::begin(dds.v), std::end(dds.v), guid.begin());
  return guid;
}

/// A GUID as a GID; the bytes that Humble has more are 0.
template <class Gid>
Gid to_gid(const Guid& guid) {
  Gid gid{};
  std::copy(guid.begin(), guid.end(), std::begin(gid.data));
  return gid;
}

/// A sequence of a C type over the elements of a vector, which keeps them.
template <class Sequence, class Element>
void lend(Sequence& sequence, std::vector<Element>& elements) {
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(elements.size());
  sequence._buffer = elements.data();
}

template <class Gid>
std::vector<Gid> to_gids(const std::set<Guid>& guids) {
  std::vector<Gid> gids;
  for (const Guid& guid : guids)
    gids.push_back(to_gid<Gid>(guid));
  return gids;
}

}  // namespace

Graph::Graph(dds_entity_t participant, RosNode node)
    : node_(std::move(node)),
      participant_(guid_of(participant)) {
  dds_topic_descriptor_t type =
      *(node_.graph == RosGraph::kHumble ? msg::Type<HumbleInfo>::descriptor
                                         : msg::Type<IronInfo>::descriptor);
  type.m_typename =
      msg::Type<IronInfo>::descriptor->m_typename;  // Humble gives its layout the same name
  topic_ = Entity(dds_create_topic(participant, &type, "ros_discovery_info", nullptr, nullptr),
                  "the ROS graph's topic could not be made");
  const qos::Qos qos =
      qos::make_qos(qos::profile(qos::ProfileId::kLatched), qos::Endpoint::kWriter, 0.0);
  writer_ = Entity(dds_create_writer(participant, topic_.get(), qos.get(), nullptr),
                   "the ROS graph's writer could not be made");
  write();
}

void Graph::add(const Guid& endpoint, qos::Endpoint kind) {
  const std::lock_guard lock(mutex_);
  (kind == qos::Endpoint::kWriter ? writers_ : readers_).insert(endpoint);
  write();
}

void Graph::remove(const Guid& endpoint, qos::Endpoint kind) {
  const std::lock_guard lock(mutex_);
  (kind == qos::Endpoint::kWriter ? writers_ : readers_).erase(endpoint);
  write();
}

void Graph::write() const {
  node_.graph == RosGraph::kHumble ? write_as<HumbleInfo>() : write_as<IronInfo>();
}

template <class Info>
void Graph::write_as() const {
  using Gid = decltype(Info::gid);
  using Node = std::remove_pointer_t<decltype(Info::node_entities_info_seq._buffer)>;
  std::vector<Gid> readers = to_gids<Gid>(readers_), writers = to_gids<Gid>(writers_);
  std::vector<Node> nodes(1);
  std::string name_space = node_.name_space, name = node_.name;  // DDS takes no const text
  nodes[0].node_namespace = name_space.data();
  nodes[0].node_name = name.data();
  lend(nodes[0].reader_gid_seq, readers);
  lend(nodes[0].writer_gid_seq, writers);
  Info info{};
  info.gid = to_gid<Gid>(participant_);
  lend(info.node_entities_info_seq, nodes);
  dds_write(writer_.get(), &info);  // one that fails belongs to a participant that has gone
}

GraphEntry::GraphEntry(std::shared_ptr<Graph> graph, dds_entity_t endpoint, qos::Endpoint kind)
    : graph_(std::move(graph)),
      endpoint_(guid_of(endpoint)),
      kind_(kind) {
  graph_->add(endpoint_, kind_);
}

}  // namespace voxtouch::bus
