#include "nodes/cli/up/start_warnings.hpp"

#include <gtest/gtest.h>

namespace voxtouch::cli {
namespace start_warnings_test {

TEST(StartWarnings, AreTwoAtMostAndTheRestIsCounted) {
  EXPECT_TRUE(few_warnings({}, "cup").empty());
  EXPECT_EQ(few_warnings({"a", "b"}, "cup"),
            (std::vector<std::string>{"warning: a", "warning: b"}));
  const std::vector<std::string> few = few_warnings({"a", "b", "c", "d"}, "cup");
  ASSERT_EQ(few.size(), 3U);
  EXPECT_EQ(few[1], "warning: b");
  for (const char* fact : {" 2 ", "`voxtouch plan cup`", "`voxtouch doctor`"})
    EXPECT_TRUE(few[2].contains(fact)) << few[2];
}

TEST(StartWarnings, TellOfTheMachineInOneSentence) {
  runtime::RealtimeOptions options;
  options.cpu = 100'000;  // no machine has it
  const std::vector<std::string> told = warnings_of_machine(options);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_TRUE(told[0].contains("`voxtouch doctor` says which")) << told[0];
}

}  // namespace start_warnings_test
}  // namespace voxtouch::cli
