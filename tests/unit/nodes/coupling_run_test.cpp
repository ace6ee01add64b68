// The coupling node alone, after its design: duplicated and reordered contacts, and the fault
// latch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "tests/unit/nodes/around_coupling.hpp"

namespace voxtouch::test::around_coupling {
namespace {

/// Such a number may be forged with the rendering's GUID, which DDS without security cannot
/// distinguish from the authorised one.
TEST(CouplingNode, AcceptsContactsAfterAForgedNumber) {
  Around a("{design: auto}");
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  const std::uint64_t next = std::exchange(a.sequence, std::uint64_t{1} << 40);
  a.touch();
  a.sequence = next;
  EXPECT_TRUE(a.force_comes()) << a.message();
}

/// DDS repeats a write that did not complete in time, so a reader may receive it twice. Answered
/// twice, the filter would be a step ahead.
TEST(CouplingNode, AnswersAContactThatComesTwiceOnceInLockstep) {
  Around a("{design: auto}", true);
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  std::this_thread::sleep_for(milliseconds(200));
  a.poll(), a.forces.clear();
  for (int n = 0; n < 50; ++n) {
    a.touch();
    --a.sequence;
    a.touch();
  }
  std::this_thread::sleep_for(milliseconds(200));
  a.poll();
  EXPECT_EQ(a.forces.size(), 50U);
}

/// A contact with force only on the way out, larger each time.
TEST(CouplingNode, LatchesAtZeroForSelfExcitedForceUntilReset) {
  Around a("{kind: shaping_filter, cutoff_hz: 20}", true);
  bus::Writer<msg::Recover> person(a.participant, qos::kRecover, a.rig,
                                   qos::profile(qos::ProfileId::kEvent));
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  const auto latch = [&] {
    a.registry.update();
    const auto report = a.registry.find("coupling");
    const auto number = report ? report->values.find("fault_latch")
                               : std::map<std::string, std::string>::iterator{};
    return report && number != report->values.end() ? std::stoull(number->second) : 0;
  };
  for (int n = 0; n < 90; ++n)
    ASSERT_TRUE(a.answers(-kDepth * (1.0 + 0.1 * n), 0.0));
  for (int stroke = 0; stroke < 20 && latch() == 0; ++stroke)
    for (int n = 0; n < 200; ++n)
      ASSERT_TRUE(a.answers(-kDepth * (n < 100 ? 10 - 0.1 * n : 0.1 * (n - 100)),
                            n < 100 ? 0.3 * std::pow(1.3, stroke) : 0.0));
  const std::uint64_t number = latch();
  ASSERT_NE(number, 0U) << a.message();
  EXPECT_NE(a.message().find("voxtouch recover"), std::string::npos) << a.message();
  for (int n = 0; n < 20; ++n)
    ASSERT_TRUE(a.answers());
  a.forces.clear();
  person.write(msg::Recover{7, number + 1});
  person.write(msg::Recover{8, number});
  for (int n = 0; n < 300; ++n)
    ASSERT_TRUE(a.answers()) << "the ring goes on";
  EXPECT_EQ(*std::ranges::max_element(a.forces), 0.0) << "another number, or another session";
  person.write(msg::Recover{7, number});
  EXPECT_TRUE(a.force_comes()) << a.message();
  EXPECT_EQ(latch(), 0U);
}

/// Strokes that each supply energy: the port as a whole supplies more than five times the bound of
/// a sound contact.
TEST(CouplingNode, LatchesIfThePortGivesEnergy) {
  Around a("{kind: shaping_filter, cutoff_hz: 20}", true);
  a.describe(20.0), a.plan();
  ASSERT_TRUE(a.force_comes()) << a.message();
  for (int n = 0; n < 90; ++n)
    ASSERT_TRUE(a.answers(-kDepth * (1.0 + 0.1 * n), 0.0));
  for (int stroke = 0; stroke < 14; ++stroke)
    for (int n = 0; n < 200; ++n)
      ASSERT_TRUE(
          a.answers(-kDepth * (n < 100 ? 10 - 0.1 * n : 0.1 * (n - 100)), n < 100 ? 3.0 : 0.0));
  const auto figures = [&] {
    a.registry.update();
    const auto report = a.registry.find("coupling");
    return report ? report->figures : runtime::Figures();
  };
  EXPECT_TRUE(wait_until([&] { return figures()["fault_latches"].value == 1.0; })) << a.message();
  EXPECT_LT(figures()["lowest_energy_j"].value, -0.01);
}

}  // namespace
}  // namespace voxtouch::test::around_coupling
