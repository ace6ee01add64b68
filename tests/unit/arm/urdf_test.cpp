// Robot descriptions: parsed from text, their chain places the flange as the arm's kinematics does.
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
#include "devices/phantom/phantom_arm.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::arm {
namespace {

std::vector<double> numbers(const std::string& text) {
  std::vector<double> all;
  std::istringstream words(text);
  for (std::string word; words >> word;)
    all.push_back(parse_finite(word).value());
  return all;
}

struct ReadJoint {
  std::string name, type, parent, child;
  Pose origin;
};
std::vector<ReadJoint> joints_of(const std::string& urdf) {
  static const std::regex kJoint(
      "<joint name=\"([^\"]+)\" type=\"([^\"]+)\">\\s*<parent link=\"([^\"]+)\"/>\\s*<child "
      "link=\"([^\"]+)\"/>\\s*"
      "<origin xyz=\"([^\"]+)\" rpy=\"([^\"]+)\"/>");
  std::vector<ReadJoint> all;
  for (std::sregex_iterator at(urdf.begin(), urdf.end(), kJoint), end; at != end; ++at) {
    const std::vector<double> xyz = numbers((*at)[5]), rpy = numbers((*at)[6]);
    const Quat turned = Eigen::AngleAxisd(rpy.at(2), Vec3::UnitZ()) *
                        Eigen::AngleAxisd(rpy.at(1), Vec3::UnitY()) *
                        Eigen::AngleAxisd(rpy.at(0), Vec3::UnitX());
    all.push_back(
        {(*at)[1], (*at)[2], (*at)[3], (*at)[4], {Vec3(xyz.at(0), xyz.at(1), xyz.at(2)), turned}});
  }
  return all;
}

Pose flange_of(const ArmDescription& arm, const std::vector<ReadJoint>& chain,
               const Eigen::VectorXd& q) {
  Pose at;
  std::string link = std::string(arm.model) + "_base";
  for (std::size_t j = 0; j < chain.size(); ++j) {
    const bool turns = j + 1 < chain.size();
    EXPECT_EQ(chain[j].parent, link);
    EXPECT_EQ(chain[j].type, turns ? "revolute" : "fixed");
    at = at * chain[j].origin;
    if (turns)
      at = at * Pose{Vec3::Zero(),
                     Quat(Eigen::AngleAxisd(q[static_cast<Eigen::Index>(j)], Vec3::UnitZ()))};
    link = chain[j].child;
  }
  return at;
}

void expect_same_flange(const ArmDescription& arm, Eigen::Index joints,
                        const std::function<Pose(const Eigen::VectorXd&)>& flange) {
  const std::vector<ReadJoint> chain = joints_of(to_urdf(arm));
  ASSERT_EQ(chain.size(), static_cast<std::size_t>(joints) + 1);
  std::mt19937_64 random(voxtouch::testing::seed(5));
  std::uniform_real_distribution<double> angle(-2.5, 2.5);
  for (int n = 0; n < 100; ++n) {
    Eigen::VectorXd q(joints);
    for (double& one : q)
      one = angle(random);
    const Pose at = flange_of(arm, chain, q), expected = flange(q);
    EXPECT_LT((at.position - expected.position).norm(), 1e-8);
    EXPECT_LT(at.orientation.angularDistance(expected.orientation), 1e-7);
  }
}

TEST(Urdf, FlangeMatchesTheArm) {
  expect_same_flange(lwr::lwr_description(), 7,
                     [](const Eigen::VectorXd& q) { return lwr::LwrArm().flange(q); });
  expect_same_flange(fr3::fr3_description(), 7,
                     [](const Eigen::VectorXd& q) { return fr3::Fr3Arm().at(q).flange; });
  expect_same_flange(
      phantom::phantom_description(), phantom::kChainJoints, [](const Eigen::VectorXd& q) {
        const Vec3 joints(q[0], q[1], q[1] + q[2]), gimbal(q[3], q[4], q[5]);
        return Pose{phantom::phantom_tip({}, joints), phantom::stylus_orientation(joints, gimbal)};
      });
}

/// The joints of a Phantom's driver, computed from tip and stylus, reproduce both.
TEST(Urdf, PhantomJointsReproduceTipAndStylus) {
  const std::vector<ReadJoint> chain = joints_of(to_urdf(phantom::phantom_description()));
  std::mt19937_64 random(voxtouch::testing::seed(6));
  std::uniform_real_distribution<double> small(-0.6, 0.6);
  for (int n = 0; n < 100; ++n) {
    const Vec3 joints(small(random), small(random), small(random)),
        gimbal(small(random), small(random), small(random));
    const Pose expected{phantom::phantom_tip({}, joints),
                        phantom::stylus_orientation(joints, gimbal)};
    const auto angles = phantom::phantom_chain({}, expected.position, expected.orientation);
    ASSERT_TRUE(angles);
    const Pose at =
        flange_of(phantom::phantom_description(), chain,
                  Eigen::Map<const Eigen::VectorXd>(angles->data(), phantom::kChainJoints));
    EXPECT_LT((at.position - expected.position).norm(), 1e-8);
    EXPECT_LT(at.orientation.angularDistance(expected.orientation), 1e-7);
  }
  EXPECT_FALSE(phantom::phantom_chain({}, Vec3(1.0, 0.0, 0.0), Quat::Identity())) << "out of reach";
}

TEST(Urdf, StandsInTheFilesForRosTools) {
  for (const ArmDescription* arm :
       {&lwr::lwr_description(), &fr3::fr3_description(), &phantom::phantom_description()}) {
    const std::string path = VOXTOUCH_DEPLOY "/devices/" + std::string(arm->model) + ".urdf";
    std::ifstream file(path);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), to_urdf(*arm))
        << path << " is to be:\n"
        << to_urdf(*arm);
  }
}

}  // namespace
}  // namespace voxtouch::arm
