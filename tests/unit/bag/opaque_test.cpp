#include "nodes/bus/opaque.hpp"

#include "plain.h"
#include "tests/unit/bag/dds_support.hpp"
#include "typed.h"

namespace voxtouch::bus {
namespace {

using namespace bag::test;
using Typed = bag_test_msg_dds__Typed_;
using Plain = bag_test_msg_dds__Plain_;

constexpr int kSamples = 300;
/// Writes wait for as long as a busy machine, or a sanitizer, may need.
const EndpointQos kAll = [] {
  EndpointQos qos{.reliability = Reliability::kReliable, .history = History::kKeepAll};
  qos.max_blocking_ns = 10'000'000'000;
  return qos;
}();
const EndpointQos kLatched{.reliability = Reliability::kReliable, .durability = Durability::kTransientLocal};

Plain plain_sample(int i) {
  const double x = 0.001 * i;
  return {77, static_cast<std::uint64_t>(i), 1'000'000LL * i, {x, -x, 2 * x}, 5, 0};
}

CdrBuilder plain_cdr(int i, bool little = true) {
  const Plain p = plain_sample(i);
  CdrBuilder cdr(little);
  cdr.add(p.session_id).add(p.sequence_number).add(p.sample_time_ns);
  cdr.add(p.position[0]).add(p.position[1]).add(p.position[2]).add(p.flags).add(p.reserved);
  return cdr;
}

// Texts of all lengths modulo 4, so that every kind of padding is there.
std::string note(int i) { return std::string(static_cast<std::size_t>(i % 9), 'n'); }

CdrBuilder typed_cdr(int i, bool little = true) {
  const Plain p = plain_sample(i);
  CdrBuilder cdr(little);
  cdr.add(p.session_id).add(p.sequence_number).add(p.sample_time_ns);
  cdr.add(p.position[0]).add(p.position[1]).add(p.position[2]).add_text(note(i));
  return cdr;
}

OpaqueTopic opaque_topic(dds_entity_t participant, const std::string& name, const char* type) {
  return expect_value(OpaqueTopic::create(participant, name, type));
}

struct Taken {
  std::vector<std::byte> bytes;
  std::int64_t source_time_ns, reception_time_ns;
};

// Takes until `count` valid samples are there or 10 s are over.
std::vector<Taken> take(OpaqueReader& reader, std::size_t count) {
  std::vector<Taken> taken;
  eventually([&] {
    EXPECT_GOOD(reader.take([&](const RawSample& sample) {
      if (sample.valid)
        taken.push_back({{sample.bytes.begin(), sample.bytes.end()}, sample.source_time_ns,
                         sample.reception_time_ns});
    }));
    return taken.size() >= count;
  });
  return taken;
}

// Where the raw reader stands: in the typed writer's own participant, or on the other side of the wire.
class OpaqueReading : public testing::TestWithParam<bool> {
 protected:
  TwoHosts hosts_;
  dds_entity_t reading_side() const { return GetParam() ? hosts_.there() : hosts_.here(); }
};

TEST_P(OpaqueReading, TakesEverySampleOfAWriterWithoutTypeInformationByteForByte) {
  const std::string name = topic_name("plain");
  const dds_entity_t writer = typed_endpoint(true, hosts_.here(), bag_test_msg_dds__Plain__desc, name);
  const OpaqueTopic topic = opaque_topic(reading_side(), name, "bag_test::msg::dds_::Plain_");
  auto reader = expect_value(OpaqueReader::create(topic, kAll));
  ASSERT_TRUE(eventually([&] { return matched(writer) && reader.matched_writers() == 1; }));
  const std::int64_t before = dds_time();
  for (int i = 0; i < kSamples; ++i) {
    const Plain sample = plain_sample(i);
    ASSERT_EQ(dds_write_ts(writer, &sample, 1000 + i), DDS_RETCODE_OK);
  }
  const auto taken = take(reader, kSamples);
  ASSERT_EQ(taken.size(), static_cast<std::size_t>(kSamples));
  for (int i = 0; i < kSamples; ++i) {
    const auto& sample = taken[static_cast<std::size_t>(i)];
    ASSERT_EQ(sample.bytes, plain_cdr(i).bytes()) << i;
    EXPECT_EQ(sample.source_time_ns, 1000 + i);
    EXPECT_GE(sample.reception_time_ns, before);
    EXPECT_LE(sample.reception_time_ns, dds_time());
  }
}

TEST_P(OpaqueReading, TakesEverySampleOfAWriterWithTypeInformationByteForByte) {
  const std::string name = topic_name("typed");
  const dds_entity_t writer = typed_endpoint(true, hosts_.here(), bag_test_msg_dds__Typed__desc, name);
  const OpaqueTopic topic = opaque_topic(reading_side(), name, "bag_test::msg::dds_::Typed_");
  auto reader = expect_value(OpaqueReader::create(topic, kAll));
  ASSERT_TRUE(eventually([&] { return matched(writer) && reader.matched_writers() == 1; }));
  for (int i = 0; i < kSamples; ++i) {
    const Plain p = plain_sample(i);
    std::string text = note(i);
    const Typed sample{p.session_id, p.sequence_number, p.sample_time_ns,
                       {p.position[0], p.position[1], p.position[2]}, text.data()};
    ASSERT_EQ(dds_write(writer, &sample), DDS_RETCODE_OK);
  }
  const auto taken = take(reader, kSamples);
  ASSERT_EQ(taken.size(), static_cast<std::size_t>(kSamples));
  for (int i = 0; i < kSamples; ++i)
    ASSERT_EQ(taken[static_cast<std::size_t>(i)].bytes, typed_cdr(i).padded()) << i;
}

TEST_P(OpaqueReading, GetsALatchedSampleWrittenBeforeItCameOnlyIfItAsks) {
  const std::string name = topic_name("latched");
  const dds_entity_t writer = typed_endpoint(true, hosts_.here(), bag_test_msg_dds__Plain__desc, name, true);
  for (int i = 0; i < 2; ++i) {
    const Plain sample = plain_sample(i);
    ASSERT_EQ(dds_write(writer, &sample), DDS_RETCODE_OK);
  }
  const OpaqueTopic topic = opaque_topic(reading_side(), name, "bag_test::msg::dds_::Plain_");
  auto does_not_ask = expect_value(OpaqueReader::create(topic, kAll));
  auto asks = expect_value(OpaqueReader::create(topic, recorder_qos(kLatched)));
  const auto taken = take(asks, 1);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].bytes, plain_cdr(1).bytes());
  ASSERT_TRUE(eventually([&] { return does_not_ask.matched_writers() == 1; }));
  EXPECT_EQ(expect_value(does_not_ask.take([](const RawSample&) {})), 0u);
}

