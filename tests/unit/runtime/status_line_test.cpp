#include "nodes/runtime/status_line.hpp"

#include <gtest/gtest.h>

namespace voxtouch::runtime {
namespace status_line_test {

TEST(StatusLine, HasRateAndForceOfTheLastSecond) {
  Figures before{{"samples", {1000, "samples"}}};
  Figures now{{"samples", {3000, "samples"}},
              {"last_second_max_force_n", {0.256, "N"}},
              {"last_second_answered_ratio", {0.5, "1"}}};
  EXPECT_EQ(status_line("device", now, before, 2.0),
            "device:    3000 samples at 1000.0 Hz  force   0.26 N at most  answered  50.0 %");
  EXPECT_EQ(status_line("validator", {{"checked", {50, "samples"}}}, {}, 1.0),
            "validator:      50 samples at   50.0 Hz");
  EXPECT_EQ(status_line("logger", {{"written", {50, "messages"}}}, {}, 1.0), "");
  EXPECT_EQ(status_line("device", {{"samples", {0, "samples"}}}, {}, 1.0), "")
      << "nothing has begun";
}

}  // namespace status_line_test
}  // namespace voxtouch::runtime
