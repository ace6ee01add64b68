/// Invariants of any frame.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <random>

#include "core/exact/limits.hpp"
#include "tests/unit/exact/rig.hpp"

namespace voxtouch::exact {
namespace {

TEST(Frames, InFreeSpaceTheToolIsExactlyTheHand) {
  Rig rig(test::ball(0.01, 3), test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}));
  ASSERT_TRUE(rig.virtual_tool.place({{0, 0, 0.03}, Quat::Identity()}, {&rig.object_pose, 1}));
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  Pose hand{{0, 0, 0.03}, Quat::Identity()};
  for (int k = 0; k < 500; ++k) {
    hand.position += 1e-3 * Vec3(normal(random), normal(random), normal(random));
    hand.position.z() = std::max(hand.position.z(), 0.011);
    hand.orientation = (turned(0.05 * normal(random), {1, 2, 3}) * hand.orientation).normalized();
    if (k % 3 == 0)
      hand.orientation.coeffs() *= -1.0;
    const VirtualToolFrame frame = rig.frame(hand);
    ASSERT_EQ(frame.tool.position, hand.position) << k;
    ASSERT_EQ(frame.tool.orientation.coeffs(), hand.orientation.coeffs()) << k;
    ASSERT_TRUE(frame.wrench(1000.0).zero());
    ASSERT_FALSE(frame.constrained || frame.not_converged || frame.not_initialised);
  }
}

/// A box that tumbles in a bowl.
Pose tumbling(int k) {
  const double t = 1e-3 * k;
  return {
      Vec3(0.03 * std::sin(33 * t), 0.03 * std::sin(25 * t + 1), -0.015 + 0.02 * std::sin(29 * t)),
      turned(17.0 * t, {1, std::sin(3 * t), 0.4})};
}

TEST(Frames, SameFramesAreBitIdenticalWithEqualWork) {
  const mesh::TriangleMesh box = test::box({-.004, -.006, -.015}, {.004, .006, .015}),
                           bowl = test::bowl(0.03, 0.034, 48, 12);
  Rig a(box, bowl), b(box, bowl);
  for (int k = -200; k < 1000; ++k) {
    const Pose hand = k < 0 ? Pose{} : tumbling(k);
    const VirtualToolFrame one = a.frame(hand), other = b.frame(hand);
    ASSERT_EQ(one.tool, other.tool) << k;
    ASSERT_EQ(one.work, other.work);
    ASSERT_EQ(one.shift, other.shift);
    ASSERT_EQ(one.displayed, other.displayed);
  }
}

TEST(Frames, AtTheWorkLimitTheToolTrailsAndNeverPasses) {
  VirtualToolOptions options;
  options.max_work = 5000;
  Rig rig(test::box({-.004, -.006, -.015}, {.004, .006, .015}), test::bowl(0.03, 0.0302, 48, 12),
          options);
  ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
  int cut_short = 0;
  std::uint64_t most = 0;
  for (int k = 0; k < 1500; ++k) {
    const VirtualToolFrame frame = rig.frame(tumbling(k));
    cut_short += frame.cut_short;
    most = std::max(most, frame.work);
    if (k % 5 == 0) {
      ASSERT_FALSE(rig.intersects()) << k;
    }
  }
  EXPECT_GT(cut_short, 10);
  EXPECT_LT(most, 5100u);
  EXPECT_FALSE(rig.rest(tumbling(1499), 3000).not_converged);  // and gets there
}

struct Journey {
  int intersections = 0, rejected_steps = 0, unfinished = 0, cut_short = 0;
  std::uint64_t most_work = 0;
};

/// Frames of a hand with the motion `hand`; each tenth is checked by brute force.
template <class Hand>
Journey travel(Rig& rig, int frames, const Hand& hand) {
  Journey out;
  for (int k = 0; k < frames; ++k) {
    const VirtualToolFrame frame = rig.frame(hand(k));
    out.rejected_steps += frame.rejected_steps;
    out.unfinished += frame.not_converged;
    out.cut_short += frame.cut_short;
    out.most_work = std::max(out.most_work, frame.work);
    if (k % 10 == 0)
      out.intersections += rig.intersects();
  }
  return out;
}

TEST(Frames, GapsDoNotErodeAtThreeMetresPerSecond) {
  const mesh::TriangleMesh box = test::box({-.004, -.006, -.015}, {.004, .006, .015});
  Rig bowl(box, test::bowl(0.03, 0.034, 96, 24));
  ASSERT_TRUE(bowl.virtual_tool.place({}, {&bowl.object_pose, 1}));
  const Journey in_bowl = travel(bowl, 6000, [](int k) { return tumbling(3 * k); });
  EXPECT_EQ(in_bowl.intersections, 0);
  EXPECT_LT(in_bowl.rejected_steps, 6000);
  EXPECT_FALSE(bowl.rest(tumbling(18000), 1000).not_converged);

  Rig plate(box, test::box({-.1, -.1, -.02}, {.1, .1, 0}));
  ASSERT_TRUE(plate.virtual_tool.place({{0, 0, .03}, Quat::Identity()}, {&plate.object_pose, 1}));
  const auto over = [](int k) {
    const double x = 3e-3 * k;
    return Pose{{.03 * std::sin(x / .03), .03 * std::cos(x / .041), std::max(.03 - 2e-5 * k, -.02)},
                turned(3.0 * x / .03, {.3, .5, .8})};
  };
  const Journey on_plate = travel(plate, 6000, over);
  EXPECT_EQ(on_plate.intersections, 0);
  EXPECT_LT(on_plate.rejected_steps, 6000);
  EXPECT_FALSE(plate.rest(over(6000), 1000).not_converged);
}

