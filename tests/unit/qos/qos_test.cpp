#include <gtest/gtest.h>

#include <deque>
#include <fstream>
#include <iterator>
#include <set>
#include <thread>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "voxtouch_msgs/services.hpp"

namespace voxtouch::qos {
namespace {

using qos::Endpoint;
using qos::ProfileId;
using qos::TimeMode;

/// Whether a writer of profile `offered` satisfies a reader of profile `requested` at the same
/// period.
bool matches(const qos::Profile& offered, const qos::Profile& requested) {
  if (requested.reliable && !offered.reliable)
    return false;
  if (requested.transient_local && !offered.transient_local)
    return false;
  return requested.deadline_periods <= 0 ||
         (offered.deadline_periods > 0 && offered.deadline_periods <= requested.deadline_periods);
}

TEST(Topics, WritersSatisfyReadersAndTapInBothTimeModes) {
  for (const qos::Topic& topic : qos::kTopics)
    for (const TimeMode mode : {TimeMode::kRealTime, TimeMode::kLockstep}) {
      const qos::Profile& writer = qos::profile_in(topic, mode);
      EXPECT_TRUE(matches(writer, qos::profile_in(topic, mode))) << topic.path;
      EXPECT_TRUE(matches(writer, qos::profile(ProfileId::kTap))) << topic.path;
    }
}

TEST(Topics, HaveDistinctNames) {
  std::set<std::string> names;
  for (const qos::Topic& topic : qos::kTopics)
    EXPECT_TRUE(names.insert(qos::dds_name(topic, "haptic")).second) << topic.path;
}

TEST(Topics, CarryTheNamesThatRosToolsExpect) {
  EXPECT_EQ(qos::dds_name(qos::kDeviceState, "haptic"), "rt/haptic/device/state");
  EXPECT_EQ(qos::dds_name(qos::kTf, "haptic"), "rt/tf");
  EXPECT_EQ(msg::Type<msg::DeviceState>::dds_name, "voxtouch_msgs::msg::dds_::DeviceState_");
  EXPECT_STREQ(msg::Type<msg::DeviceState>::descriptor->m_typename,
               "voxtouch_msgs::msg::dds_::DeviceState_");
}

TEST(Topics, AreOfferedAsRosToolsRequest) {
  for (const qos::Topic& topic :
       {qos::kPose, qos::kWrench, qos::kTf, qos::kMarkers, qos::kClock, qos::kDiagnostics}) {
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
  EXPECT_TRUE(fixed.reliable && fixed.transient_local)
      << "tf2 asks for what was said before it came";
}

/// Published hashes of ROS 2 from Iron on, as several independent projects list them: texts,
/// arrays, sequences and nested types are among them, and services. Those of our own types none
/// publishes: tests/interop/hashes computes them once more.
TEST(Types, HaveTheHashesThatRosPublishes) {
  const std::pair<std::string_view, std::string_view> all[] = {
      {msg::Type<msg::std_msgs_Header>::hash,
       "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"},
      {msg::Type<msg::std_msgs_String>::hash,
       "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
      {msg::Type<msg::std_msgs_ColorRGBA>::hash,
       "77a7a5b9ae477306097665106e0413ba74440245b1f3d0c6d6405fe5c7813fe8"},
      {msg::Type<msg::geometry_msgs_Vector3>::hash,
       "cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d"},
      {msg::Type<msg::geometry_msgs_Twist>::hash,
       "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"},
      {msg::Type<msg::geometry_msgs_PoseStamped>::hash,
       "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"},
      {msg::Type<msg::geometry_msgs_WrenchStamped>::hash,
       "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"},
      {msg::Type<msg::tf2_msgs_TFMessage>::hash,
       "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
      {msg::Type<msg::diagnostic_msgs_DiagnosticArray>::hash,
       "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
      {msg::Type<msg::visualization_msgs_MarkerArray>::hash,
       "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"},
      {msg::Type<msg::sensor_msgs_JointState>::hash,
       "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"},
      {msg::Type<msg::sensor_msgs_CompressedImage>::hash,
       "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"},
      {msg::Type<msg::rosgraph_msgs_Clock>::hash,
       "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"},
      {msg::Type<msg::service_msgs_ServiceEventInfo>::hash,
       "41bcbbe07a75c9b52bc96bfd5c24d7f0fc0a08c0cb7921b3373c5732345a6f45"},
      {msg::Type<msg::lifecycle_msgs_State>::hash,
       "dd2d02b82f3ebc858e53c431b1e6e91f3ffc71436fc81d0715214ac6ee2107a0"},
      {msg::Type<msg::rcl_interfaces_Log>::hash,
       "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac"},
      {msg::Type<msg::rcl_interfaces_ParameterEvent>::hash,
       "043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204"},
      {msg::Type<msg::rcl_interfaces_ParameterDescriptor>::hash,
       "52175dbfda6c51153101d33d2a9da05743f66f02d5ab2ca9ec4709b46b73d704"},
      {msg::lifecycle_msgs_GetState::hash,
       "800a0a5aae599782b02932de0caf563f6dc4e7e94b794eadde075ba2cbef9795"},
      {msg::rcl_interfaces_ListParameters::hash,
       "3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d"},
      {msg::rcl_interfaces_GetParameters::hash,
       "bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc"},
      {msg::rcl_interfaces_GetParameterTypes::hash,
       "da199c878688b3e530bdfe3ca8f74cb9fa0c303101e980a9e8f260e25e1c80ca"},
      {msg::rcl_interfaces_DescribeParameters::hash,
       "845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff"},
      {msg::rcl_interfaces_SetParameters::hash,
       "56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0"},
      {msg::rcl_interfaces_SetParametersAtomically::hash,
       "0e192ef259c07fc3c07a13191d27002222e65e00ccec653ca05e856f79285fcd"}};
  for (const auto& [ours, published] : all)
    EXPECT_EQ(ours, "RIHS01_" + std::string(published));
}

TEST(Topics, StreamsLoseNothingInLockstep) {
  for (const qos::Topic& topic :
       {qos::kDeviceState, qos::kContactState, qos::kForceCommand, qos::kValidation}) {
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

/// The prediction is compared with Cyclone DDS, for every pair.
TEST(Profiles, MatchOverRealDdsExactlyAsTabulated) {
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
      pairs.push_back({&offered,
                       &requested,
                       {participant, topic, "pairs", offered},
                       {participant, topic, "pairs", requested}});
    }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  for (const Pair& pair : pairs)
    EXPECT_EQ(pair.writer.matched_count() == 1, matches(*pair.offered, *pair.requested))
        << pair.offered->name << " -> " << pair.requested->name;
}

TEST(Bus, RefusesATypeThatTheTableDoesNotGiveTheTopic) {
  const bus::Participant participant({71, "lo", "qos_test"});
  EXPECT_THROW((bus::Writer<msg::ForceCommand>(participant, qos::kDeviceState, "r",
                                               qos::profile(ProfileId::kStream))),
               bus::Error);
}

TEST(Bus, NamesTheInterfaceThatDoesNotExist) {
  try {
    const bus::Participant participant({72, "no_such_if0", "qos_test"});
    FAIL() << "a participant was made on an interface that does not exist";
  } catch (const bus::Error& error) {
    EXPECT_NE(std::string(error.what()).find("no_such_if0"), std::string::npos) << error.what();
  }
}

TEST(Rosbag2, OverridesNameEveryTopicOfTheLoop) {
  std::ifstream file(VOXTOUCH_QOS_FOLDER "/rosbag2_overrides.yaml");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  ASSERT_FALSE(text.empty());
  for (const Topic& topic : kTopics) {
    const std::string row = "\n/haptic/" + std::string(topic.path) + ":";
    EXPECT_EQ(text.contains(row), topic.rate_hz >= 1000.0) << topic.path;
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