TEST_P(OpaqueReading, TellsThatTheWriterHasGone) {
  const std::string name = topic_name("gone");
  const dds_entity_t writer = typed_endpoint(true, hosts_.here(), bag_test_msg_dds__Plain__desc, name);
  const OpaqueTopic topic = opaque_topic(reading_side(), name, "bag_test::msg::dds_::Plain_");
  auto reader = expect_value(OpaqueReader::create(topic, kAll));
  ASSERT_TRUE(eventually([&] { return matched(writer) && reader.matched_writers() == 1; }));
  const Plain sample = plain_sample(0);
  ASSERT_EQ(dds_write(writer, &sample), DDS_RETCODE_OK);
  ASSERT_EQ(take(reader, 1).size(), 1u);
  dds_delete(writer);
  InstanceState state = InstanceState::kAlive;
  EXPECT_TRUE(eventually([&] {
    (void)reader.take([&](const RawSample& news) {
      EXPECT_FALSE(news.valid);
      EXPECT_TRUE(news.bytes.empty());
      state = news.state;
    });
    return state != InstanceState::kAlive;
  }));
}

TEST_P(OpaqueReading, PutsAMessageOfManyPacketsTogether) {
  const std::string name = topic_name("long");
  const dds_entity_t writer = typed_endpoint(true, hosts_.here(), bag_test_msg_dds__Typed__desc, name);
  const OpaqueTopic topic = opaque_topic(reading_side(), name, "bag_test::msg::dds_::Typed_");
  auto reader = expect_value(OpaqueReader::create(topic, kAll));
  ASSERT_TRUE(eventually([&] { return matched(writer) && reader.matched_writers() == 1; }));
  std::string text(300'001, ' ');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>('a' + i % 23);
  const Typed sample{1, 2, 3, {4, 5, 6}, text.data()};
  ASSERT_EQ(dds_write(writer, &sample), DDS_RETCODE_OK);
  const auto taken = take(reader, 1);
  ASSERT_EQ(taken.size(), 1u);
  CdrBuilder cdr;
  cdr.add(std::uint64_t{1}).add(std::uint64_t{2}).add(std::int64_t{3}).add(4.0).add(5.0).add(6.0).add_text(
      text);
  EXPECT_EQ(taken[0].bytes, cdr.padded());
}

INSTANTIATE_TEST_SUITE_P(Sides, OpaqueReading, testing::Values(false, true),
                         [](const auto& side) { return side.param ? "OverTheWire" : "InOneParticipant"; });

class OpaqueWriting : public testing::TestWithParam<std::tuple<bool, bool>> {
 protected:
  TwoHosts hosts_;
  dds_entity_t writing_side() const { return std::get<0>(GetParam()) ? hosts_.there() : hosts_.here(); }
  bool little() const { return std::get<1>(GetParam()); }
};

TEST_P(OpaqueWriting, ReachesATypedReaderWithEveryValueRight) {
  const std::string name = topic_name("back");
  const dds_entity_t reader = typed_endpoint(false, hosts_.here(), bag_test_msg_dds__Typed__desc, name);
  const OpaqueTopic topic = opaque_topic(writing_side(), name, "bag_test::msg::dds_::Typed_");
  auto writer = expect_value(OpaqueWriter::create(topic, kAll));
  ASSERT_TRUE(eventually([&] { return matched(reader) && writer.matched_readers() == 1; }));
  for (int i = 0; i < kSamples; ++i) EXPECT_GOOD(writer.write(typed_cdr(i, little()).padded(), 5000 + i));
  int got = 0;
  eventually([&] {
    void* samples[1] = {nullptr};
    dds_sample_info_t info[1];
    while (dds_take(reader, samples, info, 1, 1) == 1) {
      const auto& typed = *static_cast<const Typed*>(samples[0]);
      const Plain wanted = plain_sample(got);
      EXPECT_EQ(typed.sequence_number, wanted.sequence_number);
      EXPECT_EQ(typed.position[2], wanted.position[2]);
      EXPECT_EQ(std::string(typed.note), note(got));
      EXPECT_EQ(info[0].source_timestamp, 5000 + got);
      ++got;
      dds_return_loan(reader, samples, 1);
    }
    return got >= kSamples;
  });
  EXPECT_EQ(got, kSamples);
}

TEST_P(OpaqueWriting, ReachesAnOpaqueReaderUnchanged) {
  const std::string name = topic_name("both");
  const OpaqueTopic read_topic = opaque_topic(hosts_.here(), name, "some::msg::dds_::Thing_");
  const OpaqueTopic write_topic = opaque_topic(writing_side(), name, "some::msg::dds_::Thing_");
  auto reader = expect_value(OpaqueReader::create(read_topic, kAll));
  auto writer = expect_value(OpaqueWriter::create(write_topic, kAll));
  ASSERT_TRUE(eventually([&] { return reader.matched_writers() == 1 && writer.matched_readers() == 1; }));
  const auto bytes = plain_cdr(3, little()).bytes();
  EXPECT_GOOD(writer.write(bytes));
  const auto taken = take(reader, 1);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].bytes, bytes);
}

