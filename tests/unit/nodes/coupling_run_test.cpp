// The coupling node alone, once it is designed: contacts that come twice or out of order, the lock
// at zero force, and standing by.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "nodes/runtime/standby.hpp"
#include "tests/unit/nodes/around_coupling.hpp"

namespace voxtouch::test::around_coupling {
namespace {

/// Such a number may be forged with the rendering's own GUID, which DDS without security cannot
/// tell from the rightful one.
TEST(CouplingNode, FeelsTheContactsThatFollowOneWithANumberFarAhead) {
  Around a("{design: auto}");
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  const std::uint64_t next = std::exchange(a.sequence, std::uint64_t{1} << 40);
  a.touch();
  a.sequence = next;
  EXPECT_TRUE(a.force_comes()) << a.message();
}

/// DDS makes a write anew that it could not end in time, and who had it already has it twice.
/// Answered twice, the filter would be a step ahead.
TEST(CouplingNode, AnswersAContactThatComesTwiceOnceInLockstep) {
  Around a("{design: auto}", true);
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  std::this_thread::sleep_for(milliseconds(200));
  a.look(), a.forces.clear();
  for (int n = 0; n < 50; ++n) {
    a.touch();
    --a.sequence;
    a.touch();
  }
  std::this_thread::sleep_for(milliseconds(200));
  a.look();
  EXPECT_EQ(a.forces.size(), 50U);
}

/// A contact that pushes only on the way out gives energy at each stroke.
TEST(CouplingNode, LocksItselfAtZeroWhereAContactGivesEnergyAndWaitsForAPersonsWord) {
  Around a("{kind: shaping_filter, cutoff_hz: 20}");
  bus::Writer<msg::Recover> person(a.participant, qos::kRecover, a.rig,
                                   qos::profile(qos::ProfileId::kEvent));
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  const auto lock = [&] {
    a.registry.update();
    const auto report = a.registry.find("coupling");
    const auto number =
        report ? report->values.find("lock") : std::map<std::string, std::string>::iterator{};
    return report && number != report->values.end() ? std::stoull(number->second) : 0;
  };
  for (int n = 0; n < 90; ++n)
    a.touch(-kDepth * (1.0 + 0.1 * n), 0.0);
  for (int stroke = 0; stroke < 20 && lock() == 0; ++stroke)
    for (int n = 0; n < 200; ++n)
      a.touch(-kDepth * (n < 100 ? 10 - 0.1 * n : 0.1 * (n - 100)), n < 100 ? 3.0 : 0.0);
  const std::uint64_t number = lock();
  ASSERT_NE(number, 0U) << a.message() << "; the lowest account was "
                        << a.registry.find("coupling")->figures["lowest_energy_j"].value << " J of "
                        << a.registry.find("coupling")->figures["energy_bound_j"].value;
  EXPECT_NE(a.message().find("voxtouch recover"), std::string::npos) << a.message();
  for (int n = 0; n < 20; ++n)
    a.touch();
  a.forces.clear();
  person.write(msg::Recover{7, number + 1});
  person.write(msg::Recover{8, number});
  for (int n = 0; n < 300; ++n)
    a.touch();
  ASSERT_GT(a.forces.size(), 200U) << "the ring goes on";
  EXPECT_EQ(*std::ranges::max_element(a.forces), 0.0)
      << "another lock's number, or another session's";
  person.write(msg::Recover{7, number});
  EXPECT_TRUE(a.force_comes()) << a.message();
  EXPECT_EQ(lock(), 0U);
}

/// One stroke that gives energy: six times what a sound contact shows and more, but little; and
/// much, but less than five times that.
TEST(CouplingNode, LocksItselfForNothingThatIsLittleOrLessThanFiveTimesWhatIsSound) {
  struct Stroke {
    double force_n, voxel_m;
    bool is_little;
  };
  for (const Stroke& stroke : {Stroke{0.4, 0.0, true}, Stroke{3.0, 1.5e-3, false}}) {
    SCOPED_TRACE(stroke.force_n);
    Around a("{kind: shaping_filter, cutoff_hz: 20}");
    const Around::Demand demand{0.0, 0.0, ""};
    msg::ScenePlan plan = Around::message_of(30.0, 7, demand);
    plan.voxel_size_m = stroke.voxel_m;
    a.describe(20.0), a.plans.write(plan), a.rendering->say(7);
    ASSERT_TRUE(a.force_comes()) << a.message();
    for (int n = 0; n < 90; ++n)
      a.touch(-kDepth * (1.0 + 0.1 * n), 0.0);
    for (int n = 0; n < 100; ++n)
      a.touch(-kDepth * (10 - 0.1 * n), stroke.force_n);
    const auto figures = [&] {
      a.registry.update();
      const auto report = a.registry.find("coupling");
      return report ? report->figures : runtime::Figures();
    };
    ASSERT_TRUE(wait_until(
        [&] { return figures()["samples"].value >= static_cast<double>(a.sequence) - 20.0; }));
    const double debt_j = -figures()["lowest_energy_j"].value,
                 bound_j = figures()["energy_bound_j"].value;
    EXPECT_EQ(debt_j < 0.01, stroke.is_little) << debt_j;
    EXPECT_EQ(debt_j > 5.0 * bound_j, stroke.is_little) << debt_j << " J of " << bound_j;
    EXPECT_GT(debt_j, bound_j);
    EXPECT_EQ(figures()["locks"].value, 0.0) << a.message();
  }
}

/// Another coupling acts, and falls silent: this one goes on with the force at hand, or with its
/// lock.
TEST(CouplingNode, StandsByWithTheForceAndTheLockOfTheOneThatActs) {
  for (const bool locked : {false, true}) {
    SCOPED_TRACE(locked);
    Around a("{kind: shaping_filter, cutoff_hz: 20}", false, true);
    StandIn acting(kDomain, "coupling", a.rig);
    bus::Writer<msg::ForceCommand> commands(acting.participant, qos::kForceCommand, a.rig,
                                            Around::stream());
    a.describe(20.0), a.plan();
    std::uint32_t status = 0;
    const auto standby = [&] {
      a.registry.update();
      return a.registry.find("coupling_standby");
    };
    const auto answer = [&] {
      runtime::NodeReport report;
      report.session_id = 7, report.state = runtime::NodeState::kRunning;
      if (const auto other = standby())
        report.values[runtime::kStandby] = runtime::to_hex(other->participant);
      if (a.sequence % 50 == 0)
        acting.status.publish(report);
      msg::ForceCommand m{};
      m.session_id = 7, m.sequence_number = a.sequence, m.status = status;
      a.touch();
      commands.write(m);
    };
    ASSERT_TRUE(wait_until([&] {
      answer();
      const auto other = standby();
      return other && other->message.starts_with("stands by");
    })) << (standby() ? standby()->message : "");
    for (int n = 0; n < 600; ++n)
      answer();
    EXPECT_EQ(*std::ranges::max_element(a.forces), 0.0) << "it sends nothing";
    EXPECT_TRUE(a.seen.empty()) << "nor does it say what it has designed";
    status = locked ? msg::force_command::kStatusLocked : 0U;
    for (int n = 0; n < 50; ++n)
      answer();
    a.forces.clear();
    for (int n = 0; n < 30; ++n)
      a.touch();
    ASSERT_GT(a.forces.size(), 10U) << "it takes over";
    if (locked) {
      EXPECT_EQ(*std::ranges::max_element(a.forces), 0.0) << "a takeover opens no lock";
    } else {
      const auto first = std::ranges::find_if(a.forces, [](double force_n) {
        return force_n > 0.0;
      });  // behind the last of the other one
      ASSERT_NE(first, a.forces.end());
      EXPECT_GT(*first, 0.9 * kForce) << "and without a ramp";
    }
    EXPECT_TRUE(wait_until([&] { return a.touch(), a.seen.size() == 1; }));
  }
}

}  // namespace
}  // namespace voxtouch::test::around_coupling
