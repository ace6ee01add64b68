// Role bindings: which status counts, which writer a reader follows, and which participant is
// named.
#include "nodes/runtime/role_binding.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cstring>
#include <vector>

#include "nodes/bus/followed_reader.hpp"
#include "nodes/bus/latched_reader.hpp"
#include "nodes/runtime/node_monitor.hpp"
#include "nodes/runtime/participation.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using runtime::NodeRegistry;
using runtime::NodeState;
const qos::Profile& stream() { return qos::profile(qos::ProfileId::kStream); }

class RoleTest : public testing::Test {
 protected:
  /// Waits for written samples to arrive.
  void settle() {
    for (int i = 0; i < 20; ++i)
      update(), std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  void update() {
    registry.update();
    role.update(registry, 7);
  }
  bool comes(const std::function<bool()>& holds) {
    return wait_until([&] { return update(), holds(); });
  }
  /// A coupling as the real ones are: status and command writer.
  struct Coupling : StandIn {
    explicit Coupling(const std::string& rig)
        : StandIn(kDomain, "coupling", rig),
          commands(participant, qos::kForceCommand, rig, stream()) {}
    void command(std::uint64_t sequence) {
      msg::ForceCommand m{};
      m.sequence_number = sequence;
      commands.write(m);
    }
    bus::Writer<msg::ForceCommand> commands;
  };

  const std::string rig = own_rig("role");
  bus::Participant own{{kDomain, "lo", "device"}};
  runtime::NodeRegistry registry{own, rig};
  bus::FollowedReader<msg::ForceCommand> commands{own, qos::kForceCommand, rig, stream()};
  runtime::RoleBinding role{"coupling", {&commands.following()}};
};

/// In a ring that was started by hand.
TEST_F(RoleTest, IsBoundToTheFirstClaimantForTheSession) {
  auto first = std::make_unique<Coupling>(rig);
  first->say(8), settle();
  EXPECT_FALSE(role.bound()) << "he answers for another session";
  first->say(7);
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  EXPECT_EQ(role.participant(), first->participant.guid());
  EXPECT_EQ(role.diagnostic(registry), "");
  Coupling second(rig);
  second.say(7);
  ASSERT_TRUE(comes([&] { return !role.diagnostic(registry).empty(); }));
  EXPECT_EQ(role.participant(), first->participant.guid());
  first->say(8), settle();
  EXPECT_EQ(role.participant(), first->participant.guid()) << "a session more is no reason";
  first.reset();
  ASSERT_TRUE(comes([&] { return !role.bound(); }));
  EXPECT_EQ(role.lost_session(), 7U);
  settle();
  EXPECT_FALSE(role.bound()) << "no rebinding within a session";
  EXPECT_NE(role.diagnostic(registry).find("the session is over"), std::string::npos)
      << role.diagnostic(registry);
  second.say(9);
  ASSERT_TRUE(wait_until([&] {
    return registry.update(), role.update(registry, 9),
           role.participant() == second.participant.guid();
  })) << "another session";
  EXPECT_EQ(role.lost_session(), 0U);
  EXPECT_EQ(role.diagnostic(registry), "")
      << "a bound participant is not unauthorised, even if it was before";
}

/// In a ring that `voxtouch up` started.
class ClaimedRole : public RoleTest {
 protected:
  bool comes(const std::function<bool()>& holds) {
    return wait_until([&] { return claimed.update(), role.update(claimed, 7), holds(); });
  }
  void settle() {
    for (int i = 0; i < 20; ++i)
      claimed.update(), role.update(claimed, 7),
          std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  static std::pair<std::string, bus::Guid> playing(const Coupling& one) {
    return {"coupling", one.participant.guid()};
  }
  StandInUp up{kDomain, rig}, other{kDomain, rig};
  runtime::NodeRegistry claimed{own, rig, up.participant.guid()};
};

TEST_F(ClaimedRole, GoesOnlyToParticipantsThatTheClaimNames) {
  auto real = std::make_unique<Coupling>(rig);
  Coupling unauthorised(rig);
  real->say(7), unauthorised.say(7), settle();
  EXPECT_FALSE(role.bound()) << "none is named yet";
  other.name({playing(unauthorised)}), settle();
  EXPECT_FALSE(role.bound()) << "the claim of a participant that has not started this node";
  up.name({playing(*real)});
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  EXPECT_EQ(role.participant(), real->participant.guid());
  real.reset();  // as one that hangs for longer than its lease
  ASSERT_TRUE(comes([&] { return !role.bound(); }));
  unauthorised.say(7), settle();
  EXPECT_FALSE(role.bound()) << "an unauthorised participant took the role of a node that was lost";
  Coupling again(rig);
  again.say(7), up.name({playing(again)});
  ASSERT_TRUE(comes([&] { return role.bound(); }))
      << "one that `up` started again, within the session";
  EXPECT_EQ(role.participant(), again.participant.guid());
}

TEST(RigRoles, WritesAGuidAsTextAndReadsItBack) {
  bus::Guid guid{};
  for (std::size_t i = 0; i < guid.size(); ++i)
    guid[i] = static_cast<std::uint8_t>(17 * i + 1);
  EXPECT_EQ(runtime::to_guid(runtime::to_text(guid)), guid);
  for (const char* text :
       {"", "01", "zz000000000000000000000000000000", "0011223344556677889900112233445"})
    EXPECT_EQ(runtime::to_guid(text), bus::Guid{});
}

TEST_F(RoleTest, IsUnboundAndNamesBothConflictingClaimants) {
  auto first = std::make_unique<Coupling>(rig);
  Coupling second(rig);
  registry.update();  // not polled while they arrive
  first->say(7), second.say(7);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  update();
  EXPECT_FALSE(role.bound());
  const std::string diagnostic = role.diagnostic(registry);
  EXPECT_NE(diagnostic.find("(process", diagnostic.find("(process") + 1), std::string::npos)
      << "both are named: " << diagnostic;
  first->command(1), second.command(1), settle();
  msg::ForceCommand command;
  EXPECT_FALSE(commands.take(command));
  first.reset();
  ASSERT_TRUE(comes([&] { return role.participant() == second.participant.guid(); }));
  EXPECT_EQ(role.diagnostic(registry), "");
}

TEST_F(RoleTest, IsNotClaimedByAnotherParticipantsStatus) {
  Coupling real(rig);
  real.say(7, NodeState::kFailed);
  Adversary bag(kDomain, rig);
  bag.writer<msg::ForceCommand>();
  ASSERT_TRUE(comes([&] { return registry.report_of(real.participant.guid()) != nullptr; }));
  ASSERT_TRUE(wait_until([&] { return bag.writer<msg::NodeStatus>().matched_count() >= 1; }));
  bus::Guid gone{};
  gone[3] = 9;
  bag.claim("coupling", 7, msg::node_status::kStateRunning, gone);
  bag.claim("coupling", 7, msg::node_status::kStateRunning, real.participant.guid());
  ASSERT_TRUE(comes([&] { return registry.refused() >= 2; }));
  settle();
  EXPECT_FALSE(role.bound());
  EXPECT_EQ(registry.report_of(real.participant.guid())->state, NodeState::kFailed)
      << "his own word stands";
  EXPECT_EQ(registry.reports().size(), 1U);
}

TEST_F(RoleTest, ClaimNeedsASessionAndOneOfItsTopics) {
  runtime::RoleBinding any("coupling", {&commands.following()});
  StandIn talker(kDomain, "coupling", rig);
  Coupling real(rig);
  talker.say(7), real.say(0);
  ASSERT_TRUE(comes([&] { return registry.reports().size() == 2; }));
  for (int i = 0; i < 20; ++i)
    update(), any.update(registry, std::nullopt),
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(role.bound()) << "by a status alone";
  EXPECT_FALSE(any.bound()) << "without a session, or by a status alone";
  real.say(7);
  ASSERT_TRUE(
      comes([&] { return any.update(registry, std::nullopt), role.bound() && any.bound(); }));
  EXPECT_EQ(role.participant(), real.participant.guid());
  EXPECT_EQ(any.participant(), real.participant.guid());
}

TEST_F(RoleTest, FollowsAnotherWriterOfTheSameParticipant) {
  Coupling real(rig);
  real.say(7);
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  real.commands = {};
  ASSERT_TRUE(comes([&] { return !commands.following().has_matched(real.participant.guid()); }));
  real.commands = {real.participant, qos::kForceCommand, rig, stream()};
  msg::ForceCommand taken{};
  EXPECT_TRUE(comes([&] { return real.command(1), commands.take(taken); }));
  EXPECT_EQ(role.participant(), real.participant.guid());
}

TEST_F(RoleTest, AcceptsOnlyItsHolderAndNamesOthers) {
  Coupling real(rig);
  real.say(7);
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  auto other = std::make_unique<Adversary>(kDomain, rig);
  ASSERT_TRUE(wait_until([&] { return other->writer<msg::ForceCommand>().matched_count() >= 1; }));
  msg::ForceCommand foreign{}, taken{};
  foreign.sequence_number = 666;
  real.command(1);
  for (int i = 0; i < 10'000; ++i)
    other->write(foreign);  // one history for all, if it were requested
  ASSERT_TRUE(comes([&] { return role.refused() > 100; }));
  ASSERT_TRUE(wait_until([&] { return commands.take(taken); })) << "pushed out by the foreign ones";
  EXPECT_EQ(taken.sequence_number, 1U);
  EXPECT_FALSE(commands.take(taken));
  ASSERT_TRUE(comes([&] { return other->write(foreign), !role.diagnostic(registry).empty(); }));
  EXPECT_NE(role.diagnostic(registry).find("unnamed"), std::string::npos)
      << role.diagnostic(registry);
  other.reset();
  EXPECT_TRUE(comes([&] { return role.diagnostic(registry).empty(); }));
  real.command(2);
  EXPECT_TRUE(wait_until([&] { return commands.take(taken); }));
}

TEST_F(RoleTest, CountsWhatItRefusesOfEachWriter) {
  Coupling real(rig);
  real.say(7);
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  Adversary bag(kDomain, rig), tool(kDomain, rig);
  for (Adversary* one : {&bag, &tool})
    ASSERT_TRUE(wait_until([&] { return one->writer<msg::ForceCommand>().matched_count() >= 1; }));
  for (int n = 0; n < 30; ++n)
    bag.write(msg::ForceCommand{});
  for (int n = 0; n < 7; ++n)
    tool.write(msg::ForceCommand{});
  const auto of = [](int count, const Adversary& one) {
    return fmt::format("{} of an unnamed participant ({})", count,
                       runtime::to_text(one.participant().guid()));
  };
  EXPECT_TRUE(comes([&] {
    const std::string reported = role.refused_writers();
    return reported.contains(of(30, bag)) && reported.contains(of(7, tool));
  })) << role.refused_writers();
  EXPECT_EQ(role.refused(), 37U);
}

TEST_F(RoleTest, GivesTheNewestSampleAfterAPause) {
  Coupling real(rig);
  real.say(7);
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  for (std::uint64_t i = 1; i <= 20; ++i)
    real.command(i), std::this_thread::sleep_for(std::chrono::milliseconds(1));
  settle();
  msg::ForceCommand taken{};
  ASSERT_TRUE(commands.take(taken));
  EXPECT_EQ(taken.sequence_number, 20U) << "a loop that stood still would answer what is over";
}

TEST_F(RoleTest, HasItsLatchedValueFromBeforeTheBinding) {
  bus::LatchedReader<msg::DeviceDescription> descriptions(own, qos::kDeviceDescription, rig);
  StandIn real(kDomain, "device", rig);
  bus::Writer<msg::DeviceDescription> writer(real.participant, qos::kDeviceDescription, rig,
                                             qos::profile(qos::ProfileId::kLatched));
  writer.write(stylus(7));
  std::uint64_t seen = 0;
  const auto poll = [&] {
    return descriptions.take([&](const msg::DeviceDescription& d) { seen = d.session_id; });
  };
  ASSERT_TRUE(wait_until([&] { return descriptions.matched_count() == 1; }));
  for (int i = 0; i < 20; ++i)
    poll(), std::this_thread::sleep_for(std::chrono::milliseconds(10));
  Adversary other(kDomain, rig);
  ASSERT_TRUE(
      wait_until([&] { return other.writer<msg::DeviceDescription>().matched_count() == 1; }));
  for (std::uint64_t i = 0; i < 200; ++i)
    other.write(stylus(1000 + i)), poll();
  EXPECT_EQ(seen, 0U) << "none is followed yet";
  ASSERT_TRUE(descriptions.following().follow(real.participant.guid()));
  EXPECT_FALSE(descriptions.current());
  EXPECT_TRUE(poll());
  EXPECT_EQ(seen, 7U);
  EXPECT_TRUE(descriptions.current());
  writer.write(stylus(7));
  other.write(stylus(2000));
  for (int i = 0; i < 20; ++i)
    EXPECT_FALSE(poll()) << "the same again is nothing new",
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
  writer.write(stylus(8));
  EXPECT_TRUE(wait_until(poll));
  EXPECT_EQ(seen, 8U);
}

TEST_F(RoleTest, RosterReceivesTheNodesDuringAFlood) {
  Adversary flood(kDomain, rig);
  StandIn node(kDomain, "rendering", rig);
  ASSERT_TRUE(wait_until([&] { return flood.writer<msg::NodeStatus>().matched_count() >= 1; }));
  NodeThread writer([&](const std::atomic<bool>& stop) {
    for (std::uint64_t i = 1; !stop.load(); ++i)
      flood.claim("device", i);
    return 0;
  });
  ASSERT_TRUE(wait_until([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    registry.update();
    const auto before = registry.refused();
    const auto* report = registry.report_of(flood.guid());
    const auto last = report ? report->session_id : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    registry.update();
    report = registry.report_of(flood.guid());
    return report && report->session_id == last && registry.refused() == before;
  })) << "it is listened to for ever";
  for (std::uint64_t session = 1; session <= 20; ++session) {
    node.say(session);
    ASSERT_TRUE(wait_until([&] {
      registry.update();
      const auto* report = registry.report_of(node.participant.guid());
      return report && report->session_id == session;
    })) << session;
  }
}

TEST_F(RoleTest, RosterRefusesOversizedTextsAndForgetsGoneNodes) {
  auto other = std::make_unique<Adversary>(kDomain, rig);
  ASSERT_TRUE(wait_until([&] { return other->writer<msg::NodeStatus>().matched_count() >= 1; }));
  other->claim("tool", 1);
  ASSERT_TRUE(comes([&] { return registry.reports().size() == 1; }));
  other->claim("tool", 2, 1, other->guid(), std::string(11'000'000, 'x'));
  ASSERT_TRUE(comes([&] { return registry.refused() == 1; }));
  EXPECT_EQ(registry.reports().at(0).session_id, 1U);
  other.reset();
  EXPECT_TRUE(comes([&] { return registry.reports().empty(); }));
  for (int i = 0; i < 5; ++i) {
    Adversary passing(kDomain, rig);
    passing.claim("up", 1);
    ASSERT_TRUE(wait_until([&] { return passing.writer<msg::NodeStatus>().matched_count() >= 1; }));
  }
  EXPECT_TRUE(wait_until([&] {
    registry.update([](const runtime::NodeReport& report) { return report.node == "device"; });
    return registry.reports().empty();
  })) << "only a child's last word is kept";
}

/// A status with one property that no real node has.
struct Unlikely {
  const char* what;
  std::size_t name = 4, values = 0, figures = 0, key = 3, value = 3, unit = 1;
};
const Unlikely kUnlikely[] = {
    {.what = "name", .name = 257},
    {.what = "count of words", .values = NodeRegistry::kMaxValues + 1},
    {.what = "count of figures", .figures = NodeRegistry::kMaxValues + 1},
    {.what = "name of a word", .values = 1, .key = 257},
    {.what = "word", .values = 1, .value = NodeRegistry::kMaxTextBytes + 1},
    {.what = "name of a figure", .figures = 1, .key = 257},
    {.what = "unit", .figures = 1, .unit = 257}};

void write(Adversary& writer, const Unlikely& u, std::uint64_t session) {
  std::string name(u.name, 'n'), host = "elsewhere", key(u.key, 'k'), value(u.value, 'v'),
                                 unit(u.unit, 'u'), message = "well";
  std::vector<msg::diagnostic_msgs_KeyValue> values(u.values, {key.data(), value.data()});
  std::vector<msg::Figure> figures(u.figures, {key.data(), unit.data(), 1.0});
  msg::NodeStatus status{};
  status.node = name.data(), status.host = host.data(), status.message = message.data();
  std::memcpy(status.participant, writer.guid().data(), writer.guid().size());
  status.session_id = session;
  status.values._buffer = values.data(),
  status.values._length = status.values._maximum = static_cast<std::uint32_t>(values.size());
  status.figures._buffer = figures.data(),
  status.figures._length = status.figures._maximum = static_cast<std::uint32_t>(figures.size());
  writer.write(status);
}

TEST_F(RoleTest, RosterRefusesImpossibleReportsAndTheirWriter) {
  std::uint64_t refused = 0;
  for (const Unlikely& unlikely : kUnlikely) {
    SCOPED_TRACE(unlikely.what);
    Adversary other(kDomain, rig);
    ASSERT_TRUE(wait_until([&] { return other.writer<msg::NodeStatus>().matched_count() >= 1; }));
    write(other, {.what = "", .values = 1, .figures = 1}, 1);
    ASSERT_TRUE(comes([&] { return registry.report_of(other.guid()) != nullptr; }));
    write(other, unlikely, 2);
    ASSERT_TRUE(comes([&] { return registry.refused() > refused; }));
    EXPECT_EQ(registry.report_of(other.guid())->session_id, 1U);
    refused = registry.refused();
    write(other, {.what = ""}, 3), settle();
    EXPECT_EQ(registry.report_of(other.guid())->session_id, 1U) << "it is listened to again";
  }
}

TEST_F(RoleTest, RosterIsLimitedButKeepsKnownNodes) {
  StandIn known(kDomain, "rendering", rig);
  known.say(1);
  Coupling real(rig);
  real.say(7);
  ASSERT_TRUE(comes(
      [&] { return role.bound() && registry.report_of(known.participant.guid()) != nullptr; }));
  std::vector<std::unique_ptr<Adversary>> crowd;
  for (std::size_t n = 0; n < NodeRegistry::kMaxNodes + 2; ++n) {
    crowd.push_back(std::make_unique<Adversary>(kDomain, rig));
    ASSERT_TRUE(
        wait_until([&] { return crowd.back()->writer<msg::NodeStatus>().matched_count() >= 1; }));
    crowd.back()->claim("coupling", 7);
    update();
  }
  ASSERT_TRUE(comes([&] { return registry.refused() >= 4; }));
  EXPECT_EQ(registry.reports().size(), NodeRegistry::kMaxNodes);
  known.say(2);
  EXPECT_TRUE(comes([&] { return registry.report_of(known.participant.guid())->session_id == 2; }));
  EXPECT_EQ(role.participant(), real.participant.guid());
  const std::string diagnostic = role.diagnostic(registry);
  std::size_t named = 1;
  for (std::size_t at = diagnostic.find(" and "); at != std::string::npos;
       at = diagnostic.find(" and ", at + 1))
    ++named;
  EXPECT_EQ(named, 16U) << "a person reads it, and it is sent ten times a second";
}

TEST_F(RoleTest, StatusesOfOurOwnAreCutToWhatARegistryAccepts) {
  StandIn node(kDomain, "rendering", rig);
  runtime::NodeReport report;
  report.session_id = 5, report.message = std::string(3000, 'm'),
  report.values["word"] = std::string(3000, 'w');
  node.status.publish(report);
  ASSERT_TRUE(comes([&] { return registry.report_of(node.participant.guid()) != nullptr; }));
  EXPECT_EQ(registry.report_of(node.participant.guid())->message.size(),
            NodeRegistry::kMaxTextBytes);
  EXPECT_EQ(registry.report_of(node.participant.guid())->values.at("word").size(),
            NodeRegistry::kMaxTextBytes);
  EXPECT_EQ(registry.refused(), 0U);
}

TEST_F(RoleTest, RosterForgetsVanishedNodesAfterAWhile) {
  for (int n = 0; n < 20; ++n) {
    StandIn passing(kDomain, "passing" + std::to_string(n), rig);
    passing.say(1);
    ASSERT_TRUE(comes([&] { return registry.report_of(passing.participant.guid()) != nullptr; }));
  }
  ASSERT_TRUE(comes([&] { return registry.reports().empty(); }));
  for (int i = 0; i < 60; ++i)
    update(), std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(registry.hung().size(), 16U);
  EXPECT_TRUE(comes([&] { return registry.hung().empty(); })) << "after 10 s";
}

/// A coupling in lockstep with a device and a rendering, which send as long as the test needs.
class LockstepPeers : public testing::Test {
 protected:
  LockstepPeers() {
    options.rig = rig, options.lockstep = true, options.peers = {"rendering", "coupling"};
    session.begin(7);
    coupling.emplace(own, "coupling", options,
                     [this](runtime::NodeRegistry& registry, runtime::NodeReport& report) {
                       session.report_to(report, options, registry, links, "", true);
                       peers = report.lockstep_peers.size();
                     });
  }
  /// Time passes in which `speaking` give signs of life; until it is over or the coupling has lost
  /// a peer.
  bool loses_a_peer(std::vector<StandIn*> speaking,
                    std::chrono::milliseconds within = std::chrono::seconds(7)) {
    return wait_until(
        [&] {
          for (StandIn* node : speaking)
            node->say(7);
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
          return coupling->peer_lost();
        },
        within);
  }
  bool starts() {
    return wait_until([&] { return device->say(7), rendering->say(7), peers == 3; });
  }

  const std::string rig = own_rig("peers");
  runtime::NodeOptions options;
  bus::Participant own{{kDomain, "lo", "coupling"}};
  runtime::Session session;
  std::atomic<std::size_t> peers{0};
  std::optional<StandIn> device{std::in_place, kDomain, "device", rig},
      rendering{std::in_place, kDomain, "rendering", rig};
  const std::vector<runtime::Link> links{
      {"contacts",
       [guid = rendering->participant.guid()] { return std::vector{guid}; },
       {"rendering"}}};
  std::optional<runtime::NodeMonitor> coupling;
};

TEST_F(LockstepPeers, ExcludeUnauthorisedNamesakes) {
  ASSERT_TRUE(starts());
  StandIn silent(kDomain, "rendering", rig), of_own_name(kDomain, "coupling", rig);
  std::optional<StandIn> passing(std::in_place, kDomain, "device", rig);
  silent.say(7), of_own_name.say(7), passing->say(7);
  runtime::NodeRegistry registry(own, rig);
  EXPECT_TRUE(wait_until([&] {
    device->say(7), rendering->say(7);
    registry.update();
    for (const auto& report : registry.reports())
      if (report.participant == own.guid() &&
          report.message.find("rendering hangs") != std::string::npos)
        return true;
    return false;
  })) << "who it is is said";
  passing.reset();  // without a last word
  EXPECT_FALSE(loses_a_peer({&*device, &*rendering})) << "unauthorised participants ended the run";
  EXPECT_TRUE(loses_a_peer({&*device, &silent}))
      << "the unauthorised participant kept the peer alive";
}

TEST_F(LockstepPeers, ExcludeOtherSessionsUnlinkedAndNamesakes) {
  StandIn of_another(kDomain, "device", rig), unlinked(kDomain, "rendering", rig),
      namesake(kDomain, "coupling", rig);
  of_another.say(8), unlinked.say(7), namesake.say(7);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  ASSERT_TRUE(wait_until([&] { return device->say(7), rendering->say(7), peers >= 3; })) << peers;
  EXPECT_FALSE(loses_a_peer({&*device, &*rendering})) << "these fell silent before the start";
}

TEST_F(LockstepPeers, AreMissedDespiteANamesake) {
  ASSERT_TRUE(starts());
  StandIn unauthorised(kDomain, "device", rig);
  unauthorised.say(7);
  device.reset();  // without a last word
  EXPECT_TRUE(loses_a_peer({&*rendering, &unauthorised}));
}

TEST_F(LockstepPeers, AreNotMissedAfterTheirFinalReport) {
  ASSERT_TRUE(starts());
  device->say(7, NodeState::kStopped);
  device.reset();
  EXPECT_FALSE(loses_a_peer({&*rendering}));
}

}  // namespace
}  // namespace voxtouch::test