INSTANTIATE_TEST_SUITE_P(Sides, OpaqueWriting, testing::Combine(testing::Bool(), testing::Bool()),
                         [](const auto& side) {
  return std::string(std::get<0>(side.param) ? "OverTheWire" : "InOneParticipant") +
      (std::get<1>(side.param) ? "Little" : "Big");
});

TEST(Opaque, SaysWhatDdsRefuses) {
  const TwoHosts hosts;
  const auto bad_name = OpaqueTopic::create(hosts.here(), "not a name?*", "a::B_");
  ASSERT_FALSE(bad_name);
  EXPECT_EQ(bad_name.error().code, DDS_RETCODE_BAD_PARAMETER);
  EXPECT_NE(bad_name.error().sentence.find("not a name"), std::string::npos);
  const std::string name = topic_name("refused");
  const OpaqueTopic topic = opaque_topic(hosts.here(), name, "a::B_");
  const auto other_type = OpaqueTopic::create(hosts.here(), name, "a::C_");
  EXPECT_TRUE(!other_type || other_type->type_name() == "a::C_");  // DDS may allow it; it must not crash
  auto writer = expect_value(OpaqueWriter::create(topic, {}));
  EXPECT_EQ(writer.write({}, 1).error().code, DDS_RETCODE_BAD_PARAMETER);
  EXPECT_EQ(writer.write(plain_cdr(0).bytes(), -1).error().code, DDS_RETCODE_BAD_PARAMETER);
  EXPECT_FALSE(OpaqueReader::create(topic, {.depth = -5}));
}

TEST(Opaque, HandlesMoveAndGoOnce) {
  const TwoHosts hosts;
  OpaqueTopic topic = opaque_topic(hosts.here(), topic_name("moved"), "a::B_");
  auto first = expect_value(OpaqueReader::create(topic, {}));
  const dds_entity_t handle = first.handle();
  OpaqueReader second = std::move(first);
  EXPECT_EQ(second.handle(), handle);
  second = expect_value(OpaqueReader::create(topic, {}));
  EXPECT_LT(dds_get_parent(handle), 0);  // deleted when it was replaced
}

}  // namespace
}  // namespace voxtouch::bus
