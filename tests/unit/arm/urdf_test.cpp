// Robot descriptions: read back as text, their chain puts the flange where the arm's own kinematics does.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "core/types/number.hpp"
#include "devices/arm/arm_description.hpp"
#include "devices/fr3/fr3_arm.hpp"
#include "devices/lwr/lwr_arm.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::arm {
namespace {

std::vector<double> numbers(const std::string& text) {
  std::vector<double> all;
  std::istringstream words(text);
  for (std::string word; words >> word;) all.push_back(parse_finite(word).value());
  return all;
}

struct ReadJoint {
  std::string name, type, parent, child;
  Pose origin;
};
std::vector<ReadJoint> joints_of(const std::string& urdf) {
  static const std::regex kJoint("<joint name=\"([^\"]+)\" type=\"([^\"]+)\">\\s*<parent link=\"([^\"]+)\"/>\\s*<child link=\"([^\"]+)\"/>\\s*"
                                 "<origin xyz=\"([^\"]+)\" rpy=\"([^\"]+)\"/>");
  std::vector<ReadJoint> all;
  for (std::sregex_iterator at(urdf.begin(), urdf.end(), kJoint), end; at != end; ++at) {
    const std::vector<double> xyz = numbers((*at)[5]), rpy = numbers((*at)[6]);
    const Quat turned = Eigen::AngleAxisd(rpy.at(2), Vec3::UnitZ()) * Eigen::AngleAxisd(rpy.at(1), Vec3::UnitY()) * Eigen::AngleAxisd(rpy.at(0), Vec3::UnitX());
    all.push_back({(*at)[1], (*at)[2], (*at)[3], (*at)[4], {Vec3(xyz.at(0), xyz.at(1), xyz.at(2)), turned}});
  }
  return all;
}

void expect_same_flange(const ArmDescription& arm, const std::function<Pose(const Joints&)>& flange) {
  const std::vector<ReadJoint> chain = joints_of(to_urdf(arm));
  ASSERT_EQ(chain.size(), 8U);
  std::mt19937_64 random(voxtouch::testing::seed(5));
  std::uniform_real_distribution<double> angle(-2.5, 2.5);
  for (int n = 0; n < 100; ++n) {
    Joints q;
    for (double& one : q) one = angle(random);
    Pose at;
    std::string link = std::string(arm.model) + "_base";
    for (std::size_t j = 0; j < chain.size(); ++j) {
      ASSERT_EQ(chain[j].parent, link);
      ASSERT_EQ(chain[j].type, j < 7 ? "revolute" : "fixed");
      at = at * chain[j].origin;
      if (j < 7) at = at * Pose{Vec3::Zero(), Quat(Eigen::AngleAxisd(q[static_cast<Eigen::Index>(j)], Vec3::UnitZ()))};
      link = chain[j].child;
    }
    const Pose wanted = flange(q);
    EXPECT_LT((at.position - wanted.position).norm(), 1e-8);
    EXPECT_LT(at.orientation.angularDistance(wanted.orientation), 1e-7);
  }
}

TEST(Urdf, PutsTheFlangeWhereTheArmHasIt) {
  expect_same_flange(lwr::lwr_description(), [](const Joints& q) { return lwr::LwrArm().flange(q); });
  expect_same_flange(fr3::fr3_description(), [](const Joints& q) { return fr3::Fr3Arm().at(q).flange; });
}

TEST(Urdf, StandsInTheFilesForRosTools) {
  for (const ArmDescription* arm : {&lwr::lwr_description(), &fr3::fr3_description()}) {
    const std::string path = VOXTOUCH_DEPLOY "/devices/" + std::string(arm->model) + ".urdf";
    std::ifstream file(path);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), to_urdf(*arm)) << path << " is to be:\n" << to_urdf(*arm);
  }
}

}  // namespace
}  // namespace voxtouch::arm
