// Records that a replay follows: those of the authorised rendering are in the bag, in any order of
// arrival; those of others are not, and are reported.
#include "nodes/logger/role_records.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "nodes/bus/writer.hpp"
#include "nodes/logger/logger_node.hpp"
#include "nodes/runtime/strings.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/support/whole_bag.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using logger::RoleRecords;

bus::Guid guid(std::uint8_t number) {
  bus::Guid all{};
  all[0] = number;
  return all;
}

RoleRecords::Record record(std::int64_t time_ns, std::size_t bytes = 10) {
  return {0, time_ns, std::vector<std::byte>(bytes)};
}

/// Times of the records that are now for the bag.
std::vector<std::int64_t> settled(RoleRecords& records) {
  std::vector<std::int64_t> times;
  records.settle([&](const RoleRecords::Record& one) { times.push_back(one.time_ns); });
  return times;
}

TEST(RoleRecordsRule, KeepsRecordsFromBeforeTheBinding) {
  RoleRecords records;
  records.take(guid(1), record(1));
  records.take(guid(2), record(2));
  records.take(guid(1), record(3));
  for (int poll = 0; poll < 10; ++poll)
    records.looked(false);
  EXPECT_TRUE(settled(records).empty());
  records.entitle(guid(1));
  records.looked(true);
  EXPECT_EQ(settled(records), (std::vector<std::int64_t>{1, 3}));
  EXPECT_EQ(records.refused(), 1U);
  EXPECT_EQ(records.refused_writers(), (std::map<bus::Guid, std::uint64_t>{{guid(2), 1}}));
}

TEST(RoleRecordsRule, WaitsForTwoUpdatesBeforeItRefuses) {
  RoleRecords records;
  records.entitle(guid(1)), records.looked(true);
  records.take(guid(2), record(1));
  records.looked(true);
  EXPECT_TRUE(settled(records).empty());
  records.entitle(guid(2)), records.looked(true);
  EXPECT_EQ(settled(records), std::vector<std::int64_t>{1});
  records.take(guid(3), record(2));
  records.looked(true), records.looked(true);
  EXPECT_TRUE(settled(records).empty());
  EXPECT_EQ(records.refused(), 1U);
  records.entitle(guid(3));
  EXPECT_TRUE(settled(records).empty()) << "what was refused stays so";
}

TEST(RoleRecordsRule, RefusesUnconfirmedRecordsAtTheEnd) {
  RoleRecords records;
  records.take(bus::Guid{}, record(1));
  EXPECT_TRUE(settled(records).empty());
  records.end([](const auto&) { FAIL(); });
  EXPECT_EQ(records.refused(), 1U);
  EXPECT_TRUE(settled(records).empty());
}

TEST(RoleRecordsRule, StreamsOfAnUnknownRoleAreRecordedAtTheEnd) {
  RoleRecords records(RoleRecords::Unknown::kRecord);
  records.take(guid(1), record(1));
  records.looked(false), records.looked(false), records.looked(false);
  EXPECT_TRUE(settled(records).empty());
  std::vector<std::int64_t> times;
  records.end([&](const RoleRecords::Record& one) { times.push_back(one.time_ns); });
  EXPECT_EQ(times, std::vector<std::int64_t>{1});
  EXPECT_EQ(records.refused(), 0U);
}

TEST(RoleRecordsRule, StreamsAreNotLostBeforeTheRoleIsKnown) {
  RoleRecords records(RoleRecords::Unknown::kRecord);
  std::vector<std::int64_t> times;
  for (int n = 0; n < 100; ++n) {
    records.take(guid(1), record(n, RoleRecords::kMaxOfOne / 10));
    records.settle([&](const RoleRecords::Record& one) { times.push_back(one.time_ns); });
  }
  records.entitle(guid(1)), records.looked(true);
  for (int n = 100; n < 200; ++n)
    records.take(guid(1), record(n, RoleRecords::kMaxOfOne / 10));
  records.settle([&](const RoleRecords::Record& one) { times.push_back(one.time_ns); });
  ASSERT_EQ(times.size(), 200U);
  for (std::int64_t n = 0; n < 200; ++n)
    EXPECT_EQ(times[static_cast<std::size_t>(n)], n);
  records.take(guid(2), record(7));
  records.looked(true), records.looked(true);
  EXPECT_TRUE(settled(records).empty());
  EXPECT_EQ(records.refused(), 1U);
}

