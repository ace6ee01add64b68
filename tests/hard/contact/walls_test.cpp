// Walls from a tenth of a voxel to five, met from both sides at all speeds; and tools pushed deep.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "core/contact/limits.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::test {
namespace {

constexpr double kEdge = 1e-3, kPeriod = 1e-3;
constexpr std::array kModels = {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted, contact::ContactModelKind::kField};
/// [e]; the wall's middle lies askew in its voxel.
constexpr std::array kWalls = {0.1, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0};
constexpr double kSwept = contact::limits::kMaxSubPoses * contact::limits::kSubStepEdges;  // [e]

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

/// A wall about the origin of `base`, across its z axis, and a small ball that goes through it.
struct Wall {
  double thick;  ///< [e]
  Quat turn;
  Ball ball{2.5 * kEdge, 3};
  pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  Ground ground;
  Wall(double thick_edges, const Quat& turned)
      : thick(thick_edges), turn(turned),
        ground(box_mesh(Vec3(30 * kEdge, 30 * kEdge, thick * kEdge), {kEdge * Vec3(0.13, 0.41, 0.37), turned}), kEdge) {
  }

  Vec3 across() const { return turn * Vec3::UnitZ(); }
  /// The ball's middle `z` [m] from the wall's, along its normal.
  Pose at(double z, const Vec3& aside = Vec3::Zero(), const Quat& orientation = Quat::Identity()) const {
    return ball.posed(kEdge * Vec3(0.13, 0.41, 0.37) + turn * (aside + Vec3(0, 0, z)), orientation);
  }
  double touch_m() const { return 2.5 * kEdge + 0.5 * thick * kEdge; }
};

/// Whether a model feels a wall at all: `original` and `adapted` whatever has a surface layer, `field` where
/// a voxel's corner lies inside.
bool felt(const Wall& wall, contact::ContactModelKind kind) {
  return kind != contact::ContactModelKind::kField || (wall.thick >= 1.0 && wall.ground.field.has_inside());
}

const std::array kTurns = {Quat::Identity(), Quat(Eigen::AngleAxisd(0.5, Vec3(2, 1, -1).normalized()))};

struct Crossing {
  double pushed_on = 0.0,
         most = 0.0;  ///< [N]: largest push along the motion up to where the tool is out of reach; any push
  int crossed = 0, fast = 0;
  int missed = 0, unseen_behind = 0;  ///< as long as a crossed wall is held for certain
};

/// Straight through the wall, `step` [e] a frame, from `side` (+1, -1) of it.
Crossing drive_through(const Wall& wall, contact::ContactModelKind kind, double step, double side, double phase) {
  contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
  Crossing seen;
  const double begin = wall.touch_m() + (1.0 + phase * step) * kEdge;
  const double end = wall.touch_m() + std::max(1.0, step) * kEdge;  // a frame behind the wall, wherever the first one was
  for (double z = begin; z > -std::max(begin + kEdge, end); z -= step * kEdge) {
    const contact::StageResult r = renderer.render(wall.at(side * z));
    EXPECT_TRUE(r.contact.wrench.finite());
    const double on = -side * r.contact.wrench.force.dot(wall.across());
    seen.pushed_on = std::max(seen.pushed_on, on);
    seen.most = std::max(seen.most, std::abs(on));
    seen.crossed += r.crossed, seen.fast += r.fast;
    if (wall.touch_m() - z > 2.0 * renderer.query().reach_m() + renderer.swept_m()) continue;
    seen.missed += r.missed;
    seen.unseen_behind += z < -wall.touch_m() && !r.crossed;
  }
  return seen;
}

TEST(V7WallThinnerThanAVoxel, IsNeverCrossedUnseenUpToTheTopSpeedAndNeverPushesOn) {
  const std::uint64_t seed = voxtouch::testing::seed(701);
  SCOPED_TRACE(voxtouch::testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  for (const Quat& turn : kTurns)
    for (const double thick : kWalls) {
      const Wall wall(thick, turn);
      for (const contact::ContactModelKind kind : kModels) {
        Crossing all;
        int ways = 0;
        for (const double step : {0.51, 0.7, 1.0, 1.7, 2.5, 3.3, 3.99})
          for (const double side : {1.0, -1.0}) {
            const Crossing one = drive_through(wall, kind, step, side, uniform(random, 0.0, 1.0));
            SCOPED_TRACE(::testing::Message()
                         << contact::name_of(kind) << ", wall " << thick << " e, " << step << " e a frame, side " << side);
            ++ways;
            EXPECT_EQ(one.missed, 0);
            all.most = std::max(all.most, one.most), all.pushed_on = std::max(all.pushed_on, one.pushed_on);
            if (!felt(wall, kind)) continue;
            EXPECT_EQ(one.unseen_behind, 0);
            EXPECT_GT(one.crossed, 0);
            EXPECT_LE(one.pushed_on, 0.02 * one.most);
          }
        std::printf("%s wall %.1f e %s: pushes up to %.3g N, on up to %.3g N, %d ways\n",
                    std::string(contact::name_of(kind)).c_str(), thick, turn.w() < 1.0 ? "askew" : "aligned", all.most,
                    all.pushed_on, ways);
      }
    }
}

TEST(V7WallThinnerThanAVoxel, PushesBackFromBothSidesWhileTheToolIsPressedSlowly) {
  // One-sided contact: until the tool's middle has reached the wall's.
  for (const Quat& turn : kTurns)
    for (const double thick : kWalls) {
      const Wall wall(thick, turn);
      for (const contact::ContactModelKind kind : kModels)
        for (const double side : {1.0, -1.0}) {
          contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
          double back = 0.0, on = 0.0;
          for (double z = wall.touch_m() + kEdge; z > 0.5 * (thick + 1.0) * kEdge; z -= 0.05 * kEdge) {
            const contact::StageResult r = renderer.render(wall.at(side * z));
            EXPECT_FALSE(r.fast || r.crossed || r.missed);
            const double push = side * r.contact.wrench.force.dot(wall.across());
            back = std::max(back, push), on = std::max(on, -push);
          }
          SCOPED_TRACE(::testing::Message() << contact::name_of(kind) << ", wall " << thick << " e, side " << side);
          EXPECT_LE(on, 0.02 * back + 1e-12);
          if (felt(wall, kind)) {
            EXPECT_GT(back, 0.0);
          }
        }
    }
}

TEST(FastMotion, AboveTheTopSpeedIsFlaggedAndBelowHalfAVoxelNothingIsWalked) {
  const Wall wall(1.0, kTurns[1]);
  for (const contact::ContactModelKind kind : kModels) {
    EXPECT_EQ(drive_through(wall, kind, 0.49, 1.0, 0.3).fast, 0);
    contact::ContactRenderer slow = wall.ground.renderer(wall.shell, kind);
    for (double z = 6.0; z > -6.0; z -= 0.49) slow.render(wall.at(z * kEdge));
    EXPECT_EQ(slow.sub_poses(), 0U);
    EXPECT_NEAR(slow.swept_m(), kSwept * kEdge, 1e-15);
    for (const double step : {kSwept * 1.001, 6.0, 20.0}) {
      contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
      EXPECT_FALSE(renderer.render(wall.at(8 * kEdge)).missed);
      const contact::StageResult r = renderer.render(wall.at((8 - step) * kEdge));
      EXPECT_TRUE(r.missed && r.fast) << step;
    }
    // No frame looks up more than is stated.
    contact::ContactRenderer fast = wall.ground.renderer(wall.shell, kind);
    std::uint64_t before = 0;
    for (double z = 30.0; z > -30.0; z -= 3.99) {
      fast.render(wall.at(z * kEdge));
      EXPECT_LE(fast.sub_poses() - before, contact::limits::kMaxSubPoses + 1U);
      before = fast.sub_poses();
    }
    EXPECT_GT(before, 0U);
  }
}

TEST(FastMotion, EndsWhereASlowWalkOfTheSameWayEnds) {
  // Into a thick block: what the stage remembers, and the force, are those of half-voxel steps, to the bit.
  const Wall wall(20.0, kTurns[1]);
  for (const contact::ContactModelKind kind : kModels) {
    contact::ContactRenderer fast = wall.ground.renderer(wall.shell, kind), slow = wall.ground.renderer(wall.shell, kind);
    const double begin = wall.touch_m() + 0.3 * kEdge;
    fast.render(wall.at(begin)), slow.render(wall.at(begin));
    for (int frame = 1; frame <= 2; ++frame) {
      const Pose from = wall.at(begin - 2.0 * (frame - 1) * kEdge), to = wall.at(begin - 2.0 * frame * kEdge);
      const contact::StageResult r = fast.render(to);
      Wrench walked;
      const contact::MotionPath path(from, to);
      const int steps = path.steps(slow.query().reach_m(), 0.5 * kEdge, 8);
      EXPECT_EQ(steps, 4);
      slow.render(path.at(0.0));
      for (int n = 1; n <= steps; ++n) walked = slow.render(path.at(static_cast<double>(n) / steps)).contact.wrench;
      EXPECT_TRUE(r.fast && !r.crossed && !r.missed);
      EXPECT_FALSE(walked.zero());
      EXPECT_EQ(r.contact.wrench.force, walked.force) << contact::name_of(kind);
      EXPECT_EQ(r.contact.wrench.torque, walked.torque) << contact::name_of(kind);
    }
  }
}

TEST(FastMotion, LetsGoWhenTheToolComesBackOrGoesFarAway) {
  const Wall wall(0.5, kTurns[1]);
  for (const contact::ContactModelKind kind : {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
    const auto at = [&](double z) { return renderer.render(wall.at(z * kEdge)); };
    for (double z = 6.0; z >= -6.0; z -= 3.0) at(z);
    const contact::StageResult behind = at(-6.0);
    ASSERT_TRUE(behind.crossed) << contact::name_of(kind);
    EXPECT_FALSE(behind.fast);
    EXPECT_GT(behind.contact.wrench.force.dot(wall.across()), 0.0);
    // Back through, slowly: held until where it came in, then as if never there.
    double last = -6.0;
    for (; last < 6.0; last += 0.2) {
      const contact::StageResult r = at(last);
      EXPECT_GE(r.contact.wrench.force.dot(wall.across()), 0.0) << last;
      EXPECT_FALSE(r.missed);
    }
    EXPECT_FALSE(at(last).crossed);
    EXPECT_TRUE(at(last).contact.wrench.zero());
    // Through again and on: let go of within twice the reach and what a frame walks, and told so.
    for (double z = 6.0; z >= -6.0; z -= 3.0) at(z);
    ASSERT_TRUE(at(-6.0).crossed);
    int missed = 0;
    double let_go = 0.0;
    for (double z = -6.0; z > -25.0; z -= 0.4) {
      const contact::StageResult r = at(z);
      if (r.missed) ++missed, let_go = z;
      if (missed > 0) {
        EXPECT_TRUE(r.contact.wrench.zero());
      }
    }
    EXPECT_EQ(missed, 1);
    EXPECT_GE(let_go, -(2.0 * renderer.query().reach_m() / kEdge + kSwept + 3.5));
    // And after a reset nothing is remembered.
    for (double z = 6.0; z >= -6.0; z -= 3.0) at(z);
    renderer.reset();
    EXPECT_TRUE(at(-6.0).contact.wrench.zero());
  }
}

TEST(FastMotion, ATurnIsWalkedTooAndAStickDoesNotSwingThroughAWall) {
  // A stick of 20 e swings about its end through a thin wall, its tip at up to 3.9 e a frame.
  const mesh::TriangleMesh stick = box_mesh(Vec3(20, 1.2, 1.2) * kEdge, {Vec3(10, 0, 0) * kEdge, Quat::Identity()});
  const pointshell::Pointshell shell = exact_shell(stick, kEdge);
  const Ground ground(box_mesh(Vec3(10, 20, 0.4) * kEdge, {Vec3(15.1, 0.2, 0.35) * kEdge, Quat::Identity()}), kEdge);
  for (const contact::ContactModelKind kind : {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted})
    for (const double step : {0.05, 0.11, 0.19}) {
      contact::ContactRenderer renderer = ground.renderer(shell, kind);
      bool crossed = false;
      for (double angle = 0.5; angle > -0.35; angle -= step) {
        const contact::StageResult r = renderer.render({Vec3::Zero(), Quat(Eigen::AngleAxisd(-angle, Vec3::UnitY()))});
        EXPECT_FALSE(r.missed);
        crossed = crossed || r.crossed;
        EXPECT_LE(r.contact.wrench.torque.y(), 1e-9)
            << "towards where it came from, " << contact::name_of(kind) << " at " << angle;
        if (angle < -0.2) {
          EXPECT_TRUE(r.crossed) << contact::name_of(kind) << " at " << angle;
        }
      }
      EXPECT_TRUE(crossed);
    }
}

TEST(FastMotion, SlidingOverAWallOrOffItsEdgeIsNoCrossing) {
  const std::uint64_t seed = voxtouch::testing::seed(702);
  SCOPED_TRACE(voxtouch::testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  const Wall wall(6.0, kTurns[1]);
  for (const contact::ContactModelKind kind : kModels)
    for (int n = 0; n < 20; ++n) {
      contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
      const double angle = uniform(random, 0, 6.2831853), step = uniform(random, 0.6, 3.9),
                   depth = uniform(random, 0.1, 1.2);
      const Vec3 way(std::cos(angle), std::sin(angle), 0.0);
      for (double s = -12.0; s < 22.0; s += step) {
        const contact::StageResult r = renderer.render(wall.at(wall.touch_m() - depth * kEdge, s * kEdge * way));
        EXPECT_FALSE(r.crossed || r.missed) << contact::name_of(kind) << " at " << s;
      }
    }
}

/// A mass that flies at a wall at 1 kHz and is pushed by nothing but the contact.
struct Drop {
  double exit_speed = 0.0;  ///< [m/s] on the far side; 0: it came back or stays
  bool crossed = false, missed = false, fast = false;
};

Drop drop(const Wall& wall, contact::ContactModelKind kind, double speed, double side, double phase) {
  contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
  // A stiffness at which 1 kHz is stable: m/T^2 of what the whole ball can show.
  const double area = 4.0 * 3.14159 * std::pow(2.5 * kEdge, 2), mass = kPressure * area * kPeriod * kPeriod * 0.5;
  Drop out;
  double z = wall.touch_m() + (0.5 + phase) * kEdge, v = -speed;
  const double far = -wall.touch_m() - 2.0 * renderer.query().reach_m() - kSwept * kEdge;
  const int frames = static_cast<int>(std::min(20000.0, 6.0 * (z - far) / (speed * kPeriod)) + 200);
  for (int n = 0; n < frames; ++n) {
    const contact::StageResult r = renderer.render(wall.at(side * z));
    out.crossed = out.crossed || r.crossed, out.missed = out.missed || r.missed, out.fast = out.fast || r.fast;
    v += kPeriod * side * r.contact.wrench.force.dot(wall.across()) / mass;
    z += kPeriod * v;
    if (z > wall.touch_m() + 3.0 * kEdge && v > 0.0) break;
    if (z < far - kSwept * kEdge) {
      out.exit_speed = -v;
      break;
    }
  }
  return out;
}

TEST(F4Tunnelling, ADroppedMassNeverLeavesFasterOnTheFarSideAndNeverUnseenBelowTheTopSpeed) {
  const std::uint64_t seed = voxtouch::testing::seed(704);
  SCOPED_TRACE(voxtouch::testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  for (const double thick : {0.1, 0.5, 1.0, 2.0, 5.0}) {
    const Wall wall(thick, kTurns[1]);
    for (const contact::ContactModelKind kind : kModels) {
      if (!felt(wall, kind)) continue;
      double stopped_up_to = 1e9;
      for (const double speed : {0.001, 0.01, 0.05, 0.1, 0.3, 0.6, 1.0, 2.0, 3.0, 3.9, 5.0, 10.0})
        for (const double side : {1.0, -1.0}) {
          const Drop d = drop(wall, kind, speed, side, uniform(random, 0.0, 1.0));
          SCOPED_TRACE(::testing::Message()
                       << contact::name_of(kind) << ", wall " << thick << " e, " << speed << " m/s, side " << side);
          if (speed < kSwept * kEdge / kPeriod) {
            if (d.exit_speed > 0.0) {
              // A mass with more energy than the wall takes: a slow one loses what it had to climb and gets it back.
              EXPECT_TRUE(d.fast ? d.crossed && d.missed : d.exit_speed < 1.1 * speed)
                  << "exit at " << d.exit_speed << " m/s";
              if (d.fast) {
                EXPECT_LT(d.exit_speed, speed);
              }
              stopped_up_to = std::min(stopped_up_to, speed);
            }
          } else {
            EXPECT_TRUE(d.missed);
          }
        }
      std::printf("%s wall %.1f e: slowest drop that came through %.3g m/s\n", std::string(contact::name_of(kind)).c_str(),
                  thick, stopped_up_to);
    }
  }
}

}  // namespace
}  // namespace voxtouch::test
