#include "nodes/bus/graph.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <vector>

#include "nodes/bus/endpoint.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {
namespace {

using HumbleInfo = msg::rmw_dds_common_humble_ParticipantEntitiesInfo;
using IronInfo = msg::rmw_dds_common_ParticipantEntitiesInfo;

/// Hash of rmw_dds_common/msg/ParticipantEntitiesInfo in ROS 2 since Iron. ROS declares its names
/// as bounded strings (string<=256); here they are unbounded. The serialised bytes are equal but
/// the hash is not, so the ROS value is given here.
constexpr std::string_view kInfoHash =
    "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e";

Guid guid_of(dds_entity_t entity) {
  dds_guid_t dds{};
  dds_get_guid(entity, &dds);
  Guid guid{};
  std::copy(std::begin(dds.v), std::end(dds.v), guid.begin());
  return guid;
}

/// A GUID as a GID; the additional bytes of Humble are 0.
template <class Gid>
Gid to_gid(const Guid& guid) {
  Gid gid{};
  std::copy(guid.begin(), guid.end(), std::begin(gid.data));
  return gid;
}

/// A C sequence that refers to the elements of a vector, which must outlive it.
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
  // Humble uses the same name for its layout.
  type.m_typename = msg::Type<IronInfo>::descriptor->m_typename;
  topic_ = Entity(dds_create_topic(participant, &type, "ros_discovery_info", nullptr, nullptr),
                  "cannot create the ROS graph topic");
  const qos::Qos qos =
      qos::make_qos(qos::profile(qos::ProfileId::kLatched), qos::Endpoint::kWriter, 0.0);
  if (node_.graph != RosGraph::kHumble)
    announce(qos.get(),
             {msg::Type<IronInfo>::ros_name, msg::Type<IronInfo>::descriptor, kInfoHash});
  writer_ = Entity(dds_create_writer(participant, topic_.get(), qos.get(), nullptr),
                   "cannot create the ROS graph writer");
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
  std::string name_space = node_.name_space, name = node_.name;  // DDS requires non-const text
  nodes[0].node_namespace = name_space.data();
  nodes[0].node_name = name.data();
  lend(nodes[0].reader_gid_seq, readers);
  lend(nodes[0].writer_gid_seq, writers);
  Info info{};
  info.gid = to_gid<Gid>(participant_);
  lend(info.node_entities_info_seq, nodes);
  dds_write(writer_.get(), &info);  // a failed write belongs to a participant that has left
}

namespace {

/// Size limit that exceeds every participant of a laboratory. Called in a thread of DDS: allocates
/// nothing.
template <class Info>
bool fits(const void* sample) {
  constexpr std::uint32_t kMaxNodes = 16, kMaxEndpoints = 1024;
  constexpr std::size_t kMaxName = 256;
  const auto too_long = [](const char* text) {
    return !text || ::strnlen(text, kMaxName + 1) > kMaxName;
  };
  const auto& nodes = static_cast<const Info*>(sample)->node_entities_info_seq;
  return nodes._length <= kMaxNodes &&
         std::none_of(nodes._buffer, nodes._buffer + nodes._length, [&](const auto& node) {
           return too_long(node.node_namespace) || too_long(node.node_name) ||
                  node.reader_gid_seq._length > kMaxEndpoints ||
                  node.writer_gid_seq._length > kMaxEndpoints;
         });
}

template <class Info>
std::string names_in(const Info& info) {
  std::string names;
  for (std::uint32_t n = 0; n < info.node_entities_info_seq._length; ++n) {
    const auto& node = info.node_entities_info_seq._buffer[n];
    const std::string space(node.node_namespace);
    names += (names.empty() ? "" : " and ") + (space == "/" ? "" : space) + "/" + node.node_name;
  }
  return names;
}

}  // namespace

void Graph::read_names() {
  const bool humble = node_.graph == RosGraph::kHumble;
  dds_topic_descriptor_t type =
      *(humble ? msg::Type<HumbleInfo>::descriptor : msg::Type<IronInfo>::descriptor);
  type.m_typename = msg::Type<IronInfo>::descriptor->m_typename;
  names_topic_ = Entity(dds_create_topic(dds_get_participant(topic_.get()), &type,
                                         "ros_discovery_info", nullptr, nullptr),
                        "cannot create the ROS graph topic");
  dds_topic_filter filter{};
  filter.mode = DDS_TOPIC_FILTER_SAMPLE;
  filter.f.sample = humble ? fits<HumbleInfo> : fits<IronInfo>;
  if (dds_set_topic_filter_extended(names_topic_.get(), &filter) != DDS_RETCODE_OK)
    throw Error("cannot limit the size of messages of the ROS graph");
  const qos::Qos qos =
      qos::make_qos(qos::profile(qos::ProfileId::kStatus), qos::Endpoint::kReader, 0.0);
  if (!humble)
    announce(qos.get(),
             {msg::Type<IronInfo>::ros_name, msg::Type<IronInfo>::descriptor, kInfoHash});
  names_ = Entity(
      dds_create_reader(dds_get_participant(topic_.get()), names_topic_.get(), qos.get(), nullptr),
      "cannot create the ROS graph reader");
}

void Graph::take_names() {
  const std::lock_guard lock(mutex_);
  if (names_)
    node_.graph == RosGraph::kHumble ? take_names_as<HumbleInfo>() : take_names_as<IronInfo>();
}

template <class Info>
void Graph::take_names_as() {
  constexpr int kMaxTakes = 64;
  void* lent[1] = {nullptr};
  dds_sample_info_t of{};
  for (int n = 0; n < kMaxTakes && dds_take(names_.get(), lent, &of, 1, 1) == 1; ++n) {
    const Info& info = *static_cast<const Info*>(lent[0]);
    Guid participant{};
    std::copy_n(std::begin(info.gid.data), participant.size(), participant.begin());
    // A participant may only name itself.
    if (of.valid_data &&
        participant_of_writer(names_.get(), of.publication_handle) == participant) {
      if (!named_.contains(participant) && named_.size() >= kMaxNames)
        named_.erase(
            std::ranges::min_element(named_, {}, [](const auto& one) { return one.second.order; }));
      named_[participant] = {++taken_, names_in(info)};
    }
    dds_return_loan(names_.get(), lent, 1);
  }
}

std::string Graph::name_of(const Guid& participant) const {
  const std::lock_guard lock(mutex_);
  const auto known = named_.find(participant);
  return known == named_.end() ? std::string() : known->second.name;
}

GraphEntry::GraphEntry(std::shared_ptr<Graph> graph, dds_entity_t endpoint, qos::Endpoint kind)
    : graph_(std::move(graph)),
      endpoint_(guid_of(endpoint)),
      kind_(kind) {
  graph_->add(endpoint_, kind_);
}

}  // namespace voxtouch::bus