TEST(RoleRecordsRule, FloodTakesNoRoomOfOthers) {
  RoleRecords records;
  for (int n = 0; n < 100; ++n)
    records.take(guid(2), record(n, RoleRecords::kMaxOfOne / 10));
  EXPECT_EQ(records.refused(), 90U);
  records.take(guid(1), record(7));
  records.entitle(guid(1));
  EXPECT_EQ(settled(records), std::vector<std::int64_t>{7});
  for (std::uint8_t n = 3; n < 100; ++n)
    records.take(guid(n), record(0, RoleRecords::kMaxOfOne));
  EXPECT_EQ(records.refused(), 90U + 97U - 15U) << "of sixteen million bytes the first has one";
}

/// A rendering as the real ones are, as far as a logger sees them.
struct Rendering : StandIn {
  explicit Rendering(const std::string& rig)
      : StandIn(kDomain, "rendering", rig),
        contacts(participant, qos::kContactState, rig, qos::profile(qos::kContactState.profile)),
        plans(participant, qos::kScenePlan, rig, qos::profile(qos::kScenePlan.profile)),
        made(participant, qos::kEffectMade, rig, qos::profile(qos::kEffectMade.profile)) {}
  void make(std::uint64_t from_sample) {
    const std::string effect = "oil", none;
    msg::EffectChange m{};
    m.session_id = 7, m.from_sample = from_sample, m.action = msg::effect_change::kActionSwitch;
    m.effect = runtime::lend(effect), m.parameter = m.model = runtime::lend(none);
    made.write(m);
  }
  bus::Writer<msg::ContactState> contacts;
  bus::Writer<msg::ScenePlan> plans;
  bus::Writer<msg::EffectChange> made;
};

class RecordsOfTheLogger : public testing::Test {
 protected:
  RecordsOfTheLogger()
      : descriptions(device.participant, qos::kDeviceDescription, rig,
                     qos::profile(qos::ProfileId::kLatched)),
        options(options_for(rig)),
        node([this](const std::atomic<bool>& stop) { return logger::run(options, stop); }) {}
  ~RecordsOfTheLogger() override { std::filesystem::remove_all(options.bag); }
  static logger::Options options_for(const std::string& rig) {
    auto o = node_options<logger::Options>(rig);
    o.bag = std::filesystem::temp_directory_path() / ("voxtouch_records_" + rig);
    return o;
  }
  void begin() { descriptions.write(stylus(7)), device.say(7); }
  std::string message() { return report() ? report()->message : ""; }
  double figure(const char* name) {
    const auto now = report();
    return now ? runtime::value_of(now->figures, name) : 0.0;
  }
  double refused() { return figure("refused_records"); }
  std::optional<runtime::NodeReport> report() {
    registry.update();
    return registry.find("logger");
  }
  /// First samples of the records in the bag.
  std::vector<std::uint64_t> recorded() { return numbers_in("/rendering/made", 16); }
  /// Of each message of a topic the eight bytes at an offset.
  std::vector<std::uint64_t> numbers_in(const std::string& topic, std::size_t offset) {
    EXPECT_EQ(node.end(), 0) << node.error();
    std::vector<std::uint64_t> samples;
    const auto bag = bag::WholeBag::open(options.bag);
    const auto messages = bag ? bag->read_topic("/" + rig + topic, bag::WholeBag::Order::kArrival)
                              : std::unexpected(bag.error());
    if (!messages)
      throw std::runtime_error(messages.error().sentence);
    for (const auto& message : *messages)
      std::memcpy(&samples.emplace_back(), message.bytes.data() + 4 + offset, 8);
    return samples;
  }

