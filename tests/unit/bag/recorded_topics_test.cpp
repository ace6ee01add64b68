#include "nodes/logger/recorded_topics.hpp"

#include "foreign.h"
#include "nodes/bag/bag_writer.hpp"
#include "nodes/logger/recording_qos.hpp"
#include "tests/support/facts.hpp"
#include "tests/support/whole_bag.hpp"
#include "tests/unit/bag/dds_support.hpp"

namespace voxtouch::logger {
namespace {

using namespace bag::test;

TEST(OfferedQos, EqualsTheTextOfHumble) {
  const qos::Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, 0);
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 7);
  dds_qset_deadline(qos.get(), 3'000'000);
  EXPECT_EQ(offered_qos_text(qos.get()),
            "- history: 1\n  depth: 7\n  reliability: 1\n  durability: 1\n"
            "  deadline:\n    sec: 0\n    nsec: 3000000\n"
            "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n"
            "  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
            "  avoid_ros_namespace_conventions: false");
}

TEST(OfferedQos, HoldsTheOtherPolicies) {
  const qos::Qos qos(dds_create_qos());
  EXPECT_TRUE(offered_qos_text(qos.get()).starts_with(
      "- history: 1\n  depth: 1\n  reliability: 2\n  durability: 2\n"))
      << "what is not announced is the default";
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
  dds_qset_liveliness(qos.get(), DDS_LIVELINESS_MANUAL_BY_TOPIC, 100'000'000);
  dds_qset_lifespan(qos.get(), 5'000'000'000);
  const std::string text = offered_qos_text(qos.get());
  EXPECT_TRUE(text.starts_with("- history: 2\n  depth: 0\n")) << text;
  EXPECT_NE(text.find("lifespan:\n    sec: 5\n    nsec: 0\n  liveliness: 3\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("lease_duration:\n    sec: 0\n    nsec: 100000000\n"), std::string::npos)
      << text;
}

/// A recording with a queue of 1 MB, and writers of single topics.
class Recording : public testing::Test {
 protected:
  Recording() { options_.rig = "recording_test"; }
  dds_entity_t writer(const char* name, const dds_topic_descriptor_t& type =
                                            *msg::Type<msg::std_msgs_Header>::descriptor) const {
    return make_writer(participant_.get(), type, name, latched_.get());
  }
  static void write(dds_entity_t writer, std::string text) {
    const msg::std_msgs_Header header{{1, 2}, text.data()};
    EXPECT_EQ(dds_write(writer, &header), DDS_RETCODE_OK);
  }

  const TemporaryFolder folder_;
  runtime::NodeOptions options_;
  const bus::Participant participant_{
      {static_cast<std::uint32_t>(std::stoul(voxtouch::test::fresh_domain())), "lo", "recorder"}};
  const qos::Qos latched_ =
      qos::make_qos(qos::profile(qos::ProfileId::kLatched), qos::Endpoint::kWriter, 0.0);
  bus::WaitSet wait_set_{participant_};
  bag::BagRecorder recorder_{
      std::make_unique<bag::BagWriter>(expect_value(bag::BagWriter::create(folder_ / "bag"))),
      {.queue_bytes = 1 << 20}};
};

TEST_F(Recording, TakesKnownTypesAndRefusesOthersOnce) {
  RecordedTopics topics(participant_, options_, {"rt/other/*"}, recorder_, wait_set_);
  const std::size_t of_the_ring = recorder_.report().topics.size();
  write(writer("rt/other/header"), "wanted"), write(writer("rt/unwanted"), "not");
  writer("rt/other/thing", foreign_msg_dds__Thing__desc),
      writer("rt/other/thing", foreign_msg_dds__Thing__desc);
  std::vector<std::string> sentences;
  std::size_t messages = 0;
  ASSERT_TRUE(eventually([&] {
    for (std::string& sentence : topics.discover())
      sentences.push_back(std::move(sentence));
    messages += topics.drain();
    return messages > 0 && !sentences.empty();
  }));
  EXPECT_EQ(recorder_.report().topics.size(), of_the_ring + 1);
  ASSERT_EQ(sentences.size(), 1U);
  EXPECT_EQ(test::missing_fact(sentences[0], "rt/other/thing|foreign::msg::dds_::Thing_"), "")
      << sentences[0];
  recorder_.stop();
  const bag::WholeBag bag = expect_value(bag::WholeBag::open(folder_ / "bag"));
  ASSERT_TRUE(bag.find_topic("/other/header"));
  const bag::TopicInfo& topic = bag.topics()[*bag.find_topic("/other/header")];
  EXPECT_EQ(topic.type, "std_msgs/msg/Header");
  EXPECT_EQ(topic.message_count, 1U);
  EXPECT_EQ(topic.offered_qos, offered_qos_text(latched_.get()));
  EXPECT_FALSE(bag.find_topic("/other/thing") || bag.find_topic("/unwanted"));
}

TEST_F(Recording, DropsAndCountsMessagesLargerThanTheQueue) {
  RecordedTopics topics(participant_, options_, {"rt/other/huge"}, recorder_, wait_set_);
  const dds_entity_t huge = writer("rt/other/huge");
  for (const std::size_t size : {std::size_t{2} << 20, std::size_t{1000}}) {
    write(huge, std::string(size, 'h'));
    ASSERT_TRUE(eventually([&] {
      EXPECT_TRUE(topics.discover().empty());
      return topics.drain() > 0;
    }));
  }
  const bag::RecordingReport report = recorder_.stop();
  EXPECT_EQ(report.total(&bag::TopicReport::received), 2U);
  EXPECT_EQ(report.total(&bag::TopicReport::dropped), 1U);
  EXPECT_EQ(report.total(&bag::TopicReport::written), 1U);
}

}  // namespace
}  // namespace voxtouch::logger
