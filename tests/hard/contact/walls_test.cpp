// Walls from a tenth of a voxel to five, met from both sides at all speeds; and deep tools.
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
constexpr std::array kModels = {contact::ContactModelKind::kOriginal,
                                contact::ContactModelKind::kAdapted,
                                contact::ContactModelKind::kField};
/// [e]; the wall's middle lies askew in its voxel.
constexpr std::array kWalls = {0.1, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0};

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

/// A wall about the origin of `base`, across its z axis, and a small ball that passes through it.
struct Wall {
  double thick;  ///< [e]
  Quat turn;
  Ball ball{2.5 * kEdge, 3};
  pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  Ground ground;
  Wall(double thick_edges, const Quat& turned)
      : thick(thick_edges),
        turn(turned),
        ground(box_mesh(Vec3(30 * kEdge, 30 * kEdge, thick * kEdge),
                        {kEdge * Vec3(0.13, 0.41, 0.37), turned}),
               kEdge) {}

  Vec3 across() const { return turn * Vec3::UnitZ(); }
  /// The ball's middle `z` [m] from the wall's, along its normal.
  Pose at(double z, const Vec3& aside = Vec3::Zero(),
          const Quat& orientation = Quat::Identity()) const {
    return ball.posed(kEdge * Vec3(0.13, 0.41, 0.37) + turn * (aside + Vec3(0, 0, z)), orientation);
  }
  double touch_m() const { return 2.5 * kEdge + 0.5 * thick * kEdge; }
};

/// Whether a model has a force at a wall: `original` and `adapted` with any surface layer, `field`
/// with a voxel corner inside.
bool has_force(const Wall& wall, contact::ContactModelKind kind) {
  return kind != contact::ContactModelKind::kField ||
         (wall.thick >= 1.0 && wall.ground.field.has_inside());
}

const std::array kTurns = {Quat::Identity(),
                           Quat(Eigen::AngleAxisd(0.5, Vec3(2, 1, -1).normalized()))};

struct Passage {
  double pushed_on = 0.0,
         most = 0.0;  ///< [N]: largest force along the motion before the centres meet; any force
  int fast = 0, tunnelling_suspected = 0,
      near = 0;  ///< frames; near: that moved while some point was next to the wall
};

/// Straight through the wall, `step` [e] per frame, from its side `side` (+1, -1).
Passage drive_through(const Wall& wall, contact::ContactModelKind kind, double step, double side,
                      double phase) {
  contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
  Passage seen;
  const double begin = wall.touch_m() + (40.0 + phase * step) * kEdge;
  for (double z = begin; z > -begin; z -= step * kEdge) {
    const contact::StageResult r = renderer.render(wall.at(side * z));
    EXPECT_TRUE(r.contact.wrench.finite());
    const double on = -side * r.contact.wrench.force.dot(wall.across());
    if (z > 0.5 * (wall.thick + 1.0) * kEdge)
      seen.pushed_on = std::max(seen.pushed_on, on);
    seen.most = std::max(seen.most, std::abs(on));
    seen.fast += r.fast, seen.tunnelling_suspected += r.tunnelling_suspected;
    const bool near = z < begin && z - wall.touch_m() < kEdge && z + step * kEdge > -wall.touch_m();
    seen.near += near;
    if (r.fast && near) {
      EXPECT_TRUE(r.tunnelling_suspected) << z;
    }
  }
  return seen;
}

TEST(V7WallThinnerThanAVoxel, IsNeverPassedUnreported) {
  const std::uint64_t seed = voxtouch::testing::seed(701);
  SCOPED_TRACE(voxtouch::testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  for (const Quat& turn : kTurns)
    for (const double thick : kWalls) {
      const Wall wall(thick, turn);
      for (const contact::ContactModelKind kind : kModels)
        for (const double step : {0.3, 0.49, 0.51, 1.0, 2.5, 3.99, 8.0, 40.0})
          for (const double side : {1.0, -1.0}) {
            const Passage one = drive_through(wall, kind, step, side, uniform(random, 0.0, 1.0));
            SCOPED_TRACE(::testing::Message() << contact::name_of(kind) << ", wall " << thick
                                              << " e, " << step << " e a frame, side " << side);
            if (step < 0.5) {
              EXPECT_EQ(one.fast + one.tunnelling_suspected, 0);
              EXPECT_LE(one.pushed_on, 0.02 * one.most + 1e-12);
              if (has_force(wall, kind)) {
                EXPECT_GT(one.most, 0.0);
              }
            } else {
              EXPECT_GE(one.tunnelling_suspected, 1);
              EXPECT_GE(one.tunnelling_suspected, one.near);
              if (step < 8.0) {
                EXPECT_LT(one.tunnelling_suspected, one.fast)
                    << "far from all that is there nothing can be missed";
              }
            }
          }
    }
}

TEST(V7WallThinnerThanAVoxel, PushesBackFromBothSides) {
  // One-sided contact: until the tool's middle has reached the wall's.
  for (const Quat& turn : kTurns)
    for (const double thick : kWalls) {
      const Wall wall(thick, turn);
      for (const contact::ContactModelKind kind : kModels)
        for (const double side : {1.0, -1.0}) {
          contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
          double back = 0.0, on = 0.0;
          for (double z = wall.touch_m() + kEdge; z > 0.5 * (thick + 1.0) * kEdge;
               z -= 0.05 * kEdge) {
            const contact::StageResult r = renderer.render(wall.at(side * z));
            EXPECT_FALSE(r.fast || r.tunnelling_suspected);
            const double push = side * r.contact.wrench.force.dot(wall.across());
            back = std::max(back, push), on = std::max(on, -push);
          }
          SCOPED_TRACE(::testing::Message()
                       << contact::name_of(kind) << ", wall " << thick << " e, side " << side);
          EXPECT_LE(on, 0.02 * back + 1e-12);
          if (has_force(wall, kind)) {
            EXPECT_GT(back, 0.0);
          }
        }
    }
}

TEST(FastMotion, RotationIsReported) {
  // A stick of 20 e swings about its end through a thin wall.
  const mesh::TriangleMesh stick =
      box_mesh(Vec3(20, 1.2, 1.2) * kEdge, {Vec3(10, 0, 0) * kEdge, Quat::Identity()});
  const pointshell::Pointshell shell = exact_shell(stick, kEdge);
  const Ground ground(
      box_mesh(Vec3(10, 20, 0.4) * kEdge, {Vec3(15.1, 0.2, 0.35) * kEdge, Quat::Identity()}),
      kEdge);
  for (const contact::ContactModelKind kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted})
    for (const double step : {0.01, 0.05, 0.19}) {
      contact::ContactRenderer renderer = ground.renderer(shell, kind);
      bool tunnelling_suspected = false;
      for (double angle = 0.5; angle > -0.35; angle -= step)
        tunnelling_suspected =
            tunnelling_suspected ||
            renderer.render({Vec3::Zero(), Quat(Eigen::AngleAxisd(-angle, Vec3::UnitY()))})
                .tunnelling_suspected;
      EXPECT_EQ(tunnelling_suspected, step > 0.02) << contact::name_of(kind) << " at " << step;
    }
}