  const std::string rig = own_rig("m");
  StandIn device{kDomain, "device", rig};
  runtime::NodeRegistry registry{device.participant, rig};
  bus::Writer<msg::DeviceDescription> descriptions;
  logger::Options options;
  NodeThread node;
};

TEST_F(RecordsOfTheLogger, AreTheRenderingsOnlyAndNameIntruders) {
  Rendering rendering(rig);
  Adversary unauthorised(kDomain, rig);
  ASSERT_TRUE(wait_until([&] { return rendering.made.matched_count() == 1 && report(); }))
      << node.error();
  rendering.make(11);  // before any participant plays a role
  char effect[] = "oil", none[] = "";
  msg::EffectChange forged{};
  forged.session_id = 7, forged.from_sample = 66, forged.action = msg::effect_change::kActionSwitch,
  forged.effect = effect, forged.parameter = forged.model = none;
  bus::Writer<msg::EffectChange> forger(unauthorised.participant(), qos::kEffectMade, rig,
                                        qos::profile(qos::kEffectMade.profile));
  forger.write(forged);
  begin(), rendering.say(7);
  ASSERT_TRUE(wait_until([&] { return refused() == 1.0; })) << message();
  unauthorised.claim("rendering", 7);
  forged.from_sample = 67, forger.write(forged);
  ASSERT_TRUE(wait_until([&] { return refused() == 2.0; })) << message();
  EXPECT_NE(message().find("2 messages of unauthorised writers not recorded: 2 of "),
            std::string::npos)
      << message();
  EXPECT_NE(message().find("(process 666 on elsewhere)"), std::string::npos) << message();
  rendering.make(12);
  EXPECT_EQ(recorded(), (std::vector<std::uint64_t>{11, 12}));
}

TEST_F(RecordsOfTheLogger, LeaveOutAndNameAnotherDevice) {
  Adversary unauthorised(kDomain, rig);
  const auto& profile = qos::profile(qos::kDeviceState.profile);
  bus::Writer<msg::DeviceState> own(device.participant, qos::kDeviceState, rig, profile);
  bus::Writer<msg::DeviceState> foreign(unauthorised.participant(), qos::kDeviceState, rig,
                                        profile);
  ASSERT_TRUE(wait_until([&] {
    return own.matched_count() == 1 && foreign.matched_count() == 1 && report();
  })) << node.error();
  const auto write = [](auto& writer, std::uint64_t session, std::uint64_t number) {
    msg::DeviceState state{};
    state.session_id = session, state.sequence_number = number;
    writer.write(state);
  };
  write(foreign, 6, 100), write(own, 7, 1);  // before any participant plays a role
  begin();
  ASSERT_TRUE(wait_until([&] { return figure("skipped_messages") == 1.0; })) << message();
  write(foreign, 7, 101);
  ASSERT_TRUE(wait_until([&] { return figure("skipped_messages") == 2.0; })) << message();
  EXPECT_TRUE(message().contains("2 messages of unauthorised writers not recorded: 2 of "))
      << message();
  EXPECT_EQ(refused(), 0.0);
  write(own, 7, 2);
  ASSERT_TRUE(wait_until([&] { return figure("received") >= 3.0; })) << message();
  EXPECT_EQ(numbers_in("/device/state", 8), (std::vector<std::uint64_t>{1, 2}));
}

TEST_F(RecordsOfTheLogger, AreNotOfASecondRenderingWithinTheSession) {
  auto first = std::make_unique<Rendering>(rig);
  ASSERT_TRUE(wait_until([&] { return first->made.matched_count() == 1; })) << node.error();
  begin(), first->say(7), first->make(1);
  ASSERT_TRUE(wait_until([&] { return figure("records") == 1.0; })) << message();
  first.reset();
  Rendering second(rig);
  ASSERT_TRUE(wait_until([&] { return second.made.matched_count() == 1; })) << node.error();
  second.say(7), second.make(2);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(figure("records"), 1.0) << message();
  EXPECT_EQ(recorded(), (std::vector<std::uint64_t>{1}));
}

}  // namespace
}  // namespace voxtouch::test
