#include "nodes/bus/raw_reader.hpp"

#include "nodes/logger/recording_qos.hpp"
#include "tests/unit/bag/dds_support.hpp"
#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::bus {
namespace {

using namespace bag::test;
using Vector3 = msg::geometry_msgs_Vector3;
using Header = msg::std_msgs_Header;
using Bytes = std::vector<std::byte>;

constexpr int kSamples = 300;

qos::Qos reliable(bool latched = false) {
  qos::Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_history(qos.get(), latched ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, 1);
  if (latched) {
    dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, -1, -1, -1);
  }
  return qos;
}

template <class T>
dds_entity_t writer_of(dds_entity_t participant, const std::string& name, const qos::Qos& qos) {
  return make_writer(participant, *msg::Type<T>::descriptor, name, qos.get());
}
template <class T>
RawReader reader_of(dds_entity_t participant, const std::string& name, const qos::Qos& qos) {
  return RawReader(participant, name, *msg::Type<T>::descriptor, qos.get());
}

// Takes until `count` messages are there or 10 s are over.
std::vector<Bytes> take(RawReader& reader, std::size_t count) {
  std::vector<Bytes> taken;
  eventually([&] {
    reader.take(
        [&](std::span<const std::byte> bytes) { taken.emplace_back(bytes.begin(), bytes.end()); });
    return taken.size() >= count;
  });
  return taken;
}

Bytes header_cdr(int i, const std::string& text) {
  return CdrBuilder().add(std::int32_t{i}).add(std::uint32_t{7}).add_text(text).padded();
}

void write_header(dds_entity_t writer, int i, std::string text) {
  const Header header{{i, 7}, text.data()};
  ASSERT_EQ(dds_write(writer, &header), DDS_RETCODE_OK);
}

// Location of the raw reader: in the writer's participant, or across the wire.
class RawReading : public testing::TestWithParam<bool> {
 protected:
  TwoHosts hosts_;
  dds_entity_t reading_side() const { return GetParam() ? hosts_.there() : hosts_.here(); }
};

TEST_P(RawReading, TakesEveryMessageOfFixedSizeByteForByte) {
  const std::string name = topic_name("fixed");
  const dds_entity_t writer = writer_of<Vector3>(hosts_.here(), name, reliable());
  RawReader reader = reader_of<Vector3>(reading_side(), name, reliable());
  ASSERT_TRUE(eventually([&] { return matched(writer) && matched(reader.get()); }));
  for (int i = 0; i < kSamples; ++i) {
    const Vector3 sample{0.001 * i, -1.0 * i, 3.0};
    ASSERT_EQ(dds_write(writer, &sample), DDS_RETCODE_OK);
  }
  const auto taken = take(reader, kSamples);
  ASSERT_EQ(taken.size(), static_cast<std::size_t>(kSamples));
  for (int i = 0; i < kSamples; ++i)
    ASSERT_EQ(taken[static_cast<std::size_t>(i)],
              CdrBuilder().add(0.001 * i).add(-1.0 * i).add(3.0).padded())
        << i;
}

TEST_P(RawReading, TakesEveryMessageWithATextByteForByte) {
  const std::string name = topic_name("text");
  const dds_entity_t writer = writer_of<Header>(hosts_.here(), name, reliable());
  RawReader reader = reader_of<Header>(reading_side(), name, reliable());
  ASSERT_TRUE(eventually([&] { return matched(writer) && matched(reader.get()); }));
  // Texts of all lengths modulo 4, for every kind of padding.
  const auto text = [](int i) { return std::string(static_cast<std::size_t>(i % 9), 'n'); };
  for (int i = 0; i < kSamples; ++i)
    write_header(writer, i, text(i));
  const auto taken = take(reader, kSamples);
  ASSERT_EQ(taken.size(), static_cast<std::size_t>(kSamples));
  for (int i = 0; i < kSamples; ++i)
    ASSERT_EQ(taken[static_cast<std::size_t>(i)], header_cdr(i, text(i))) << i;
}