/// Moves to a new place every 0.1 s.
template <class Random>
Pose wandering(Random& random, int k, double reach, double angle, Pose& at, Pose& to) {
  std::normal_distribution<double> normal;
  if (k % 100 == 0) {
    to.position = reach * Vec3(normal(random), normal(random), normal(random));
    to.orientation = turned(angle * normal(random), {normal(random), normal(random), 0.5});
  }
  at.position += 0.03 * (to.position - at.position);
  at.orientation = at.orientation.slerp(0.03, to.orientation).normalized();
  return at;
}

TEST(Frames, NoFrameExceedsItsLimitOfWork) {
  constexpr std::uint64_t kOneLeaf = 100;  // is finished
  const mesh::TriangleMesh pin = test::prism(test::circle(.005, 144), -.015, .015);
  for (const double clearance : {2e-4, 5e-5}) {
    for (const std::uint64_t most : {std::uint64_t{5000}, VirtualToolOptions{}.max_work}) {
      VirtualToolOptions options;
      options.max_work = most;
      Rig rig(pin, test::block_with_hole(test::circle(.005 + clearance, 144), .02, -.02, .02),
              options);
      ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
      std::mt19937 random(3);
      Pose at, to;
      const Journey journey =
          travel(rig, 1500, [&](int k) { return wandering(random, k, 1e-3, 0.03, at, to); });
      EXPECT_LE(journey.most_work, most + kOneLeaf) << clearance;
      EXPECT_EQ(journey.intersections, 0) << clearance;
    }
  }
}

TEST(Frames, APinThatMovesFreelyKeepsWithinTheLimitOfWork) {
  Rig rig(test::prism(test::circle(.005, 144), -.015, .015),
          test::block_with_hole(test::circle(.0052, 144), .02, -.02, .02));
  ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
  std::mt19937 random(3);
  Pose at, to;
  for (int k = 0; k < 3000; ++k) {
    const Pose hand = wandering(random, k, 3e-5, 0.002, at, to);
    const VirtualToolFrame frame = rig.frame(hand);
    ASSERT_FALSE(frame.cut_short || frame.not_converged || frame.constrained) << k;
    ASSERT_EQ(frame.tool, hand) << k;
  }
}

TEST(Frames, InvalidPosesGiveNoForceAndKeepTheTool) {
  Rig rig(test::ball(0.01, 2), test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}));
  const Pose hand{{0, 0, 0.02}, Quat::Identity()};
  ASSERT_TRUE(rig.virtual_tool.place(hand, {&rig.object_pose, 1}));
  Pose bad = hand;
  bad.position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(rig.frame(bad).pose_status, PoseStatus::kNotAPose);
  bad = hand;
  bad.orientation.coeffs().setZero();
  EXPECT_EQ(rig.frame(bad).pose_status, PoseStatus::kNotAPose);
  bad = hand;
  bad.position.x() = 1e9;
  EXPECT_EQ(rig.frame(bad).pose_status, PoseStatus::kOutOfRange);
  EXPECT_TRUE(rig.frame(bad).wrench(1000.0).zero());
  EXPECT_EQ(rig.frame(hand).tool, hand);
}

TEST(Frames, TheDisplayedStiffnessIsAtMostTheSprings) {
  Rig rig(test::box({-.004, -.006, -.015}, {.004, .006, .015}), test::bowl(0.03, 0.034, 48, 12));
  ASSERT_TRUE(rig.virtual_tool.place({}, {&rig.object_pose, 1}));
  for (int k = 0; k < 500; ++k) {
    const VirtualToolFrame frame = rig.frame(tumbling(k));
    const Eigen::SelfAdjointEigenSolver<Mat6> values(frame.displayed);
    ASSERT_LT(values.eigenvalues().maxCoeff(), 1.0 + 1e-9);
    ASSERT_GT(values.eigenvalues().minCoeff(), -1e-9);
  }
}

