// A process of Debian's Cyclone DDS with the settings that it is given: which topics of ROS it finds, and what it gets of the device.
// usage: cyclone_client DOMAIN SETTINGS SECONDS; settings may be empty. Prints one JSON object.
#include <chrono>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "nodes/bus/entity.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace {

using voxtouch::bus::Entity;
using Seconds = std::chrono::duration<double>;

/// Calls f(const T&) for each sample that waits.
template <class T, class F>
void take(dds_entity_t reader, F&& f) {
  void* lent[1] = {nullptr};
  dds_sample_info_t info;
  while (dds_take(reader, lent, &info, 1, 1) == 1) {
    if (info.valid_data) f(*static_cast<const T*>(lent[0]));
    dds_return_loan(reader, lent, 1);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  using State = voxtouch::msg::DeviceState;
  const auto domain = static_cast<dds_domainid_t>(std::stoul(argv[1]));
  Entity configured;
  if (argv[2][0] != '\0') configured = Entity(dds_create_domain(domain, argv[2]), "no domain");
  const Entity participant(dds_create_participant(domain, nullptr, nullptr), "no participant");
  const Entity writers(dds_create_reader(participant.get(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr), "no announcements");
  const Entity topic(dds_create_topic(participant.get(), voxtouch::msg::Type<State>::descriptor, "rt/haptic/device/state", nullptr, nullptr), "no topic");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 100);
  const Entity reader(dds_create_reader(participant.get(), topic.get(), qos, nullptr), "no reader");
  dds_delete_qos(qos);

  const auto begin = std::chrono::steady_clock::now();
  const auto now_s = [&] { return Seconds(std::chrono::steady_clock::now() - begin).count(); };
  std::map<std::string, double> topics;  // and when each was found
  std::size_t samples = 0;
  double first_s = -1.0;
  while (now_s() < std::stod(argv[3])) {
    take<dds_builtintopic_endpoint_t>(writers.get(), [&](const auto& writer) {
      if (std::string_view(writer.topic_name).starts_with("rt/")) topics.try_emplace(writer.topic_name, now_s());
    });
    take<State>(reader.get(), [&](const State&) {
      if (samples++ == 0) first_s = now_s();
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::vector<std::string> found;
  for (const auto& [name, when_s] : topics) found.push_back(fmt::format(R"("{}": {})", name, when_s));
  fmt::print(R"({{"topics": {{{}}}, "samples": {}, "first_s": {}}})" "\n", fmt::join(found, ", "), samples, first_s);
  return 0;
}