TEST_P(RawReading, GetsALatchedMessageOnlyOnRequest) {
  const std::string name = topic_name("latched");
  const qos::Qos latched = reliable(true);
  const dds_entity_t writer = writer_of<Header>(hosts_.here(), name, latched);
  for (int i = 0; i < 2; ++i)
    write_header(writer, i, "latched");
  RawReader does_not_ask = reader_of<Header>(reading_side(), name, reliable());
  RawReader asks = reader_of<Header>(reading_side(), name, logger::recording_qos(latched.get()));
  EXPECT_EQ(take(asks, 1), std::vector<Bytes>{header_cdr(1, "latched")});
  ASSERT_TRUE(eventually([&] { return matched(does_not_ask.get()); }));
  EXPECT_EQ(does_not_ask.take([](std::span<const std::byte>) {}), 0U);
}

TEST_P(RawReading, AssemblesAMessageOfManyPackets) {
  const std::string name = topic_name("long");
  const dds_entity_t writer = writer_of<Header>(hosts_.here(), name, reliable());
  RawReader reader = reader_of<Header>(reading_side(), name, reliable());
  ASSERT_TRUE(eventually([&] { return matched(writer) && matched(reader.get()); }));
  std::string text(300'001, ' ');
  for (std::size_t i = 0; i < text.size(); ++i)
    text[i] = static_cast<char>('a' + i % 23);
  write_header(writer, 1, text);
  EXPECT_EQ(take(reader, 1), std::vector<Bytes>{header_cdr(1, text)});
}

TEST_P(RawReading, ReportsNothingWhenTheWriterLeaves) {
  const std::string name = topic_name("gone");
  const dds_entity_t writer = writer_of<Header>(hosts_.here(), name, reliable());
  RawReader reader = reader_of<Header>(reading_side(), name, reliable());
  ASSERT_TRUE(eventually([&] { return matched(writer) && matched(reader.get()); }));
  write_header(writer, 1, "last");
  ASSERT_EQ(take(reader, 1).size(), 1U);
  dds_delete(writer);
  ASSERT_TRUE(eventually([&] { return !matched(reader.get()); }));
  EXPECT_EQ(reader.take([](std::span<const std::byte>) {}), 0U);
}

// Writers with a deadline, a lease and reliability: the recorder's requested QoS must match the
// offered one.
TEST_P(RawReading, MatchesEveryWriterWithTheQosOfARecording) {
  const auto offered = [](auto set) {
    qos::Qos qos = reliable();
    set(qos.get());
    return qos;
  };
  for (const qos::Qos& qos :
       {offered([](dds_qos_t* q) {
          dds_qset_reliability(q, DDS_RELIABILITY_BEST_EFFORT, 0);
          dds_qset_deadline(q, 3'000'000);
        }),
        offered([](dds_qos_t* q) { dds_qset_durability(q, DDS_DURABILITY_TRANSIENT); }),
        offered([](dds_qos_t* q) {
          dds_qset_liveliness(q, DDS_LIVELINESS_MANUAL_BY_TOPIC, 100'000'000);
        })}) {
    const std::string name = topic_name("offered");
    writer_of<Header>(hosts_.here(), name, qos);
    const RawReader reader =
        reader_of<Header>(reading_side(), name, logger::recording_qos(qos.get()));
    EXPECT_TRUE(eventually([&] { return matched(reader.get()); }));
  }
}

INSTANTIATE_TEST_SUITE_P(Sides, RawReading, testing::Values(false, true), [](const auto& side) {
  return side.param ? "OverTheWire" : "InOneParticipant";
});

TEST(RawReader, ReportsADdsRefusal) {
  const TwoHosts hosts;
  EXPECT_THROW(reader_of<Header>(hosts.here(), "not a name?*", reliable()), Error);
}

}  // namespace
}  // namespace voxtouch::bus
