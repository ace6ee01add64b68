// A role that two play: who is followed, who is fenced, and that nobody calls himself into the
// place of a standby.
#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "nodes/bus/latched_reader.hpp"
#include "nodes/runtime/duty.hpp"
#include "nodes/runtime/role_binding.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/stand_in.hpp"
#include "tests/unit/nodes/node_thread.hpp"

namespace voxtouch::test {
namespace {

using runtime::kActs;
using runtime::kStandsBy;
using runtime::NodeState;

/// A coupling as the real ones are: status and command writer.
struct Coupling : StandIn {
  Coupling(const std::string& rig, const std::string& name = "coupling")
      : StandIn(kDomain, name, rig),
        commands(participant, qos::kForceCommand, rig, qos::profile(qos::ProfileId::kStream)) {}
  void say(std::map<std::string, std::string> words = {}, NodeState state = NodeState::kRunning,
           std::uint64_t session = 7) {
    runtime::NodeReport report;
    report.session_id = session, report.state = state, report.values = std::move(words);
    status.publish(report);
  }
  void name(const StandIn& standby) {
    say({{runtime::kStandby, runtime::to_hex(standby.participant.guid())},
         {runtime::kDuty, kActs}});
  }
  void command(std::uint64_t sequence) {
    msg::ForceCommand m{};
    m.session_id = 7, m.sequence_number = sequence;
    commands.write(m);
  }
  bus::Writer<msg::ForceCommand> commands;
};

class StandbyBinding : public testing::Test {
 protected:
  StandbyBinding() { commands.begin_session(7); }
  void update() { registry.update(), role.update(registry, 7); }
  void settle() {
    for (int i = 0; i < 20; ++i)
      update(), std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  bool comes(const std::function<bool()>& holds) {
    return wait_until([&] { return update(), holds(); });
  }
  /// Sends and takes until it has come; the newest sample that there is is `newest`.
  bool is_taken(Coupling& from, std::uint64_t sequence, std::uint64_t newest = ~std::uint64_t{0}) {
    from.command(sequence);
    msg::ForceCommand taken{};
    for (int i = 0; i < 20; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(5)))
      if (commands.take(taken, nullptr, newest))
        return taken.sequence_number == sequence;
    return false;
  }
  bool pair_is_known(Coupling& acting, Coupling& standby) {
    standby.say({{runtime::kDuty, kStandsBy}}, NodeState::kReady);
    acting.name(standby);
    return comes([&] { return role.standby() == standby.participant.guid(); });
  }

