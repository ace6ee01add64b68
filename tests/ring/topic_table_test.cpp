// Writers and readers of each topic, as DDS announces them in a running ring, match the table of
// topics.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <map>
#include <set>
#include <thread>

#include "nodes/runtime/node_registry.hpp"
#include "qos/topics.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using Names = std::set<std::string>;

/// The announced endpoints of one kind.
class Announced {
 public:
  Announced(const bus::Participant& participant, dds_entity_t builtin_topic)
      : reader_(dds_create_reader(participant.get(), builtin_topic, nullptr, nullptr),
                "a reader of announcements could not be made") {}

  void poll() {
    void* lent[1] = {nullptr};
    dds_sample_info_t info;
    while (dds_take(reader_.get(), lent, &info, 1, 1) == 1) {
      const auto* endpoint = static_cast<const dds_builtintopic_endpoint_t*>(lent[0]);
      if (info.valid_data) {
        bus::Guid guid;
        std::memcpy(guid.data(), endpoint->participant_key.v, guid.size());
        of_[endpoint->topic_name].insert(guid);
      }
      dds_return_loan(reader_.get(), lent, 1);
    }
  }
  /// Names of the ring's nodes that have an endpoint on `topic`.
  Names nodes(const std::string& topic, const std::map<bus::Guid, std::string>& node_of) const {
    Names names;
    if (const auto found = of_.find(topic); found != of_.end())
      for (const bus::Guid& guid : found->second)
        if (const auto node = node_of.find(guid); node != node_of.end())
          names.insert(node->second);
    return names;
  }

 private:
  bus::Entity reader_;
  std::map<std::string, std::set<bus::Guid>> of_;
};

Names set_of(qos::Nodes nodes) {
  const std::vector<std::string> names = qos::names_of(nodes);
  return {names.begin(), names.end()};
}

TEST(TopicTable, ListsWritersAndReadersOfARunningRing) {
  const TemporaryFolder folder;
  Process up(up_arguments(shipped_scene("plane"),
                          {"--device", "sim-phantom", "--motion", "slide", "--duration", "5",
                           "--record", (folder / "bag").string()}));
  const bus::Participant participant(
      {static_cast<std::uint32_t>(std::stoul(fresh_domain())), "lo", "observer"});
  runtime::NodeRegistry registry(participant, "haptic");
  Announced writers(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION),
      readers(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION);
  std::map<bus::Guid, std::string> node_of;
  int running = 0;
  for (int poll = 0; poll < 100 && up.running() && running < 20;
       ++poll) {  // two seconds after all run
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    registry.update(), writers.poll(), readers.poll();
    for (const runtime::NodeReport& report : registry.reports())
      if (set_of(qos::kEveryNode).contains(report.node))
        node_of[report.participant] = report.node;
    running += node_of.size() == 5;
  }
  ASSERT_EQ(node_of.size(), 5U);
  for (const qos::Topic& topic : qos::kTopics) {
    const std::string name = qos::dds_name(topic, "haptic");
    // This scene follows none outside the ring, and no page leads the hand: there is no end of
    // the rendering, and none of the device.
    const auto here = [&](qos::Nodes nodes) {
      return topic.with_external   ? nodes & ~qos::kRendering
             : topic.with_led_hand ? nodes & ~qos::kDevice
                                   : nodes;
    };
    EXPECT_EQ(writers.nodes(name, node_of),
              topic.lockstep_only || topic.of_arms
                  ? Names()
                  : set_of(static_cast<qos::Nodes>(here(topic.writers))))
        << name;
    EXPECT_EQ(readers.nodes(name, node_of), set_of(static_cast<qos::Nodes>(here(topic.readers))))
        << name;
  }
  EXPECT_EQ(up.wait().status, 0);
}

}  // namespace
}  // namespace voxtouch::test
