/// Each rule for a virtual tool, on both sides of its limit.
#include "core/reference/tool_validation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace voxtouch::reference {
namespace tool_validation_test {

constexpr double kE = 0.002, kR = 0.01, kChord = 0.1 * kE, kGap = 1.2 * kE;
constexpr double kNear = kChord + 1e-5;  ///< [m]
const ValidatorSettings kSettings{kE, kChord, kGap, 0.0};
const ToolSettings kTool{.reach_m = kR, .rubs = false};

/// A ball over a level plane.
GapResult gap_of(double gap_m, bool one_face = true) {
  GapResult gap;
  gap.gap_m = gap_m;
  gap.direction = Vec3::UnitZ();
  gap.sphere_radius_m = kR;
  gap.unique_face = one_face, gap.depth_exact = gap.self_check = true;
  gap.method = GapMethod::kClosedForm;
  gap.self_error_m = 0;
  return gap;
}

/// The hand that far below the virtual tool, which is `off_m` off the plane; the spring `degrees`
/// askew.
ReportedTool tool(double path_m, double degrees = 0.0) {
  ReportedTool report;
  const double angle = degrees * std::numbers::pi / 180.0;
  const Vec3 up(std::sin(angle), 0.0, std::cos(angle));
  report.tool.position = Vec3(0, 0, kR);
  report.hand.position = report.tool.position - path_m * up;
  report.wrench.force = 300.0 * path_m * up;
  report.constrained = path_m > 0.0;
  return report;
}

std::string said(const ReportedTool& report, double at_tool, double at_hand,
                 const ToolSettings& settings = kTool, bool one_face = true) {
  Validation out;
  return tool_breach(kSettings, settings, gap_of(at_tool, one_face), gap_of(at_hand), report, out);
}
bool finds(const std::string& sentence, const char* part) {
  return sentence.find(part) != std::string::npos;
}

TEST(ToolValidation, AgreesWithASpringThatPressesABallOnAPlane) {
  EXPECT_EQ(said(tool(0.01), 0.0, -0.01), "");
  EXPECT_EQ(said(tool(0.0), 0.02, 0.02), "") << "free";
}

TEST(ToolValidation, FindsForcesWithoutATool) {
  ReportedTool report = tool(0.01);
  report.not_initialised = true;
  EXPECT_TRUE(finds(said(report, 0.0, -0.01), "a force of"));
  report.wrench = {};
  EXPECT_EQ(said(report, 0.0, -0.01), "");
  report = tool(0.01);
  report.not_converged = true;
  EXPECT_EQ(said(report, -0.005, -0.01), "") << "an object has moved through it";
  report = tool(0.01);
  report.constrained = false;
  EXPECT_TRUE(finds(said(report, 0.0, -0.01), "unconstrained"));
}

TEST(ToolValidation, DetectsAFreeToolAwayFromTheHand) {
  ReportedTool report = tool(0.0);
  report.hand.position.x() += 1e-9;
  EXPECT_TRUE(finds(said(report, 0.02, 0.02), "mm and 0 deg away"));
}

TEST(ToolValidation, RotationMayTrailTheHandOfADeviceWithoutTorque) {
  ReportedTool report = tool(0.0);
  report.hand.orientation = Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX()));
  EXPECT_TRUE(finds(said(report, 0.02, 0.02), "17.2 deg away"));
  report.returns_torque = false;
  EXPECT_EQ(said(report, 0.02, 0.02), "");
  EXPECT_EQ(said(report, 0.02, -0.01), "") << "where the tool has not rotated to";
  EXPECT_TRUE(finds(said(report, -0.01, 0.02), "no force, but"));
  report.hand.position.x() += 1e-9;
  EXPECT_TRUE(finds(said(report, 0.02, 0.02), "mm and"));
}

TEST(ToolValidation, DetectsAForceUnlikeTheSprings) {
  ReportedTool report = tool(0.01);
  report.wrench.force.x() = 1e-5 * report.wrench.force.z();
  EXPECT_TRUE(finds(said(report, 0.0, -0.01), "direction error to the spring"));
  report = tool(0.01);
  report.wrench.force = -report.wrench.force;
  EXPECT_TRUE(finds(said(report, 0.0, -0.01), "direction error to the spring"));
}

