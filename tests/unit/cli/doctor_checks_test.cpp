#include "nodes/cli/doctor/doctor_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace voxtouch::cli {
namespace {

std::set<unsigned> first(unsigned count) {
  std::set<unsigned> taken;
  for (unsigned n = 0; n < count; ++n)
    taken.insert(n);
  return taken;
}

TEST(Doctor, FindsTakenIndicesByTheirPorts) {
  // Domain 1 begins at 7650; its index 0 has 7660 and 7661, index 3 has 7666. 7410 is domain 0's,
  // and 7651 for all of domain 1.
  std::istringstream udp(
      "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout "
      "inode ref pointer drops\n"
      "  211: 00000000:1DEC 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
      "1 2 0 0\n"
      "  212: 00000000:1DED 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
      "1 2 0 0\n"
      "  213: 0100007F:1DF2 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
      "1 2 0 0\n"
      "  214: 00000000:1CF2 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
      "1 2 0 0\n"
      "  215: 00000000:1DE3 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 "
      "1 2 0 0\n"
      "  216: nonsense\n");
  EXPECT_EQ(taken_indices(udp, 1), (std::set<unsigned>{0, 3}));
}

TEST(Doctor, ReportsWhichToolsMissARingIfIndicesAreFew) {
  EXPECT_EQ(check_indices(first(3)).health, Health::kGood);
  EXPECT_TRUE(check_indices(first(4)).sentence.contains("Humble"))
      << check_indices(first(4)).sentence;
  EXPECT_TRUE(check_indices(first(27)).sentence.contains("no multicast"))
      << check_indices(first(27)).sentence;
  EXPECT_EQ(check_indices(first(114)).health, Health::kBad);
}

TEST(Doctor, NamesAMissingCard) {
  const std::vector<Finding> findings = check_cards("no_such_if0", bus::network_cards());
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].health, Health::kBad);
  EXPECT_TRUE(findings[0].sentence.contains("no_such_if0"));
}

TEST(Doctor, NamesACardThatTheRingLeavesOut) {
  const std::vector<Finding> findings = check_cards(bus::kThisHost, {{"tun0", 1, false, false}});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_TRUE(findings[0].sentence.contains("tun0") && findings[0].sentence.contains("multicast"))
      << findings[0].sentence;
}

TEST(Doctor, PrintsTwoLinesToPaste) {
  const std::string lines = ros_environment(7, bus::kThisHost);
  EXPECT_TRUE(lines.starts_with("export ROS_DOMAIN_ID=7\nexport CYCLONEDDS_URI='")) << lines;
  EXPECT_EQ(std::ranges::count(lines, '\n'), 2);
  EXPECT_TRUE(ros_environment(7, "eth7").contains(R"(name="eth7")"));
}

}  // namespace
}  // namespace voxtouch::cli