/// The hand jumps in contact to a random place: free, or within the block. No frame exceeds its
/// work limit, and there is no force until the tool has converged.
TEST(Frames, ALostHandIsFoundOrTheToolStays) {
  VirtualToolOptions options;
  options.max_work = 4000;
  const mesh::TriangleMesh block = test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0});
  for (const double back : {0.0102, 0.004}) {
    Rig rig(test::ball(0.01, 3), block, options);
    ASSERT_TRUE(rig.virtual_tool.place({{0, 0, 0.011}, Quat::Identity()}, {&rig.object_pose, 1}));
    const Pose pressed =
        rig.lead({{0, 0, 0.011}, Quat::Identity()}, {{0, 0, 0.007}, Quat::Identity()}, 100).tool;
    rig.virtual_tool.relocate();
    const Pose hand{{0.05, 0, back}, Quat::Identity()};
    int frames = 0;
    VirtualToolFrame frame;
    do {
      frame = rig.frame(hand);
      ASSERT_LT(frame.work, options.max_work + options.max_work / 5);
      ASSERT_LT(++frames, 100);
      if (frame.not_initialised) {
        ASSERT_TRUE(frame.wrench(1000.0).zero());
      }
    } while (frame.not_initialised);
    EXPECT_LT(frame.ratio, 0.01);
    if (back > 0.01) {
      EXPECT_EQ(frame.tool.position, hand.position);
    } else {
      EXPECT_LT((frame.tool.position - pressed.position).norm(), 2e-3);
      EXPECT_NEAR(frame.tool.position.z(), 0.01, 1e-4);
      EXPECT_NEAR(rig.rest(hand, 2000).tool.position.x(), 0.05, 1e-3);
    }
    EXPECT_FALSE(rig.intersects());
  }
}

/// State that a rebuilt scene takes over from the previous one.
TEST(Frames, TakenOverToolHasItsWholeForceAtOnce) {
  const mesh::TriangleMesh block = test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0});
  Rig rig(test::ball(0.01, 3), block);
  rig.virtual_tool.start_at({{0, 0, 0.0101}, Quat::Identity()});
  VirtualToolFrame frame;
  for (int k = 0; k < 100 && (k == 0 || frame.not_initialised); ++k)
    frame = rig.frame({{0, 0, 0.005}, Quat::Identity()});
  EXPECT_TRUE(frame.constrained);
  EXPECT_EQ(frame.ratio, 1.0);
  EXPECT_NEAR(frame.wrench(1000.0).force.z(), 5.0, 0.2);
  rig.virtual_tool.start_at({{0, 0, 0.0}, Quat::Identity()});  // no start
  EXPECT_TRUE(rig.rest({{0, 0, 0.005}, Quat::Identity()}, 100).not_initialised);
  EXPECT_FALSE(rig.rest({{0, 0, 0.02}, Quat::Identity()}, 100).not_initialised);
}

TEST(Frames, ResetRestartsTheTool) {
  Rig rig(test::ball(0.01, 2), test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}));
  ASSERT_TRUE(rig.virtual_tool.place({{0, 0, 0.02}, Quat::Identity()}, {&rig.object_pose, 1}));
  rig.virtual_tool.reset();
  EXPECT_TRUE(rig.frame({{0, 0, -0.005}, Quat::Identity()}).not_initialised);
  EXPECT_FALSE(rig.rest({{0, 0, 0.02}, Quat::Identity()}, 10).not_initialised);
}

/// 0.2 mm above a plate, up to 7.8 mm per frame: nothing is touched, so the tool is at the hand.
TEST(Frames, AFreeToolIsTheHandUpToEightMillimetresAFrame) {
  Rig rig(test::ball(0.01, 4), test::box({-.06, -.06, -.06}, {.06, .06, 0.0}));
  for (const double step : {2e-4, 2e-3, 4e-3, 7.8e-3}) {
    Pose hand{{-0.04, 0, 0.0102}, Quat::Identity()};
    ASSERT_TRUE(rig.virtual_tool.place(hand, {&rig.object_pose, 1}));
    for (; hand.position.x() < 0.04; hand.position.x() += step) {
      const VirtualToolFrame frame = rig.frame(hand);
      ASSERT_EQ(frame.tool, hand) << step;
      ASSERT_FALSE(frame.not_converged) << step;
    }
  }
}

/// A ball across the edge of a block: the contact point is on the edge.
TEST(Frames, TheContactPointLiesOnTheObject) {
  Rig rig(test::ball(0.01, 4), test::box({-.03, -.03, -.06}, {.03, .03, 0.0}));
  for (const Vec3& moved : {Vec3(0, 0, 0), Vec3(0.013, -0.004, 0.0071)}) {
    rig.object_pose.position = moved;
    const Vec3 slant = Vec3(1, 0, 1).normalized(), edge = moved + Vec3(0.03, 0.0007, 0.0);
    const Pose from{edge + 0.011 * slant, Quat::Identity()};
    ASSERT_TRUE(rig.virtual_tool.place(from, {&rig.object_pose, 1}));
    const VirtualToolFrame frame = rig.lead(from, {edge + 0.005 * slant, Quat::Identity()}, 120);
    EXPECT_NEAR(frame.contact_point.x(), edge.x(), 1e-10);
    EXPECT_NEAR(frame.contact_point.z(), edge.z(), 1e-10);
  }
}

}  // namespace
}  // namespace voxtouch::exact
