#include <gtest/gtest.h>

#include <sstream>

#include "nodes/cli/probe/pose_csv.hpp"

namespace voxtouch::cli {
namespace {

std::string refusal(const std::string& text) {
  std::istringstream in(text);
  try {
    read_poses(in, "poses.csv");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(PoseCsv, FindsItsColumnsByNameAndNormalises) {
  std::istringstream in("tx,extra,qw,qx,qy,qz,ty,tz\r\n1.5,hello,0,0,0,2,-2,3e-1\n\n");
  const auto poses = read_poses(in, "poses.csv");
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].position, Vec3(1.5, -2, 0.3));
  EXPECT_EQ(poses[0].orientation.z(), 1.0);
}

TEST(PoseCsv, SkipsTheByteOrderMark) {
  EXPECT_EQ(refusal("\xEF\xBB\xBFqw,qx,qy,qz,tx,ty,tz\n1,0,0,0,0,0,0\n"), "");
}

TEST(PoseCsv, ReportsFileLineAndColumnOfAnError) {
  EXPECT_TRUE(refusal("qw,qx,qy,qz,tx,ty\n").contains("poses.csv:1: ") &&
              refusal("qw,qx,qy,qz,tx,ty\n").contains("'tz'"));
  EXPECT_NE(refusal("qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,0,0,nan\n").find("poses.csv:2: column 'tz'"),
            std::string::npos);
  EXPECT_NE(refusal("qw,qx,qy,qz,tx,ty,tz\n1,0,0,0,0,0,1;\n").find("'1;'"), std::string::npos);
  EXPECT_NE(refusal("qw,qx,qy,qz,tx,ty,tz\n1,0,0\n").find("ends before"), std::string::npos);
  EXPECT_NE(refusal("qw,qx,qy,qz,tx,ty,tz\n0,0,0,0,0,0,0\n").find("norm"), std::string::npos);
  EXPECT_NE(refusal("").find("empty"), std::string::npos);
}

TEST(PoseCsv, AcceptsQuaternionNormsFromThousandthToThousand) {
  for (const char* w : {"0.001", "1", "1000"})
    EXPECT_EQ(refusal(std::string("qw,qx,qy,qz,tx,ty,tz\n") + w + ",0,0,0,0,0,0\n"), "");
  for (const char* w : {"0.00099", "1001"})
    EXPECT_NE(refusal(std::string("qw,qx,qy,qz,tx,ty,tz\n") + w + ",0,0,0,0,0,0\n"), "");
}

}  // namespace
}  // namespace voxtouch::cli
