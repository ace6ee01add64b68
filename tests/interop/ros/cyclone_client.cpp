// A process of Debian's Cyclone DDS with given settings: the ROS topics that it discovers, the
// samples that it receives from the ring, and the time of replies to effect changes. usage:
// cyclone_client DOMAIN SETTINGS SECONDS [CHANGES]; settings may be empty. Prints one JSON object.
#include <array>
#include <chrono>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "nodes/bus/entity.hpp"
#include "tests/support/service_client.hpp"

namespace {

using namespace voxtouch;
using bus::Entity;
using Seconds = std::chrono::duration<double>;
using std::chrono::steady_clock;

double since(steady_clock::time_point begin) {
  return Seconds(steady_clock::now() - begin).count();
}
void sleep(double seconds) { std::this_thread::sleep_for(Seconds(seconds)); }

/// Calls f(const T&) for each sample that waits.
template <class T, class F>
void take(dds_entity_t reader, F&& f) {
  void* lent[1] = {nullptr};
  dds_sample_info_t info;
  while (dds_take(reader, lent, &info, 1, 1) == 1) {
    if (info.valid_data)
      f(*static_cast<const T*>(lent[0]));
    dds_return_loan(reader, lent, 1);
  }
}

enum class Kind { kBestEffort, kReliable, kLatched };

dds_qos_t* qos_of(Kind kind) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(
      qos, kind == Kind::kBestEffort ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
      DDS_MSECS(100));
  dds_qset_durability(
      qos, kind == Kind::kLatched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1000);  // a second of the loop
  return qos;
}

class Read {
 public:
  Read(const Entity& participant, const char* name, const dds_topic_descriptor_t* type, Kind kind)
      : name_(name),
        topic_(dds_create_topic(participant.get(), type, name, nullptr, nullptr), "no topic") {
    dds_qos_t* qos = qos_of(kind);
    reader_ = Entity(dds_create_reader(participant.get(), topic_.get(), qos, nullptr), "no reader");
    dds_delete_qos(qos);
  }
  const std::string& name() const { return name_; }
  dds_entity_t reader() const { return reader_.get(); }

 private:
  std::string name_;
  Entity topic_, reader_;
};

/// One of the loop's topics: received samples, numbered by the device.
template <class T>
struct Stream : Read {
  Stream(const Entity& participant, const char* name)
      : Read(participant, name, msg::Type<T>::descriptor, Kind::kBestEffort) {}
  void poll(double now_s) {
    take<T>(reader(), [&](const T& sample) {
      if (received++ == 0)
        first = sample.sequence_number, first_s = now_s;
      last = sample.sequence_number;
    });
  }
  std::string json() const {
    return fmt::format(R"("{}": [{}, {}])", name(), received,
                       received ? last - first + 1 - received : 0);
  }
  std::uint64_t received = 0, first = 0, last = 0;
  double first_s = -1.0;
};

struct Counted : Read {
  using Read::Read;
  void poll() {
    take<std::byte>(reader(), [&](const std::byte&) { ++received; });
  }
  std::size_t received = 0;
};

/// Milliseconds until each change was confirmed as done. A shorter list means missing replies.
std::vector<double> ask_for_changes(const Entity& participant, int count) {
  using std::chrono::seconds;
  test::ServiceClient<msg::ChangeEffect> client(participant.get(), qos::kChangeEffect, "haptic",
                                                "rendering");
  std::vector<double> took_ms;
  if (!client.finds_server(seconds(10)))
    return took_ms;
  for (int n = 0; n < count; ++n) {
    char effect[] = "friction", none[] = "";
    msg::ChangeEffect::Request request{};
    request.action = msg::effect_change::kActionGain;
    request.effect = effect, request.parameter = request.model = none;
    request.value[0] = n % 2 ? 1.0 : 0.5;
    bool is_done = false;
    const auto begin = steady_clock::now();
    if (client.call(request, seconds(5), [&](const auto& response) { is_done = response.done; }) &&
        is_done)
      took_ms.push_back(1e3 * since(begin));
    sleep(0.01);
  }
  return took_ms;
}

template <class T>
constexpr const dds_topic_descriptor_t* kType = msg::Type<T>::descriptor;

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5)
    return 2;
  const auto domain = static_cast<dds_domainid_t>(std::stoul(argv[1]));
  Entity configured;
  if (argv[2][0] != '\0')
    configured = Entity(dds_create_domain(domain, argv[2]), "no domain");
  const Entity participant(dds_create_participant(domain, nullptr, nullptr), "no participant");
  const Entity writers(
      dds_create_reader(participant.get(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
      "no announcements");
  Stream<msg::DeviceState> states(participant, "rt/haptic/device/state");
  Stream<msg::ContactState> contacts(participant, "rt/haptic/rendering/contact");
  Stream<msg::ForceCommand> commands(participant, "rt/haptic/coupling/command");
  std::array<Counted, 8> standard = {
      {{participant, "rt/tf", kType<msg::tf2_msgs_TFMessage>, Kind::kReliable},
       {participant, "rt/tf_static", kType<msg::tf2_msgs_TFMessage>, Kind::kLatched},
       {participant, "rt/haptic/pose", kType<msg::geometry_msgs_PoseStamped>, Kind::kReliable},
       {participant, "rt/haptic/wrench", kType<msg::geometry_msgs_WrenchStamped>, Kind::kReliable},
       {participant, "rt/haptic/markers", kType<msg::visualization_msgs_MarkerArray>,
        Kind::kReliable},
       {participant, "rt/diagnostics", kType<msg::diagnostic_msgs_DiagnosticArray>,
        Kind::kReliable},
       {participant, "rt/parameter_events", kType<msg::rcl_interfaces_ParameterEvent>,
        Kind::kReliable},
       {participant, "rt/rosout", kType<msg::rcl_interfaces_Log>, Kind::kLatched}}};

  const auto begin = steady_clock::now();
  std::map<std::string, double> topics;  // and when each was found
  const auto poll = [&] {
    for (Counted& one : standard)
      one.poll();
    take<dds_builtintopic_endpoint_t>(writers.get(), [&](const auto& writer) {
      if (std::string_view(writer.topic_name).starts_with("rt/"))
        topics.try_emplace(writer.topic_name, since(begin));
    });
  };
  for (; since(begin) < std::stod(argv[3]); sleep(0.005)) {
    const double now_s = since(begin);
    states.poll(now_s), contacts.poll(now_s), commands.poll(now_s);
    poll();
  }
  std::vector<double> answers_ms;
  if (argc == 5)
    answers_ms = ask_for_changes(participant, std::stoi(argv[4]));
  poll();
  std::vector<std::string> found, counted;
  for (const auto& [name, when_s] : topics)
    found.push_back(fmt::format(R"("{}": {})", name, when_s));
  for (const Counted& one : standard)
    counted.push_back(fmt::format(R"("{}": {})", one.name(), one.received));
  fmt::print(
      R"({{"topics": {{{}}}, "samples": {}, "first_s": {}, "streams": {{{}, {}, {}}}, "standard": {{{}}}, "answers_ms": [{:.3f}]}})"
      "\n",
      fmt::join(found, ", "), states.received, states.first_s, states.json(), contacts.json(),
      commands.json(), fmt::join(counted, ", "), fmt::join(answers_ms, ", "));
  return 0;
}
