// A rendering and a coupling lost in contact, with a standby each; failover_campaign does it a
// hundred times.
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/attack/failover/expect_taken_over.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::attack {
namespace {

struct Case {
  const char* victim;
  int signal;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.victim << (c.signal == SIGKILL ? " killed" : " stopped");
}

class Failover : public testing::TestWithParam<Case> {};

TEST_P(Failover, GoesOnWithoutAStepAndAnswersNoSampleTwice) {
  expect_taken_over({.victim = GetParam().victim, .signal = GetParam().signal});
}

INSTANTIATE_TEST_SUITE_P(Ring, Failover,
                         testing::Values(Case{"rendering", SIGKILL}, Case{"rendering", SIGSTOP},
                                         Case{"coupling", SIGKILL}),
                         [](const auto& c) {
                           return std::string(c.param.victim) +
                                  (c.param.signal == SIGKILL ? "_killed" : "_stopped");
                         });

TEST(UpWithStandby, SaysWhoWasLostWhereItSeesItOnlyInTheEnd) {
  expect_taken_over({.victim = "rendering", .up_waits = true});
}

TEST(UpWithStandby, IsRefusedWhereNobodyCouldTakeOver) {
  for (const char* option : {"--lockstep", "--one-process"}) {
    test::Process up({VOXTOUCH_BIN "/voxtouch", "up", "cup", "--standby", option, "--no-record",
                      "--domain", test::fresh_domain()});
    const test::Finished end = up.wait(std::chrono::seconds(20));
    EXPECT_EQ(end.status, 1) << option;
    EXPECT_NE(end.err.find("--standby"), std::string::npos) << end.err;
    EXPECT_NE(end.err.find(std::string("Start without ") + option), std::string::npos) << end.err;
  }
}

}  // namespace
}  // namespace voxtouch::attack