  const std::string rig = own_rig("pair");
  bus::Participant own{{kDomain, "lo", "device"}};
  runtime::NodeRegistry registry{own, rig};
  runtime::PairReader<msg::ForceCommand> commands{own, qos::kForceCommand, rig,
                                                  qos::profile(qos::ProfileId::kStream)};
  runtime::RoleBinding role{"coupling", {}, &commands};
};

TEST_F(StandbyBinding, FollowsTheStandbyWhereTheActingOneFallsSilentAndFencesThatOne) {
  Coupling first(rig), second(rig, "coupling_standby");
  first.say();
  ASSERT_TRUE(comes([&] { return role.participant() == first.participant.guid(); }));
  ASSERT_TRUE(pair_is_known(first, second));
  const std::uint64_t tenure = role.tenure();
  EXPECT_TRUE(is_taken(first, 10));
  EXPECT_FALSE(is_taken(second, 11)) << "the acting one answers";
  EXPECT_TRUE(is_taken(first, 11));
  EXPECT_TRUE(is_taken(second, 15)) << "three samples have been left without an answer";
  EXPECT_FALSE(is_taken(first, 16)) << "fenced";
  EXPECT_TRUE(is_taken(second, 16));
  settle();
  EXPECT_EQ(role.participant(), second.participant.guid());
  EXPECT_EQ(role.standby(), first.participant.guid());
  EXPECT_EQ(role.tenure(), tenure) << "what was begun with the first goes on";
  EXPECT_EQ(role.refused(), 0U) << "who is fenced is no stranger";
  EXPECT_EQ(role.trouble(registry), "");
  runtime::NodeReport report;
  role.report_to(report, registry);
  EXPECT_EQ(runtime::value_of(report.figures, "coupling_takeovers"), 1.0);
  EXPECT_EQ(runtime::value_of(report.figures, "coupling_taken_over_at"), 15.0);
  EXPECT_EQ(runtime::value_of(report.figures, "coupling_fenced_answers"), 2.0);
  EXPECT_NE(report.values["fenced"].find("coupling (process"), std::string::npos)
      << report.values["fenced"];
}

TEST_F(StandbyBinding, KeepsTheStandbyWhereTheActingOneHasGoneAndTakesAnotherBesideIt) {
  auto first = std::make_unique<Coupling>(rig);
  Coupling second(rig, "coupling_standby");
  first->say();
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  ASSERT_TRUE(pair_is_known(*first, second));
  EXPECT_TRUE(is_taken(*first, 10));
  first.reset();
  settle();
  EXPECT_TRUE(role.bound()) << "its standby is there";
  EXPECT_TRUE(is_taken(second, 14));
  second.say({{runtime::kDuty, kActs}});
  ASSERT_TRUE(
      comes([&] { return role.participant() == second.participant.guid() && !role.standby(); }));
  Coupling third(rig);
  third.say({{runtime::kDuty, kStandsBy}});
  second.name(third);
  ASSERT_TRUE(comes([&] { return role.standby() == third.participant.guid(); }));
  EXPECT_TRUE(is_taken(second, 15));
  EXPECT_TRUE(is_taken(third, 19));
}

TEST_F(StandbyBinding, LetsNobodyIntoThePlaceWhoCallsHimselfAStandby) {
  Coupling first(rig), stranger(rig, "coupling_standby");
  first.say();
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  for (const char* duty : {kStandsBy, kActs}) {
    stranger.say({{runtime::kDuty, duty},
                  {runtime::kStandby, runtime::to_hex(stranger.participant.guid())}});
    settle();
    EXPECT_EQ(role.standby(), std::nullopt);
    EXPECT_TRUE(is_taken(first, *duty));
    EXPECT_FALSE(is_taken(stranger, 1000 + *duty)) << "not named by the one that acts";
  }
  EXPECT_TRUE(comes([&] {
    return role.trouble(registry).find("coupling_standby (process") != std::string::npos;
  })) << role.trouble(registry);
  EXPECT_GE(role.refused(), 1U);
}

TEST_F(StandbyBinding, LetsANamedStandbyTakeOverWithNoSampleThatIsNotThereYet) {
  Coupling first(rig), second(rig, "coupling_standby");
  first.say();
  ASSERT_TRUE(comes([&] { return role.bound(); }));
  ASSERT_TRUE(pair_is_known(first, second));
  EXPECT_TRUE(is_taken(first, 10, 10));
  EXPECT_FALSE(is_taken(second, 1'000'000, 11))
      << "it would take over from one that answers each sample";
  EXPECT_TRUE(is_taken(first, 11, 11));
}

TEST_F(StandbyBinding, CountsNothingOfTheActingOneAsAStrangersWhileItsStandbyIsTaken) {
  Coupling first(rig), second(rig, "coupling_standby");
  second.say({{runtime::kDuty, kStandsBy}}, NodeState::kReady);
  first.name(second);
  std::jthread writes_all_the_while([&](const std::stop_token& over) {
    for (std::uint64_t sequence = 10; !over.stop_requested(); ++sequence)
      first.command(sequence);
  });
  for (int i = 0; i < 100; ++i) {
    runtime::PairReader<msg::ForceCommand> read(own, qos::kForceCommand, rig,
                                                qos::profile(qos::ProfileId::kStream));
    runtime::RoleBinding binding("coupling", {}, &read);
    ASSERT_TRUE(wait_until([&] {
      registry.update(), binding.update(registry, 7);
      return binding.standby() == second.participant.guid();
    }));
    EXPECT_EQ(binding.refused(), 0U);
  }
}

TEST_F(StandbyBinding, ShowsTheStandbysLatchedValueOnceItActsAndHasOneOfItsOwn) {
  bus::LatchedReader<msg::ScenePlan> plans(own, qos::kScenePlan, rig);
  runtime::PairReader<msg::ContactState> contacts(own, qos::kContactState, rig,
                                                  qos::profile(qos::ProfileId::kStream));
  contacts.begin_session(7);
  runtime::RoleBinding rendering("rendering", {&plans.following()}, &contacts);
  struct Rendering : StandIn {
    Rendering(const std::string& rig, const std::string& name)
        : StandIn(kDomain, name, rig),
          contacts(participant, qos::kContactState, rig, qos::profile(qos::ProfileId::kStream)),
          plans(participant, qos::kScenePlan, rig, qos::profile(qos::ProfileId::kLatched)) {}
    void plan(double voxel_size_m) {
      static char empty[] = "";
      msg::ScenePlan m{};
      m.session_id = 7, m.voxel_size_m = voxel_size_m;
      m.scene = m.scene_hash = m.contact_model = m.stiffest = m.largest_damping =
          m.largest_damping_place = empty;
      m.largest_turning_damping = m.largest_turning_damping_place = m.torque_effect = empty;
      plans.write(m);
    }
    void contact(std::uint64_t sequence) {
      msg::ContactState m{};
      m.session_id = 7, m.sequence_number = sequence;
      contacts.write(m);
    }
    bus::Writer<msg::ContactState> contacts;
    bus::Writer<msg::ScenePlan> plans;
  };
  Rendering first(rig, "rendering"), second(rig, "rendering_standby");
  double shown = 0.0;
  const auto look = [&] {
    registry.update(), rendering.update(registry, 7);
    plans.take([&](const msg::ScenePlan& plan) { shown = plan.voxel_size_m; });
  };
  first.say(7), first.plan(1.0);
  ASSERT_TRUE(wait_until([&] { return look(), shown == 1.0; }));
  runtime::NodeReport report;
  report.session_id = 7, report.state = NodeState::kReady;
  second.status.publish(report);
  report.state = NodeState::kRunning,
  report.values = {{runtime::kStandby, runtime::to_hex(second.participant.guid())}};
  first.status.publish(report);
  ASSERT_TRUE(wait_until([&] { return look(), rendering.standby() == second.participant.guid(); }));
  msg::ContactState taken{};
  ASSERT_TRUE(wait_until([&] { return first.contact(10), contacts.take(taken); }));
  ASSERT_TRUE(wait_until([&] { return second.contact(14), contacts.take(taken); }));
  for (int i = 0; i < 20; ++i)
    look(), std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(rendering.participant(), second.participant.guid());
  EXPECT_TRUE(plans.current()) << "the one that is known holds until the other has come";
  EXPECT_EQ(shown, 1.0);
  second.plan(2.0);
  bool always_current = true;
  EXPECT_TRUE(wait_until(
      [&] { return look(), always_current = always_current && plans.current(), shown == 2.0; }));
  EXPECT_TRUE(always_current) << "the coupling would answer nothing meanwhile";
  first.plan(3.0);
  for (int i = 0; i < 20; ++i)
    look(), std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(shown, 2.0) << "the first is not followed any more";
}

/// The node's own side: who it names, and when it falls silent.
class DutyTest : public testing::Test {
 protected:
  using Duty = runtime::Duty<msg::ForceCommand>;
  struct Node {
    Node(const std::string& rig, const std::string& name, const runtime::StandbyOptions& options)
        : participant({kDomain, "lo", name}),
          registry(participant, rig),
          status(participant, name, rig),
          commands(participant, qos::kForceCommand, rig, qos::profile(qos::ProfileId::kStream)),
          duty(participant, qos::kForceCommand, rig, "coupling", options, {{"scene_hash"}, {}}) {}
    std::string look() {
      registry.update();
      runtime::NodeReport report;
      report.session_id = 7, report.state = state, report.values = {{"scene_hash", scene}};
      const std::string said = duty.look(registry, report);
      words = report.values;
      status.publish(report);
      return said;
    }
    bool answer(std::uint64_t sequence) {
      if (!duty.acts(7, sequence, [](const msg::ForceCommand&) {}))
        return false;
      msg::ForceCommand m{};
      m.session_id = 7, m.sequence_number = sequence;
      return commands.write(m);
    }
    bus::Participant participant;
    runtime::NodeRegistry registry;
    runtime::StatusWriter status;
    bus::Writer<msg::ForceCommand> commands;
    Duty duty;
    std::string scene = "a";
    NodeState state = NodeState::kRunning;
    std::map<std::string, std::string> words;
  };
  bool are_a_pair(Node& first, Node& second) {
    return wait_until([&] {
      first.look();
      return second.look().starts_with("stands by for") &&
             first.words[runtime::kStandby] == runtime::to_hex(second.participant.guid());
    });
  }
  void look_for_a_while(Node& first, Node& second) {
    for (int i = 0; i < 30; ++i)
      first.look(), second.look(), std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const std::string rig = own_rig("duty");
};

TEST_F(DutyTest, TakesOverAndGivesBackAsTheOtherOneFallsSilent) {
  Node first(rig, "coupling", {}), second(rig, "coupling_standby", {.is_standby = true});
  ASSERT_TRUE(are_a_pair(first, second));
  const auto let_it_come = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
  std::uint64_t n = 0;
  for (; n < 20; ++n) {
    EXPECT_TRUE(first.answer(n));
    let_it_come();
    EXPECT_FALSE(second.answer(n));
  }
  const std::uint64_t lost = n - 1;
  while (!second.answer(n))
    ++n;
  EXPECT_EQ(n, lost + 4);
  EXPECT_TRUE(second.duty.acts_now());
  let_it_come();
  EXPECT_FALSE(first.answer(n)) << "the other one answers";
  EXPECT_FALSE(first.duty.acts_now());
  EXPECT_TRUE(second.answer(++n));
  ASSERT_TRUE(are_a_pair(second, first)) << "and it stands by from here on";
  const std::uint64_t lost_again = n;
  let_it_come();
  while (!first.answer(n))
    ++n;
  EXPECT_EQ(n, lost_again + 4);
}

TEST_F(DutyTest, TakesNoStandbyThatComesLateOrThatIsNotAsItIs) {
  Node first(rig, "coupling", {}), other(rig, "coupling_standby", {.is_standby = true});
  other.scene = "b";
  look_for_a_while(first, other);
  EXPECT_EQ(first.words.count(runtime::kStandby), 0U) << "another scene";
  other.scene = "a", other.state = NodeState::kStarting;
  look_for_a_while(first, other);
  EXPECT_EQ(first.words.count(runtime::kStandby), 0U) << "not ready";
  for (std::uint64_t n = 0; n < runtime::kFirstAnswers; ++n)
    EXPECT_TRUE(first.answer(n));
  other.state = NodeState::kReady;
  look_for_a_while(first, other);
  EXPECT_EQ(first.words.count(runtime::kStandby), 0U) << "too late";
  EXPECT_NE(other.look().find("this node"), std::string::npos);
  for (std::uint64_t n = 2000; n < 2100; ++n)
    EXPECT_FALSE(other.answer(n)) << "nobody has named it";
}

TEST_F(DutyTest, SaysAndReadsNothingWhereNoStandbyIsTaken) {
  Node first(rig, "coupling", {.takes = runtime::TakesStandby::kNever}),
      other(rig, "coupling_standby", {.is_standby = true});
  look_for_a_while(first, other);
  EXPECT_EQ(first.words.size(), 1U);
  EXPECT_EQ(first.commands.matched_count(), 1U) << "of the other one alone";
  EXPECT_TRUE(first.answer(5));
  EXPECT_TRUE(first.answer(50));
}

TEST_F(DutyTest, DoesNotStandBackForARivalThatKnowsOfNoStandby) {
  Coupling rival(rig);
  Node first(rig, "coupling", {});
  rival.say();
  ASSERT_TRUE(wait_until([&] {
    return first.look(),
           first.registry.find("coupling").has_value() && first.registry.reports().size() == 2;
  }));
  for (int i = 0; i < 10; ++i)
    first.look();
  EXPECT_TRUE(first.answer(1));
  EXPECT_EQ(first.words.count(runtime::kDuty), 0U);
}

TEST_F(DutyTest, StandsByFromItsFirstAnswerOnWhereTheStandbyActsAlready) {
  Node standby(rig, "coupling_standby", {.is_standby = true});
  auto first = std::make_unique<Node>(rig, "coupling", runtime::StandbyOptions{});
  ASSERT_TRUE(are_a_pair(*first, standby));
  ASSERT_TRUE(first->answer(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(standby.answer(1));
  first.reset();
  EXPECT_FALSE(standby.answer(2));
  ASSERT_TRUE(standby.answer(5));
  Node again(rig, "coupling", {});
  ASSERT_TRUE(wait_until([&] {
    standby.look(), again.look();
    return again.registry.find("coupling_standby").has_value() &&
           again.words.count(runtime::kDuty) == 1;
  }));
  EXPECT_FALSE(again.answer(6));
  EXPECT_TRUE(are_a_pair(standby, again));
}

}  // namespace
}  // namespace voxtouch::test
