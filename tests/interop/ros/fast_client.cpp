// A process of Fast DDS, configured as rmw_fastrtps does: the ROS topics that it discovers, with
// their user data, the samples that it receives from the ring, the ROS graph as bytes, and the time
// of replies to effect changes. Changes use the topic, since the two RMWs differ in the wire form
// of services. usage: fast_client DOMAIN default|humble_localhost|jazzy_localhost SECONDS
// [CHANGES]. Prints one JSON object.
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

namespace {

using namespace eprosima::fastdds::dds;
using namespace eprosima::fastdds::rtps;
using namespace eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;
using Bytes = std::vector<unsigned char>;

/// Messages of any type as serialised bytes.
class AnyBytes : public TopicDataType {
 public:
  explicit AnyBytes(const char* name) {
    setName(name);
    m_typeSize = 8192;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    if (bytes.size() > payload->max_size)
      return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<uint32_t>(static_cast<Bytes*>(data)->size()); };
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

std::string hex(const GUID_t& guid) {
  return hex(guid.guidPrefix.value, 12) + hex(guid.entityId.value, 4);
}

struct Found {
  std::string name, guid, user_data;
  bool writes;
};

class Announcements : public DomainParticipantListener {
 public:
  void on_publisher_discovery(DomainParticipant*, WriterDiscoveryInfo&& info) override {
    add(info.info.topicName().to_string(), info.info.guid(), info.info.m_qos.m_userData.data_vec(),
        true);
  }
  void on_subscriber_discovery(DomainParticipant*, ReaderDiscoveryInfo&& info) override {
    add(info.info.topicName().to_string(), info.info.guid(), info.info.m_qos.m_userData.data_vec(),
        false);
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
  void add(const std::string& name, const GUID_t& guid, const std::vector<octet>& data,
           bool writes) {
    const std::lock_guard lock(mutex);
    endpoints.push_back({name, hex(guid), std::string(data.begin(), data.end()), writes});
  }
};

/// Settings of rmw_fastrtps for ROS_LOCALHOST_ONLY=1 in Humble, and for the range LOCALHOST from
/// Iron on.
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

enum class Kind { kBestEffort, kReliable, kLatched };

/// A DataReaderQos or a DataWriterQos.
template <class Qos>
Qos qos_of(Qos qos, Kind kind) {
  qos.reliability().kind =
      kind == Kind::kBestEffort ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
  qos.durability().kind =
      kind == Kind::kLatched ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  qos.history().depth = qos.resource_limits().max_samples_per_instance =
      1000;  // a second of the loop
  qos.endpoint().history_memory_policy = PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  return qos;
}

Topic* topic_of(DomainParticipant* participant, const char* name, const char* type) {
  TypeSupport support(new AnyBytes(type));
  support.register_type(participant);
  return participant->create_topic(name, type, TOPIC_QOS_DEFAULT);
}

class Read {
 public:
  Read(DomainParticipant* participant, Subscriber* subscriber, const char* topic, const char* type,
       Kind kind)
      : name(topic),
        reader_(subscriber->create_datareader(topic_of(participant, topic, type),
                                              qos_of(DATAREADER_QOS_DEFAULT, kind))) {}
  /// Calls f(const Bytes&) for each sample that waits.
  template <class F>
  void take(F&& f) {
    SampleInfo info;
    while (reader_->take_next_sample(&bytes_, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data)
        ++received, f(static_cast<const Bytes&>(bytes_));
  }
  bool is_matched() const {
    return reader_->get_subscription_matched_status(matched_), matched_.current_count > 0;
  }

  const char* name;
  std::size_t received = 0;

 private:
  DataReader* reader_;
  Bytes bytes_;
  mutable SubscriptionMatchedStatus matched_;
};

template <class T>
T number_at(const Bytes& bytes, std::size_t place) {
  T value{};
  if (bytes.size() >= place + sizeof value)
    std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

/// One of the loop's topics: received samples, with the device's number after the session's.
struct Stream : Read {
  using Read::Read;
  void poll(double now_s) {
    take([&](const Bytes& bytes) {
      last = number_at<std::uint64_t>(bytes, 4 + 8);
      if (received == 1)
        first = last, first_s = now_s;
    });
  }
  std::uint64_t first = 0, last = 0;
  double first_s = -1.0;
};

/// An EffectChange of `friction`'s gain, as CDR.
Bytes change(std::uint64_t request, double gain) {
  Bytes bytes = {0, 1, 0, 0};
  const auto add = [&](const auto& value) {
    while ((bytes.size() - 4) % sizeof value)
      bytes.push_back(0);
    const auto* first = reinterpret_cast<const unsigned char*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof value);
  };
  const auto add_text = [&](const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    bytes.insert(bytes.end(), text.c_str(), text.c_str() + text.size() + 1);
  };
  add(request), add(std::uint64_t{0}), add(std::uint64_t{0}), add(std::uint32_t{2});
  add_text("friction"), add_text("");
  for (const double value : {gain, 0.0, 0.0, 0.0})
    add(value);  // the last one: a voxel's size
  add_text("");
  return bytes;
}

/// Milliseconds until each change was confirmed as done. A shorter list means missing replies.
std::vector<double> ask_for_changes(DomainParticipant* participant, Subscriber* subscriber,
                                    int count) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  Read answers(participant, subscriber, "rt/haptic/rendering/changed",
               "voxtouch_msgs::msg::dds_::EffectChanged_", Kind::kLatched);
  DataWriter* writer = participant->create_publisher(PUBLISHER_QOS_DEFAULT)
                           ->create_datawriter(topic_of(participant, "rt/haptic/rendering/change",
                                                        "voxtouch_msgs::msg::dds_::EffectChange_"),
                                               qos_of(DATAWRITER_QOS_DEFAULT, Kind::kReliable));
  PublicationMatchedStatus matched;
  const auto is_matched = [&] {
    return writer->get_publication_matched_status(matched),
           matched.current_count > 0 && answers.is_matched();
  };
  for (const auto begin = Clock::now(); !is_matched() && since(begin) < 10.0;)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(
      std::chrono::milliseconds(500));  // the rendering must discover it too
  std::vector<double> took_ms;
  constexpr std::uint32_t kDone = 2;
  for (int n = 1; n <= count; ++n) {
    const std::uint64_t request = 0xFA57000000000000U + static_cast<std::uint64_t>(n);
    Bytes bytes = change(request, n % 2 ? 0.5 : 1.0);
    const auto begin = Clock::now();
    writer->write(&bytes);
    bool is_done = false;
    while (!is_done && since(begin) < 5.0) {
      answers.take([&](const Bytes& answer) {
        is_done = is_done || (number_at<std::uint64_t>(answer, 4) == request &&
                              number_at<std::uint32_t>(answer, 4 + 24) == kDone);
      });
      if (!is_done)
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    if (is_done)
      took_ms.push_back(1e3 * since(begin));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return took_ms;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5)
    return 2;
  Announcements announcements;
  DomainParticipant* participant = DomainParticipantFactory::get_instance()->create_participant(
      static_cast<DomainId_t>(std::stoul(argv[1])), set_up(argv[2]), &announcements,
      StatusMask::none());
  if (!participant)
    return 1;
  Subscriber* subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  const auto read = [&](const char* name, const char* type, Kind kind) {
    return Read(participant, subscriber, name, type, kind);
  };
  const auto stream = [&](const char* name, const char* type) {
    return Stream(participant, subscriber, name, type, Kind::kBestEffort);
  };
  std::array streams = {
      stream("rt/haptic/device/state", "voxtouch_msgs::msg::dds_::DeviceState_"),
      stream("rt/haptic/rendering/contact", "voxtouch_msgs::msg::dds_::ContactState_"),
      stream("rt/haptic/coupling/command", "voxtouch_msgs::msg::dds_::ForceCommand_")};
  std::array standard = {
      read("rt/tf", "tf2_msgs::msg::dds_::TFMessage_", Kind::kReliable),
      read("rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", Kind::kLatched),
      read("rt/haptic/pose", "geometry_msgs::msg::dds_::PoseStamped_", Kind::kReliable),
      read("rt/haptic/wrench", "geometry_msgs::msg::dds_::WrenchStamped_", Kind::kReliable),
      read("rt/haptic/markers", "visualization_msgs::msg::dds_::MarkerArray_", Kind::kReliable),
      read("rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_", Kind::kReliable),
      read("rt/parameter_events", "rcl_interfaces::msg::dds_::ParameterEvent_", Kind::kReliable),
      read("rt/rosout", "rcl_interfaces::msg::dds_::Log_", Kind::kLatched)};
  Read graph = read("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_",
                    Kind::kLatched);
  const auto begin = std::chrono::steady_clock::now();
  const auto now_s = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  std::set<std::string> graphs;
  const auto poll = [&] {
    for (Read& one : standard)
      one.take([](const Bytes&) {});
    graph.take([&](const Bytes& bytes) { graphs.insert(hex(bytes.data(), bytes.size())); });
  };
  for (; now_s() < std::stod(argv[3]); std::this_thread::sleep_for(std::chrono::milliseconds(5))) {
    for (Stream& one : streams)
      one.poll(now_s());
    poll();
  }
  std::vector<double> answers_ms;
  if (argc == 5)
    answers_ms = ask_for_changes(participant, subscriber, std::stoi(argv[4]));
  poll();
  const std::lock_guard lock(announcements.mutex);
  std::printf("{\"samples\": %zu, \"first_s\": %f, \"endpoints\": [", streams[0].received,
              streams[0].first_s);
  const char* comma = "";
  for (const Found& e : announcements.endpoints) {
    std::printf("%s[\"%s\", \"%s\", \"%s\", %s]", comma, e.name.c_str(), e.guid.c_str(),
                e.user_data.c_str(), e.writes ? "true" : "false");
    comma = ", ";
  }
  std::printf("], \"participants\": {");
  comma = "";
  for (const auto& [guid, data] : announcements.participants)
    std::printf("%s\"%s\": \"%s\"", comma, guid.c_str(), data.c_str()), comma = ", ";
  std::printf("}, \"graph\": [");
  comma = "";
  for (const std::string& one : graphs)
    std::printf("%s\"%s\"", comma, one.c_str()), comma = ", ";
  std::printf("], \"streams\": {");
  comma = "";
  for (const Stream& one : streams)
    std::printf("%s\"%s\": [%zu, %zu]", comma, one.name, one.received,
                one.received ? one.last - one.first + 1 - one.received : 0),
        comma = ", ";
  std::printf("}, \"standard\": {");
  comma = "";
  for (const Read& one : standard)
    std::printf("%s\"%s\": %zu", comma, one.name, one.received), comma = ", ";
  std::printf("}, \"answers_ms\": [");
  comma = "";
  for (const double one : answers_ms)
    std::printf("%s%.3f", comma, one), comma = ", ";
  std::printf("]}\n");
  std::fflush(stdout);
  _exit(0);  // skips the destructors of Fast DDS
}