/// It has a force from either side; its inside does not matter.
TEST(ToolValidation, FindsAnOpenMeshInTheTool) {
  const auto of_open = [](double at_tool, double at_hand, double path_m) {
    Validation out;
    GapResult tool_gap = gap_of(at_tool), hand_gap = gap_of(at_hand);
    tool_gap.inside_known = hand_gap.inside_known = false;
    return tool_breach(kSettings, kTool, tool_gap, hand_gap, tool(path_m), out);
  };
  EXPECT_EQ(of_open(0.99 * kNear, -0.01, 0.01), "");
  EXPECT_TRUE(finds(of_open(1.01 * kNear, -0.01, 0.01), "mm off"));
  EXPECT_EQ(of_open(-0.99 * kNear, -0.01, 0.01), "");
  EXPECT_TRUE(finds(of_open(-1.01 * kNear, -0.01, 0.01), "mm inside"));
  EXPECT_TRUE(finds(of_open(-0.01, -0.01, 0.0), "no force"));
}

TEST(ToolValidation, FindsAToolInTheWallOrOffIt) {
  for (const bool one_face : {true, false}) {
    EXPECT_EQ(said(tool(0.01), -0.99 * kNear, -0.01, kTool, one_face), "");
    EXPECT_TRUE(finds(said(tool(0.01), -1.01 * kNear, -0.01, kTool, one_face), "mm inside"));
    EXPECT_EQ(said(tool(0.01), 0.99 * kNear, -0.01, kTool, one_face), "");
    EXPECT_TRUE(finds(said(tool(0.01), 1.01 * kNear, -0.01, kTool, one_face), "is 0.212 mm off"));
  }
  ReportedTool approaching = tool(0.01);
  approaching.residual_m = kNear;
  EXPECT_EQ(said(approaching, 1.9 * kNear, -0.01), "");
}

TEST(ToolValidation, FindsAForceOverNothingAndNoForceInTheWall) {
  EXPECT_EQ(said(tool(0.001), 0.0, 0.001 + 0.99 * kNear), "");
  EXPECT_TRUE(finds(said(tool(0.001), 0.0, 0.001 + 1.01 * kNear), "nothing is between"));
  EXPECT_EQ(said(tool(0.03), 0.0, 0.01), "") << "the hand is through a thin wall";
  EXPECT_EQ(said(tool(0.0), -0.99 * kNear, -0.99 * kNear), "");
  EXPECT_TRUE(finds(said(tool(0.0), -1.01 * kNear, -1.01 * kNear), "no force"));
}

TEST(ToolValidation, DetectsAnOffNormalForceOnOneFace) {
  EXPECT_EQ(said(tool(0.01, 7.9), 0.0, -0.01), "");
  EXPECT_TRUE(finds(said(tool(0.01, 8.1), 0.0, -0.01), "contact normal"));
  EXPECT_EQ(said(tool(0.01, 30.0), 0.0, -0.01, {.reach_m = kR, .rubs = true}), "")
      << "friction may";
  EXPECT_EQ(said(tool(0.01, 30.0), 0.0, -0.01, kTool, false), "") << "at an edge there are two";
}

TEST(ToolValidation, DecidesEverySampleAndBlamesTheReference) {
  ContactValidator validator(kSettings);
  EXPECT_EQ(validator.validate(gap_of(0.0), gap_of(-0.01), kTool, tool(0.01)).verdict,
            Verdict::kAgree);
  const Validation wrong = validator.validate(gap_of(-0.002), gap_of(-0.01), kTool, tool(0.01));
  EXPECT_EQ(wrong.verdict, Verdict::kDisagree);
  EXPECT_EQ(wrong.cause, Cause::kRendering);
  GapResult doubtful = gap_of(-0.002);
  doubtful.self_check = false;
  EXPECT_EQ(validator.validate(doubtful, gap_of(-0.01), kTool, tool(0.01)).cause,
            Cause::kReference);
  ReportedTool none = tool(0.01);
  none.wrench.force.x() = std::nan("");
  EXPECT_EQ(validator.validate(gap_of(0.0), gap_of(-0.01), kTool, none).verdict,
            Verdict::kDisagree);
  EXPECT_EQ(validator.counts().checked, 4u);
  EXPECT_EQ(validator.counts().decided, 3u);
  EXPECT_EQ(validator.counts().in_band, 0u);
}

}  // namespace tool_validation_test
}  // namespace voxtouch::reference
