// A process of Fast DDS, set up as rmw_fastrtps does it: which topics of ROS it finds, with their user data, what it gets of the device,
// and the ROS graph as bytes. usage: fast_client DOMAIN default|humble_localhost|jazzy_localhost SECONDS. Prints one JSON object.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

namespace {

using namespace eprosima::fastdds::dds;
using namespace eprosima::fastdds::rtps;
using namespace eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;
using Bytes = std::vector<unsigned char>;

/// Messages of any type as they are on the wire.
class AnyBytes : public TopicDataType {
 public:
  explicit AnyBytes(const char* name) {
    setName(name);
    m_typeSize = 8192;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void*, SerializedPayload_t*) override { return false; }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void*) override {
    return [] { return 0U; };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, InstanceHandle_t*, bool) override { return false; }
};

std::string hex(const unsigned char* bytes, std::size_t size) {
  std::string text;
  for (std::size_t n = 0; n < size; ++n) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", bytes[n]);
    text += two;
  }
  return text;
}

std::string hex(const GUID_t& guid) { return hex(guid.guidPrefix.value, 12) + hex(guid.entityId.value, 4); }

struct Found {
  std::string name, guid, user_data;
  bool writes;
};

class Announcements : public DomainParticipantListener {
 public:
  void on_publisher_discovery(DomainParticipant*, WriterDiscoveryInfo&& info) override {
    add(info.info.topicName().to_string(), info.info.guid(), info.info.m_qos.m_userData.data_vec(), true);
  }
  void on_subscriber_discovery(DomainParticipant*, ReaderDiscoveryInfo&& info) override {
    add(info.info.topicName().to_string(), info.info.guid(), info.info.m_qos.m_userData.data_vec(), false);
  }
  void on_participant_discovery(DomainParticipant*, ParticipantDiscoveryInfo&& info) override {
    const std::lock_guard lock(mutex);
    const auto& data = info.info.m_userData.data_vec();
    participants[hex(info.info.m_guid)] = std::string(data.begin(), data.end());
  }
  std::mutex mutex;
  std::vector<Found> endpoints;
  std::map<std::string, std::string> participants;

 private:
  void add(const std::string& name, const GUID_t& guid, const std::vector<octet>& data, bool writes) {
    const std::lock_guard lock(mutex);
    endpoints.push_back({name, hex(guid), std::string(data.begin(), data.end()), writes});
  }
};

/// What rmw_fastrtps sets for ROS_LOCALHOST_ONLY=1 in Humble, and for the range LOCALHOST from Iron on.
DomainParticipantQos set_up(const std::string& how) {
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  if (how == "humble_localhost") {
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
  } else if (how == "jazzy_localhost") {
    auto& builtin = qos.wire_protocol().builtin;
    builtin.metatrafficMulticastLocatorList.clear();
    builtin.metatrafficUnicastLocatorList.push_back(Locator_t());
    Locator_t peer;
    IPLocator::setIPv4(peer, "127.0.0.1");
    builtin.initialPeersList.push_back(peer);
    udp->maxInitialPeersRange = 32;
    qos.transport().user_transports.push_back(std::make_shared<SharedMemTransportDescriptor>());
  } else {
    return qos;
  }
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  return qos;
}

DataReader* reader_on(DomainParticipant* participant, Subscriber* subscriber, const char* name, const char* type, bool latched) {
  TypeSupport support(new AnyBytes(type));
  support.register_type(participant);
  DataReaderQos qos = DATAREADER_QOS_DEFAULT;
  qos.reliability().kind = latched ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = latched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().depth = 200;
  qos.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  return subscriber->create_datareader(participant->create_topic(name, type, TOPIC_QOS_DEFAULT), qos);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  Announcements announcements;
  DomainParticipant* participant = DomainParticipantFactory::get_instance()->create_participant(
      static_cast<DomainId_t>(std::stoul(argv[1])), set_up(argv[2]), &announcements, StatusMask::none());
  if (!participant) return 1;
  Subscriber* subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  DataReader* states = reader_on(participant, subscriber, "rt/haptic/device/state", "voxtouch_msgs::msg::dds_::DeviceState_", false);
  DataReader* graph = reader_on(participant, subscriber, "ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_", true);
  const auto begin = std::chrono::steady_clock::now();
  const auto now_s = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  std::size_t samples = 0;
  double first_s = -1.0;
  std::set<std::string> graphs;
  Bytes bytes;
  SampleInfo info;
  while (now_s() < std::stod(argv[3])) {
    while (states->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data && samples++ == 0) first_s = now_s();
    while (graph->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) graphs.insert(hex(bytes.data(), bytes.size()));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const std::lock_guard lock(announcements.mutex);
  std::printf("{\"samples\": %zu, \"first_s\": %f, \"endpoints\": [", samples, first_s);
  const char* comma = "";
  for (const Found& e : announcements.endpoints) {
    std::printf("%s[\"%s\", \"%s\", \"%s\", %s]", comma, e.name.c_str(), e.guid.c_str(), e.user_data.c_str(), e.writes ? "true" : "false");
    comma = ", ";
  }
  std::printf("], \"participants\": {");
  comma = "";
  for (const auto& [guid, data] : announcements.participants) std::printf("%s\"%s\": \"%s\"", comma, guid.c_str(), data.c_str()), comma = ", ";
  std::printf("}, \"graph\": [");
  comma = "";
  for (const std::string& one : graphs) std::printf("%s\"%s\"", comma, one.c_str()), comma = ", ";
  std::printf("]}\n");
  std::fflush(stdout);
  _exit(0);  // what Fast DDS takes down is no part of this
}