TEST(FastMotion, IsClearedByResetAndQuietOffTheWall) {
  const Wall wall(0.5, kTurns[1]);
  for (const contact::ContactModelKind kind : kModels) {
    contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
    const auto at = [&](double z) { return renderer.render(wall.at(z * kEdge)); };
    EXPECT_FALSE(at(6.0).tunnelling_suspected) << "the first pose";
    EXPECT_TRUE(at(-6.0).tunnelling_suspected) << "a jump over the wall";
    renderer.reset();
    EXPECT_FALSE(at(6.0).tunnelling_suspected);
    renderer.reset();
    at(200.0);
    const contact::StageResult far = at(150.0);
    EXPECT_TRUE(far.fast && !far.tunnelling_suspected);
  }
}

/// A free mass that meets a wall at 1 kHz; only the contact acts on it.
struct Drop {
  double exit_speed = 0.0;  ///< [m/s] on the far side; 0: it returned or stays
  bool tunnelling_suspected = false, fast = false;
};

Drop drop(const Wall& wall, contact::ContactModelKind kind, double speed, double side,
          double phase) {
  contact::ContactRenderer renderer = wall.ground.renderer(wall.shell, kind);
  // A stable stiffness at 1 kHz: a fraction of m/T^2 for the whole ball.
  const double area = 4.0 * 3.14159 * std::pow(2.5 * kEdge, 2),
               mass = kPressure * area * kPeriod * kPeriod * 0.5;
  Drop out;
  double z = wall.touch_m() + (0.5 + phase) * kEdge, v = -speed;
  const double far = -wall.touch_m() - 2.0 * renderer.query().reach_m();
  const int frames = static_cast<int>(std::min(20000.0, 6.0 * (z - far) / (speed * kPeriod)) + 200);
  for (int n = 0; n < frames; ++n) {
    const contact::StageResult r = renderer.render(wall.at(side * z));
    out.tunnelling_suspected = out.tunnelling_suspected || r.tunnelling_suspected,
    out.fast = out.fast || r.fast;
    v += kPeriod * side * r.contact.wrench.force.dot(wall.across()) / mass;
    z += kPeriod * v;
    if (z > wall.touch_m() + 3.0 * kEdge && v > 0.0)
      break;
    if (z < far - 4.0 * kEdge) {
      out.exit_speed = -v;
      break;
    }
  }
  return out;
}

TEST(F4Tunnelling, FastPassThroughIsReported) {
  const std::uint64_t seed = voxtouch::testing::seed(704);
  SCOPED_TRACE(voxtouch::testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  for (const double thick : {0.1, 0.5, 1.0, 2.0, 5.0}) {
    const Wall wall(thick, kTurns[1]);
    for (const contact::ContactModelKind kind : kModels) {
      if (!has_force(wall, kind))
        continue;
      double stopped_up_to = 1e9, faster = 0.0;
      for (const double speed : {0.001, 0.01, 0.05, 0.1, 0.3, 0.6, 1.0, 2.0, 3.0, 3.9, 5.0, 10.0})
        for (const double side : {1.0, -1.0}) {
          const Drop d = drop(wall, kind, speed, side, uniform(random, 0.0, 1.0));
          SCOPED_TRACE(::testing::Message() << contact::name_of(kind) << ", wall " << thick
                                            << " e, " << speed << " m/s, side " << side);
          if (!(d.exit_speed > 0.0))
            continue;
          // A mass with more energy than the wall stores loses it in the wall and gets it back.
          EXPECT_TRUE(d.fast ? d.tunnelling_suspected : d.exit_speed < 1.1 * speed)
              << "exit at " << d.exit_speed << " m/s";
          stopped_up_to = std::min(stopped_up_to, speed),
          faster = std::max(faster, d.exit_speed / speed);
        }
      std::printf(
          "%s wall %.1f e: slowest drop that came through %.3g m/s; out at most %.2f times as "
          "fast\n",
          std::string(contact::name_of(kind)).c_str(), thick, stopped_up_to, faster);
    }
  }
}

}  // namespace
}  // namespace voxtouch::test
