#include <gtest/gtest.h>

#include <deque>
#include <set>
#include <thread>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"

namespace voxtouch::qos {
namespace {

using qos::Endpoint;
using qos::ProfileId;
using qos::TimeMode;

/// Whether a writer of profile `offered` satisfies a reader of profile `requested` at the same period.
bool matches(const qos::Profile& offered, const qos::Profile& requested) {
  if (requested.reliable && !offered.reliable) return false;
  if (requested.transient_local && !offered.transient_local) return false;
  return requested.deadline_periods <= 0 ||
         (offered.deadline_periods > 0 && offered.deadline_periods <= requested.deadline_periods);
}

TEST(Topics, EachWriterSatisfiesItsFullReaderAndTheTapInBothTimeModes) {
  for (const qos::Topic& topic : qos::kTopics)
    for (const TimeMode mode : {TimeMode::kRealTime, TimeMode::kLockstep}) {
      const qos::Profile& writer = qos::profile_in(topic, mode);
      EXPECT_TRUE(matches(writer, qos::profile_in(topic, mode))) << topic.path;
      EXPECT_TRUE(matches(writer, qos::profile(ProfileId::kTap))) << topic.path;
    }
}

TEST(Topics, HaveDistinctNames) {
  std::set<std::string> names;
  for (const qos::Topic& topic : qos::kTopics) EXPECT_TRUE(names.insert(qos::dds_name(topic, "haptic")).second) << topic.path;
}

TEST(Topics, CarryTheNamesThatRosToolsExpect) {
  EXPECT_EQ(qos::dds_name(qos::kDeviceState, "haptic"), "rt/haptic/device/state");
  EXPECT_EQ(qos::dds_name(qos::kTf, "haptic"), "rt/tf");
  EXPECT_EQ(msg::Type<msg::DeviceState>::dds_name, "voxtouch_msgs::msg::dds_::DeviceState_");
  EXPECT_STREQ(msg::Type<msg::DeviceState>::descriptor->m_typename, "voxtouch_msgs::msg::dds_::DeviceState_");
}

TEST(Topics, AreOfferedAsRosToolsAskForThem) {
  for (const qos::Topic& topic : {qos::kPose, qos::kWrench, qos::kTf, qos::kMarkers, qos::kClock, qos::kDiagnostics}) {
    const qos::Profile& p = qos::profile(topic.profile);
    EXPECT_TRUE(p.reliable) << topic.path << ": a subscription by default asks for it";
    EXPECT_FALSE(p.keep_all) << topic.path << ": a reader that stands still would fill the history";
    const qos::Qos q = qos::make_qos(p, Endpoint::kWriter, 0.0);
    dds_reliability_kind_t kind{};
    dds_duration_t blocking = -1;
    ASSERT_TRUE(dds_qget_reliability(q.get(), &kind, &blocking));
    EXPECT_EQ(blocking, 0) << topic.path << ": who writes it would wait for who looks";
  }
  const qos::Profile& fixed = qos::profile(qos::kTfStatic.profile);
  EXPECT_TRUE(fixed.reliable && fixed.transient_local) << "tf2 asks for what was said before it came";
}

/// Published hashes of ROS 2 from Iron on: texts, arrays, sequences and nested types are among them.
TEST(Types, HaveTheHashesThatRosPublishes) {
  EXPECT_EQ(msg::Type<msg::std_msgs_Header>::hash, "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01");
  EXPECT_EQ(msg::Type<msg::geometry_msgs_Vector3>::hash, "RIHS01_cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d");
  EXPECT_EQ(msg::Type<msg::geometry_msgs_Twist>::hash, "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a");
  EXPECT_EQ(msg::Type<msg::geometry_msgs_PoseStamped>::hash, "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8");
  EXPECT_EQ(msg::Type<msg::geometry_msgs_WrenchStamped>::hash, "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77");
  EXPECT_EQ(msg::Type<msg::tf2_msgs_TFMessage>::hash, "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087");
  EXPECT_EQ(msg::Type<msg::diagnostic_msgs_DiagnosticArray>::hash, "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e");
  EXPECT_EQ(msg::Type<msg::visualization_msgs_MarkerArray>::hash, "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf");
}

TEST(Topics, StreamsLoseNothingInLockstep) {
  for (const qos::Topic& topic : {qos::kDeviceState, qos::kContactState, qos::kForceCommand, qos::kValidation}) {
    const qos::Profile& p = qos::profile_in(topic, TimeMode::kLockstep);
    EXPECT_TRUE(p.reliable && p.keep_all) << topic.path;
    EXPECT_EQ(p.deadline_periods, 0.0) << topic.path;
  }
}

TEST(Profiles, HaveNoLatencyBudgetAndNoLifespan) {
  for (const qos::Profile& p : qos::kProfiles)
    for (const Endpoint endpoint : {Endpoint::kWriter, Endpoint::kReader}) {
      const qos::Qos q = qos::make_qos(p, endpoint, 1e-3);
      dds_duration_t budget = 0, lifespan = 0;
      EXPECT_TRUE(!dds_qget_latency_budget(q.get(), &budget) || budget == 0) << p.name;
      EXPECT_TRUE(!dds_qget_lifespan(q.get(), &lifespan) || lifespan == DDS_INFINITY) << p.name;
    }
}

TEST(Profiles, KeepTheStreamDeadlineAtThreePeriods) {
  for (const Endpoint endpoint : {Endpoint::kWriter, Endpoint::kReader}) {
    const qos::Qos q = qos::make_qos(qos::profile(ProfileId::kStream), endpoint, 1e-3);
    dds_duration_t deadline = 0;
    ASSERT_TRUE(dds_qget_deadline(q.get(), &deadline));
    EXPECT_EQ(deadline, DDS_MSECS(3));
  }
}

/// The prediction is held against what Cyclone DDS does, for every pair.
TEST(Profiles, MatchOverRealDdsExactlyWhereTheTableSaysSo) {
  const bus::Participant participant({71, "lo", "qos_test"});
  struct Pair {
    const qos::Profile *offered, *requested;
    bus::Writer<msg::DeviceState> writer;
    bus::Reader<msg::DeviceState> reader;
  };
  std::vector<Pair> pairs;
  std::deque<std::string> names;
  for (const qos::Profile& offered : qos::kProfiles)
    for (const qos::Profile& requested : qos::kProfiles) {
      names.push_back(std::string(offered.name) + "_" + std::string(requested.name));
      const qos::Topic topic{names.back(), "voxtouch_msgs/msg/DeviceState", offered.id, 1000};
      pairs.push_back({&offered, &requested, {participant, topic, "pairs", offered}, {participant, topic, "pairs", requested}});
    }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  for (const Pair& pair : pairs)
    EXPECT_EQ(pair.writer.matched_count() == 1, matches(*pair.offered, *pair.requested))
        << pair.offered->name << " -> " << pair.requested->name;
}

TEST(Bus, RefusesATypeThatTheTableDoesNotGiveTheTopic) {
  const bus::Participant participant({71, "lo", "qos_test"});
  EXPECT_THROW((bus::Writer<msg::ForceCommand>(participant, qos::kDeviceState, "r", qos::profile(ProfileId::kStream))), bus::Error);
}

TEST(Bus, NamesTheInterfaceThatDoesNotExist) {
  try {
    const bus::Participant participant({72, "no_such_if0", "qos_test"});
    FAIL() << "a participant was made on an interface that does not exist";
  } catch (const bus::Error& error) {
    EXPECT_NE(std::string(error.what()).find("no_such_if0"), std::string::npos) << error.what();
  }
}

TEST(Bus, GivesALatchedValueToALateReader) {
  const bus::Participant participant({71, "lo", "qos_test"});
  const auto& latched = qos::profile(ProfileId::kLatched);
  bus::Writer<msg::DeviceDescription> writer(participant, qos::kDeviceDescription, "late", latched);
  msg::DeviceDescription sample{};
  char model[] = "sim-phantom";
  sample.model = model;
  sample.max_force_n = 8.5;
  ASSERT_TRUE(writer.write(sample));
  bus::Reader<msg::DeviceDescription> reader(participant, qos::kDeviceDescription, "late", latched);
  std::string got;
  for (int i = 0; i < 100 && got.empty(); ++i) {
    reader.take_each([&](const msg::DeviceDescription& d) { got = d.model; });
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(got, "sim-phantom");
}

}  // namespace
}  // namespace voxtouch::qos
