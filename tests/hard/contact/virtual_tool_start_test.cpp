// Valid start poses of a virtual tool: without a wall inside it, however thin, also in contact from
// outside.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/experiments/virtual_tool/runs.hpp"
#include "tests/hard/contact/virtual_tool_frames.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/contact/fixtures.hpp"

namespace voxtouch::virtual_tool {
namespace {

const Vec3 kPlateAt(0.3e-3, 0.1e-3, 0);                              ///< W
constexpr double kThick[] = {0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0};  // [e]

struct Plate {
  Quat lie;
  Rig rig;
  Plate(double thick_edges, bool askew)
      : lie(askew ? tilt() : Quat::Identity()),
        rig(test::box_mesh(Vec3(0.08, 0.08, thick_edges * kEdge), {kPlateAt, lie}), kEdge,
            ball_mesh()) {}
};

/// The hand starts in a wall's middle, or half in, rests there and leaves: no force, and no tool,
/// until it is out. Then it touches, from its own side.
TEST(VirtualToolStartInAThinWall, GivesNoForceUntilTheHandIsFree) {
  for (const double thick : kThick)
    for (const bool askew : {false, true})
      for (const double from : {0.0, 0.5 * kBall, -0.7 * kBall}) {
        SCOPED_TRACE(::testing::Message()
                     << thick << " e" << (askew ? " askew" : "") << ", from " << from);
        Plate plate(thick, askew);
        const double side = from < 0.0 ? -1.0 : 1.0, touch = kBall + 0.5 * thick * kEdge;
        const auto at = [&](double z) {
          return plate.rig.frame(plate.lie * Vec3(0.003, 0.002, side * z));
        };
        for (int n = 0; n < 100; ++n)
          ASSERT_TRUE(at(std::abs(from)).not_initialised);
        bool placed = false;
        for (double z = std::abs(from); z < touch + kEdge; z += 5e-5) {
          const exact::VirtualToolFrame f = at(z);
          expect_sound(f);
          ASSERT_LT(f.wrench(kStiffness).force.norm(),
                    0.05);  // it is faded in
          if (z < touch - kEdge) {
            ASSERT_TRUE(f.not_initialised) << z;
            ASSERT_TRUE(f.wrench(kStiffness).zero());
          }
          placed = placed || !f.not_initialised;
        }
        ASSERT_TRUE(placed);
        for (int n = 0; n < 200; ++n)
          at(touch + kEdge);
        for (double z = touch + kEdge; z > 0.0; z -= 5e-5)
          at(z);
        const Vec3 force = at(0.0).wrench(kStiffness).force;
        EXPECT_NEAR(force.dot(side * (plate.lie * Vec3::UnitZ())), kStiffness * touch,
                    0.05 * kStiffness * touch);
      }
}

/// A scene that is built anew, with a plate through the tool of the one before it.
TEST(VirtualToolStartInAThinWall, RejectsTheToolOfAnEarlierScene) {
  for (const double thick : kThick)
    for (const bool askew : {false, true}) {
      Plate plate(thick, askew);
      const double touch = kBall + 0.5 * thick * kEdge;
      for (double z = -touch + kEdge; z <= touch - kEdge; z += 2.5e-4)
        EXPECT_FALSE(plate.rig.place({plate.lie * Vec3(0.003, 0.002, z), Quat::Identity()}))
            << thick << " e" << (askew ? " askew" : "") << ", " << z;
      const double middle = (plate.lie * Vec3::UnitZ()).dot(kPlateAt);
      for (const double side : {-1.0, 1.0})
        EXPECT_TRUE(plate.rig.place(
            {plate.lie * Vec3(0.003, 0.002, middle + side * (touch + 1e-6)), Quat::Identity()}))
            << thick << ", " << side;
    }
}

struct StartTool {
  const char* name;
  Vec3 box;  ///< [e]; zero: a ball
};
void PrintTo(const StartTool& tool, std::ostream* out) { *out << tool.name; }
class VirtualToolStarts : public ::testing::TestWithParam<StartTool> {};

/// At random over plates and their rims, with and without rotation.
TEST_P(VirtualToolStarts, AreThosePosesWithoutAWallInside) {
  const std::uint64_t seed = testing::seed(71);
  SCOPED_TRACE(testing::seed_trace(seed));
  StartFigures touching, free, rims_touching, rims_across;
  const auto add = [](StartFigures& sum, const StartFigures& f) {
    sum.runs += f.runs, sum.placed += f.placed;
  };
  for (const double thick : kThick)
    for (const bool askew : {false, true}) {
      StartOptions o{
          .box = GetParam().box, .thick_edges = thick, .askew = askew, .tries = 5, .seed = seed};
      for (const bool turned : {false, true}) {
        o.turned = turned, o.rim = false, o.from_edges = 0.9, o.to_edges = 9.0;
        EXPECT_EQ(starts(o).placed, 0)
            << thick << " e" << (askew ? " askew" : "") << (turned ? " turned" : "");
        o.from_edges = 0.0, o.to_edges = 0.25;
        add(touching, starts(o));
      }
      o.rim = true;
      add(rims_touching, starts(o));
      o.from_edges = 0.9, o.to_edges = 9.0;
      add(rims_across, starts(o));
      o.rim = false, o.from_edges = -1.0, o.to_edges = -0.02;
      add(free, starts(o));
    }
  std::printf(
      "%s: free %d of %d, touching %d of %d, rims touching %d of %d, rims across %d of %d\n",
      GetParam().name, free.placed, free.runs, touching.placed, touching.runs, rims_touching.placed,
      rims_touching.runs, rims_across.placed, rims_across.runs);
  ASSERT_GT(std::min({touching.runs, rims_touching.runs, rims_across.runs}), 150);
  // A pose with 0.01 voxels or more of overlap is not a valid start. The ball's facets are up to
  // 0.005 voxels inside the round ball.
  EXPECT_LE(touching.placed + rims_touching.placed + rims_across.placed, touching.runs / 20);
  EXPECT_EQ(free.placed, free.runs);
}
INSTANTIATE_TEST_SUITE_P(Tools, VirtualToolStarts,
                         ::testing::Values(StartTool{"ball", Vec3::Zero()},
                                           StartTool{"box", Vec3(4, 6, 15)},
                                           StartTool{"bar", Vec3(2, 2, 15)}),
                         [](const auto& one) { return std::string(one.param.name); });

/// Free between two thin plates, next to one, and a micrometre over one: nothing is in the tool.
TEST(VirtualToolStartNearThinWalls, IsAFreeStart) {
  for (const double thick : kThick)
    for (const bool askew : {false, true})
      for (const double gap : {0.0005, 0.1, 0.5, 1.0}) {
        SCOPED_TRACE(::testing::Message()
                     << thick << " e" << (askew ? " askew" : "") << ", gap " << gap << " e");
        const Quat lie = askew ? tilt() : Quat::Identity();
        const double far = kBall + (gap + 0.5 * thick) * kEdge;
        const auto plate = [&](double side) {
          return test::box_mesh(Vec3(0.08, 0.08, thick * kEdge),
                                {lie * Vec3(0, 0, side * far), lie});
        };
        const Pose middle{lie * Vec3(0.3e-3, 0.2e-3, 0), lie};
        EXPECT_TRUE(Rig(test::joined(plate(1), plate(-1)), kEdge, ball_mesh()).place(middle));
        EXPECT_TRUE(Rig(plate(1), kEdge, ball_mesh()).place(middle));
        // A box of the ball's height fits the slot exactly with its sides, and stands flat.
        const mesh::TriangleMesh box = test::box_mesh(Vec3(0.02, 0.016, 2 * kBall));
        EXPECT_TRUE(Rig(test::joined(plate(1), plate(-1)), kEdge, box).place(middle));
        EXPECT_TRUE(Rig(plate(-1), kEdge, box).place(middle));
      }
}

}  // namespace
}  // namespace voxtouch::virtual_tool
