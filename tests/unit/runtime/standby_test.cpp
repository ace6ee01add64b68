// Who stands by for whom, by what the statuses say.
#include "nodes/runtime/standby.hpp"

#include <gtest/gtest.h>

namespace voxtouch::runtime {
namespace {

bus::Guid guid(std::uint8_t n) {
  bus::Guid guid{};
  guid.fill(n);
  return guid;
}

NodeReport report(const std::string& node, std::uint8_t n, const std::string& duty = "",
                  NodeState state = NodeState::kRunning) {
  NodeReport report;
  report.node = node, report.participant = guid(n), report.session_id = 7, report.state = state;
  report.values = {{"scene_hash", "a"}};
  report.figures = {{"changes", {2, "changes"}}};
  if (!duty.empty())
    report.values[kDuty] = duty;
  return report;
}

const SameIn kSame{{"scene_hash"}, {"changes"}};

TEST(Standby, SaysWhoActs) {
  EXPECT_TRUE(says_that_it_acts(report("coupling", 1), "coupling"));
  EXPECT_FALSE(says_that_it_acts(report("coupling", 1, kStandsBy), "coupling"));
  EXPECT_FALSE(says_that_it_acts(report("coupling_standby", 1), "coupling"));
  EXPECT_FALSE(says_that_it_acts(report("coupling_standby", 1, kStandsBy), "coupling"));
  EXPECT_TRUE(says_that_it_acts(report("coupling_standby", 1, kActs), "coupling"));
  EXPECT_FALSE(says_that_it_acts(report("rendering_standby", 1, kActs), "coupling"));
  EXPECT_FALSE(says_that_it_acts(report("coupling_standby_standby", 1, kActs), "coupling"));
}

TEST(Standby, TellsARivalFromOneThatHasAStandby) {
  EXPECT_FALSE(says_that_it_acts_in_a_pair(report("coupling", 1), "coupling"));
  EXPECT_TRUE(says_that_it_acts_in_a_pair(report("coupling", 1, kActs), "coupling"));
  EXPECT_TRUE(says_that_it_acts_in_a_pair(report("coupling_standby", 1, kActs), "coupling"));
  EXPECT_FALSE(says_that_it_acts_in_a_pair(report("device", 1, kActs), "coupling"));
}

TEST(Standby, FindsTheOneThatActsAndNoneOfTwo) {
  std::vector<NodeReport> all{report("device", 1), report("coupling", 2),
                              report("coupling_standby", 3, kStandsBy)};
  EXPECT_EQ(who_acts(all, "coupling", guid(3)), guid(2));
  EXPECT_EQ(who_acts(all, "coupling", guid(2)), std::nullopt) << "not itself";
  all.push_back(report("coupling", 4));
  EXPECT_EQ(who_acts(all, "coupling", guid(3)), std::nullopt);
  all.back().state = NodeState::kStopped;
  EXPECT_EQ(who_acts(all, "coupling", guid(3)), guid(2));
}

TEST(Standby, TakesWhoIsReadyForTheSessionAndAsItIs) {
  const NodeReport own = report("coupling", 1);
  const auto takes = [&](const NodeReport& other) {
    return who_could_stand_by({own, other}, "coupling", own, guid(1), kSame).size() == 1;
  };
  const NodeReport good = report("coupling_standby", 2, kStandsBy, NodeState::kReady);
  EXPECT_TRUE(takes(good));
  EXPECT_TRUE(takes(report("coupling", 2, kStandsBy))) << "one that came back";
  EXPECT_FALSE(takes(report("coupling", 2))) << "a rival";
  EXPECT_FALSE(takes(report("coupling_standby", 2, kActs)));
  EXPECT_FALSE(takes(report("rendering_standby", 2, kStandsBy)));
  for (const NodeState state : {NodeState::kStarting, NodeState::kStopped, NodeState::kFailed})
    EXPECT_FALSE(takes(report("coupling_standby", 2, kStandsBy, state)));
  NodeReport other = good;
  other.session_id = 8;
  EXPECT_FALSE(takes(other));
  other = good, other.values["scene_hash"] = "b";
  EXPECT_FALSE(takes(other));
  other = good, other.figures["changes"] = {3, "changes"};
  EXPECT_FALSE(takes(other));
  other = good, other.figures.clear();
  EXPECT_FALSE(takes(other));
  EXPECT_EQ(kSame.difference(own, other), "changes");
}

TEST(Standby, IsNamedByItsGuidAndByNothingElse) {
  NodeReport own = report("coupling", 1);
  EXPECT_FALSE(named_standby(own).says);
  own.values[kStandby] = to_hex(guid(0xa7));
  EXPECT_TRUE(named_standby(own).says);
  EXPECT_EQ(named_standby(own).participant, guid(0xa7));
  own.values[kStandby] = kNoStandby;
  EXPECT_TRUE(named_standby(own).says);
  EXPECT_EQ(named_standby(own).participant, std::nullopt);
  for (const std::string wrong :
       {"", "a7", "zz", "A7A7A7A7A7A7A7A7A7A7A7A7A7A7A7A7", "a7a7a7a7a7a7a7a7a7a7a7a7a7a7a7a7a7"}) {
    own.values[kStandby] = wrong;
    EXPECT_FALSE(named_standby(own).says) << wrong;
  }
}

TEST(Standby, IsForRealTime) {
  EXPECT_THROW(in_mode({.is_standby = true}, true), std::runtime_error);
  EXPECT_EQ(in_mode({}, true).takes, TakesStandby::kNever);
  EXPECT_TRUE(in_mode({.is_standby = true}, false).is_standby);
}

}  // namespace
}  // namespace voxtouch::runtime
