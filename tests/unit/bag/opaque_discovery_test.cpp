#include "nodes/bus/opaque_discovery.hpp"

#include <map>

#include "nodes/bag/names.hpp"
#include "plain.h"
#include "tests/unit/bag/dds_support.hpp"
#include "typed.h"

namespace voxtouch::bus {
namespace {

using namespace bag::test;

class DiscoveryTest : public testing::TestWithParam<bool> {
 protected:
  TwoHosts hosts_;
  // The newest state of each writer by topic; a writer that has gone is known by its GUID only.
  std::map<Guid, DiscoveredWriter> known_;
  bool update(WriterDiscovery& discovery, const std::function<bool()>& enough) {
    return eventually([&] {
      EXPECT_GOOD(discovery.take([&](const DiscoveredWriter& writer) { known_[writer.guid] = writer; }));
      return enough();
    });
  }
  const DiscoveredWriter* find(const std::string& topic) const {
    for (const auto& [guid, writer] : known_)
      if (writer.topic == topic) return &writer;
    return nullptr;
  }
};

TEST_P(DiscoveryTest, ReportsNameTypeQosAndEndOfEachWriter) {
  const dds_entity_t looking = GetParam() ? hosts_.there() : hosts_.here();
  auto discovery = expect_value(WriterDiscovery::create(looking));
  const std::string typed = topic_name("typed"), raw = topic_name("raw");
  const dds_entity_t typed_writer =
      typed_endpoint(true, hosts_.here(), bag_test_msg_dds__Typed__desc, typed, true);
  const auto topic = expect_value(OpaqueTopic::create(hosts_.here(), raw, "bag_test::msg::dds_::Plain_"));
  const EndpointQos offered{.deadline_ns = 3'000'000, .lifespan_ns = 5'000'000'000,
                            .liveliness = Liveliness::kManualByTopic,
                            .lease_ns = 100'000'000};
  auto raw_writer = std::optional(expect_value(OpaqueWriter::create(topic, offered)));
  ASSERT_TRUE(update(discovery, [&] { return find(typed) != nullptr && find(raw) != nullptr; }));

  const DiscoveredWriter first = *find(typed);
  EXPECT_TRUE(first.alive);
  EXPECT_FALSE(first.keyed);
  EXPECT_EQ(first.has_type_information, GetParam());  // Cyclone DDS tells it of remote writers only
  EXPECT_EQ(bag::ros_type_name(first.type_name), "bag_test/msg/Typed");
  EXPECT_EQ(first.qos.reliability, Reliability::kReliable);
  EXPECT_EQ(first.qos.durability, Durability::kTransientLocal);
  EXPECT_EQ(first.qos.history, History::kKeepLast);
  EXPECT_EQ(first.qos.depth, 1);
  EXPECT_EQ(first.qos.deadline_ns, kInfiniteNs);

  const DiscoveredWriter second = *find(raw);
  EXPECT_FALSE(second.has_type_information);
  EXPECT_EQ(second.qos.reliability, Reliability::kBestEffort);
  EXPECT_EQ(second.qos.deadline_ns, offered.deadline_ns);
  EXPECT_EQ(second.qos.lifespan_ns, offered.lifespan_ns);
  EXPECT_EQ(second.qos.liveliness, offered.liveliness);
  EXPECT_EQ(second.qos.lease_ns, offered.lease_ns);
  EXPECT_EQ(second.participant, first.participant);
  dds_guid_t participant{};
  dds_get_guid(hosts_.here(), &participant);
  EXPECT_TRUE(std::equal(first.participant.begin(), first.participant.end(), participant.v));

  raw_writer.reset();
  dds_delete(typed_writer);
  EXPECT_TRUE(update(discovery, [&] { return !known_[first.guid].alive && !known_[second.guid].alive; }));
}

// A writer with a deadline, a lease and reliability: what recorder_qos asks for must match it, and best
// effort without anything.
TEST_P(DiscoveryTest, WhatARecorderAsksForMatchesWhatIsOffered) {
  const dds_entity_t reading = GetParam() ? hosts_.there() : hosts_.here();
  const std::string type = "bag_test::msg::dds_::Plain_";
  for (const EndpointQos& offered : {EndpointQos{.deadline_ns = 3'000'000},
                                     EndpointQos{.reliability = Reliability::kReliable,
                                                 .durability = Durability::kTransientLocal},
                                     EndpointQos{.reliability = Reliability::kReliable,
                                                 .history = History::kKeepAll,
                                                 .liveliness = Liveliness::kManualByTopic,
                                                     .lease_ns = 100'000'000}}) {
    const std::string name = topic_name("offered");
    const auto write_topic = expect_value(OpaqueTopic::create(hosts_.here(), name, type));
    const auto read_topic = expect_value(OpaqueTopic::create(reading, name, type));
    const auto writer = expect_value(OpaqueWriter::create(write_topic, offered));
    const auto reader = expect_value(OpaqueReader::create(read_topic, recorder_qos(offered)));
    const auto tap = expect_value(OpaqueReader::create(read_topic, {}));
    EXPECT_TRUE(eventually([&] { return reader.matched_writers() == 1 && tap.matched_writers() == 1; }));
  }
}

INSTANTIATE_TEST_SUITE_P(Sides, DiscoveryTest, testing::Values(false, true),
                         [](const auto& side) { return side.param ? "OverTheWire" : "InOneParticipant"; });

}  // namespace
}  // namespace voxtouch::bus
