// Memory of the stage: points that have passed through keep their force, return without a jump, and
// are forgotten.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/contact/limits.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace stage_hold_test {

constexpr double kEdge = 0.001;
constexpr double kStiffness = 1000.0;
constexpr double kUnit = kStiffness * kEdge;  // force of one point one voxel deep
const voxmap::Grid kGrid{Vec3::Zero(), kEdge};

pointshell::Pointshell ball() { return sphere_shell(10 * kEdge, kEdge); }

/// The ball over the middle of a block's top face at z = `top` voxels, its lowest point `depth`
/// edges below the face.
Pose over(double top, double depth, const Quat& turn = Quat::Identity(), double x = 30.13,
          double y = 29.77) {
  return {kEdge * Vec3(x, y, top + 10.0 - depth), turn};
}

/// Going in, the force may sag below its peak so far by the rim's voxel noise: this fraction of the
/// peak, and this many K e.
constexpr double kSagRatio = 0.02, kSagUnits = 1.5;

struct PushCase {
  int thickness;
  double depth, step;
  contact::ContactModelKind model;
  std::uint64_t seed;
};

class DeepPush : public ::testing::TestWithParam<PushCase> {};

TEST_P(DeepPush, KeepsItsForceInwardAndReturnsToZero) {
  const PushCase& c = GetParam();
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, c.thickness - 1});
  contact::ContactRenderer renderer(voxmap, ball(), c.model, {kStiffness});
  std::mt19937_64 random(c.seed);
  const Quat turn = random_rotation(random);
  const double x = uniform(random, 28, 32), y = uniform(random, 28, 32);
  const int steps = static_cast<int>(c.depth / c.step);
  double peak = 0.0, worst_sag = 0.0;
  for (int n = -10; n <= steps; ++n) {
    const contact::StageResult r = renderer.render(over(c.thickness, n * c.step, turn, x, y));
    const double up = r.contact.wrench.force.z();
    EXPECT_EQ(r.latched, r.contact.interior_hits > 0);
    if (r.contact.interior_hits > 0) {
      ASSERT_GT(up, 0.0) << "depth " << n * c.step;
    }
    ASSERT_GE(up, peak * (1.0 - kSagRatio) - kSagUnits * kUnit) << "depth " << n * c.step;
    ASSERT_LE(r.contact.wrench.force.norm(),
              kUnit * static_cast<double>(renderer.query().shell().size()));
    worst_sag = std::max(worst_sag, peak - up);
    peak = std::max(peak, up);
  }
  EXPECT_GT(peak, 50.0 * kUnit);
  double last = peak;
  for (int n = steps - 1; n >= -10; --n) {
    const contact::StageResult r = renderer.render(over(c.thickness, n * c.step, turn, x, y));
    const double up = r.contact.wrench.force.z();
    if (r.contact.interior_hits > 0) {
      ASSERT_GT(up, 0.0);
    }
    ASSERT_LE(std::abs(up - last), 0.15 * peak) << "no jump on the way out, depth " << n * c.step;
    last = up;
    if (r.contact.surface_hits + r.contact.interior_hits == 0) {
      EXPECT_TRUE(r.contact.wrench.zero());
      EXPECT_FALSE(r.latched);
    }
  }
  EXPECT_EQ(last, 0.0);
  std::printf("thickness %d, %s: peak %.1f K e, largest sag %.2f K e\n", c.thickness,
              std::string(contact::name_of(c.model)).c_str(), peak / kUnit, worst_sag / kUnit);
}

INSTANTIATE_TEST_SUITE_P(
    Pushes, DeepPush,
    ::testing::Values(PushCase{12, 10, 0.05, contact::ContactModelKind::kAdapted, 1},
                      PushCase{12, 10, 0.05, contact::ContactModelKind::kOriginal, 1},
                      PushCase{12, 10, 0.31, contact::ContactModelKind::kAdapted, 2},
                      PushCase{12, 10, 0.013, contact::ContactModelKind::kAdapted, 3},
                      PushCase{125, 100, 0.05, contact::ContactModelKind::kAdapted, 4},
                      PushCase{125, 100, 0.2, contact::ContactModelKind::kOriginal, 5}));

TEST(Hold, StaysUprightBeyondTheToolsEquator) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  contact::ContactRenderer renderer(voxmap, ball(), contact::ContactModelKind::kAdapted,
                                    {kStiffness});
  for (double depth = -0.5; depth < 35.0; depth += 0.1) {
    const Vec3 force = renderer.render(over(60, depth)).contact.wrench.force;
    if (depth > 2.0) {
      EXPECT_LE(force.head<2>().norm(), 0.05 * force.z()) << depth;
    }
  }
}

TEST(Hold, NeverPushesThroughAThinPlate) {
  for (const int thickness : {1, 2, 3, 5}) {
    const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, thickness - 1});
    contact::ContactRenderer renderer(voxmap, ball(), contact::ContactModelKind::kAdapted,
                                      {kStiffness});
    for (double depth = -0.5; depth < 9.0; depth += 0.05) {
      const contact::StageResult r = renderer.render(over(thickness, depth));
      EXPECT_GE(r.contact.wrench.force.z(), 0.0) << thickness << " at " << depth;
      if (r.contact.interior_hits > 0) {
        EXPECT_GT(r.contact.wrench.force.z(), 0.0);
      }
    }
  }
}

TEST(Hold, ForgetsEverythingOutOfContact) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  contact::ContactRenderer used(voxmap, ball(), contact::ContactModelKind::kAdapted, {kStiffness});
  contact::ContactRenderer fresh(voxmap, ball(), contact::ContactModelKind::kAdapted, {kStiffness});
  const Quat side(Eigen::AngleAxisd(1.1, Vec3::UnitX()));
  for (double depth = -0.5; depth < 4.0; depth += 0.1)
    used.render(over(60, depth, side));
  used.render(over(60, -5.0));
  fresh.render(over(60, -5.0));
  for (double depth = -0.5; depth < 4.0; depth += 0.1) {
    const contact::StageResult a = used.render(over(60, depth)), b = fresh.render(over(60, depth));
    EXPECT_TRUE(same_bits(a.contact.wrench, b.contact.wrench));
  }
}

TEST(Hold, IsForgottenByReset) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  contact::ContactRenderer renderer(voxmap, ball(), contact::ContactModelKind::kAdapted,
                                    {kStiffness});
  std::vector<Wrench> first;
  for (int pass = 0; pass < 3; ++pass) {
    std::size_t n = 0;
    for (double depth = 3.0; depth < 6.0;
         depth += 0.1, ++n) {  // starts inside: nothing is remembered there
      const Wrench w = renderer.render(over(60, depth)).contact.wrench;
      if (pass == 0)
        first.push_back(w);
      EXPECT_TRUE(same_bits(w, first[n]));
    }
    renderer.reset();
  }
}

TEST(Hold, DoesNotCreepWhileTheToolRests) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  contact::ContactRenderer renderer(voxmap, ball(), contact::ContactModelKind::kAdapted,
                                    {kStiffness});
  for (const double target : {2.3, 7.7, 12.1, 19.3}) {
    for (double depth = -0.5; depth < target; depth += 0.1)
      renderer.render(over(60, depth));
    renderer.render(over(60, target));
    const Wrench rest = renderer.render(over(60, target)).contact.wrench;
    for (int n = 0; n < 1000; ++n)
      ASSERT_TRUE(same_bits(renderer.render(over(60, target)).contact.wrench, rest));
    for (double depth = target; depth > -1.0; depth -= 0.1)
      renderer.render(over(60, depth));
  }
}

TEST(Hold, UnseenPointGetsOneEdgeAlongItsNormal) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  const Vec3 normal = Vec3(1, 2, 3).normalized();
  contact::ContactRenderer renderer(voxmap, shell_of({{Vec3(0.002, 0, 0), normal}}, kEdge),
                                    contact::ContactModelKind::kAdapted, {kStiffness});
  const contact::StageResult r = renderer.render({Vec3(0.03, 0.03, 0.03), Quat::Identity()});
  EXPECT_TRUE(r.latched);
  EXPECT_NEAR((r.contact.wrench.force - kUnit * normal).norm(), 0.0, 1e-15);
  EXPECT_NEAR((r.contact.wrench.torque - Vec3(0.002, 0, 0).cross(kUnit * normal)).norm(), 0.0,
              1e-15);
  EXPECT_EQ(r.contact.deepest_depth_m, kEdge);
  EXPECT_EQ(r.contact.stiffness_bound_n_per_m, kStiffness);
  EXPECT_TRUE(renderer.probe({Vec3(0.03, 0.03, 0.03), Quat::Identity()})
                  .wrench.zero());  // the memoryless law has none
}

TEST(Hold, KeepsTheLastDepthOfAPointThatGoesThrough) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  contact::ContactRenderer renderer(voxmap, shell_of({{Vec3::Zero(), Vec3::UnitZ()}}, kEdge),
                                    contact::ContactModelKind::kAdapted, {kStiffness});
  const auto at = [&](double z) {
    return renderer.render({kEdge * Vec3(30.2, 30.4, z), Quat::Identity()});
  };
  at(60.1), at(59.6);
  EXPECT_NEAR(at(59.1).contact.wrench.force.z(), 0.4 * kUnit, 1e-12);
  EXPECT_NEAR(at(58.9).contact.wrench.force.z(), 0.4 * kUnit, 1e-12);  // interior
  EXPECT_NEAR(at(58.5).contact.wrench.force.z(), 0.4 * kUnit, 1e-12);
  EXPECT_NEAR(at(58.9).contact.wrench.force.z(), 0.4 * kUnit, 1e-12);
  const contact::StageResult back = at(59.05);  // surface: the plain depth is larger again
  EXPECT_NEAR(back.contact.wrench.force.z(), 0.45 * kUnit, 1e-12);
  EXPECT_FALSE(back.latched);
}

TEST(Hold, FadesWithTheDistanceToTheReentry) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  contact::ContactRenderer renderer(voxmap, shell_of({{Vec3::Zero(), Vec3::UnitZ()}}, kEdge),
                                    contact::ContactModelKind::kAdapted, {kStiffness});
  const auto at = [&](double x, double z) {
    return renderer.render({kEdge * Vec3(x, 30.4, z), Quat::Identity()});
  };
  at(2.2, 60.1), at(2.2, 59.6), at(2.2, 59.1), at(2.2, 58.9);
  at(1.1, 58.9);  // sideways, still inside
  const contact::StageResult side =
      at(0.9, 58.9);  // the side's layer, 0.4 below a voxel's centre's level by chance
  EXPECT_NEAR(side.contact.wrench.force.z(), 0.2 * kUnit,
              1e-12);  // 0.4 - 0.2 moved; the plain law has none here
  EXPECT_TRUE(side.latched);
  EXPECT_NEAR(at(0.9, 58.9).contact.wrench.force.z(), 0.2 * kUnit, 1e-12);  // resting keeps it
  EXPECT_TRUE(at(0.65, 58.9).contact.wrench.zero());
}

TEST(Hold, ForgetsAPointThatReachesFreeSpaceWhileOthersStay) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  // The second point stays in the top layer and acts sideways only.
  contact::ContactRenderer renderer(
      voxmap,
      shell_of({{Vec3::Zero(), Vec3::UnitZ()}, {kEdge * Vec3(20, 0, 0.5), Vec3::UnitX()}}, kEdge),
      contact::ContactModelKind::kOriginal, {kStiffness});
  const auto at = [&](double x, double z) {
    return renderer.render({kEdge * Vec3(x, 30.4, z), Quat::Identity()});
  };
  const auto up = [](const contact::StageResult& r) { return r.contact.wrench.force.z() / kUnit; };
  at(-1.0, 59.2);  // free
  EXPECT_NEAR(up(at(5.2, 59.2)), 0.3, 1e-12);
  at(5.2, 58.8);
  EXPECT_NEAR(up(at(-0.8, 58.8)), 0.0,
              1e-12);  // out to the side, with only the other point in contact
  EXPECT_NEAR(up(at(0.2, 58.8)), 0.0,
              1e-12);  // back in a layer: the plain law, which has nothing here
  EXPECT_NEAR(up(at(-0.8, 58.8)), 0.0, 1e-12);
  EXPECT_NEAR(up(at(5.2, 58.8)), 1.0, 1e-12);  // straight inside: as if never seen
}

/// Hits made by hand, at a pose of choice.
struct Frame {
  std::vector<Vec3> surface,
      interior;  ///< normals; points are numbered surface first by default
  Vec3 position = Vec3::Zero();
  std::uint32_t first_interior = 0;
};

Vec3 staged_force(contact::ContactStage& stage, const Frame& frame) {
  std::vector<contact::Hit> surface, interior;
  for (std::uint32_t p = 0; p < frame.surface.size(); ++p)
    surface.push_back({.point = p,
                       .normal = frame.surface[p].normalized(),
                       .to_centre = 0.4 * kEdge * frame.surface[p].normalized()});
  for (std::uint32_t p = 0; p < frame.interior.size(); ++p)
    interior.push_back({.point = frame.first_interior + p,
                        .normal = frame.interior[p].normalized(),
                        .to_centre = Vec3::Zero()});
  contact::HitList hits;
  hits.pose_WT.position = frame.position;
  hits.surface = made_hits(surface, kEdge), hits.interior = made_hits(interior, kEdge);
  contact::ContactResult plain;
  contact::make_contact_model(contact::ContactModelKind::kAdapted, {1.0})->evaluate(hits, plain);
  return stage.apply(hits, plain).contact.wrench.force / kEdge;
}

TEST(Hold, DropsTheCommonDirectionWithTheContact) {
  const Vec3 slanted(1, 0, 1), left(1, 0, 0), right(-1, 0, 0);
  for (const bool by_reset : {false, true}) {
    contact::ContactStage stage({8, 0.01, kEdge, 1.0, contact::ContactModelKind::kAdapted});
    staged_force(stage, {{slanted}, {}, {}, 0});
    if (by_reset) {
      stage.reset();
    } else {
      staged_force(stage, {});
    }
    staged_force(stage,
                 {{left, right}, {}, {}, 0});  // a slot: no coherent mean, so no shared direction
    const Vec3 force = staged_force(stage, {{}, {left, right}, Vec3(0, 0, -1e-4), 0});
    EXPECT_NEAR(force.norm(), 0.0, 1e-12) << force.transpose();
  }
}

TEST(Hold, DoesNotFlipForOpposedSurfaceHits) {
  const Vec3 up(0, 0, 1), down(0, 0, -1);
  contact::ContactStage stage({8, 0.01, kEdge, 1.0, contact::ContactModelKind::kAdapted});
  staged_force(stage, {{up, up, up, up, up, up, up, up}, {}, {}, 0});
  EXPECT_NEAR(staged_force(stage, {{}, {up}, Vec3(0, 0, -1e-4), 7}).z(), 0.4, 1e-12);
  const Frame opposed{{down, down, down, down, down, down, down}, {up}, Vec3(0, 0, -2e-4), 7};
  EXPECT_NEAR(staged_force(stage, opposed).z(), -7 * 0.4 + 0.4,
              1e-12);  // seven forces down, the latched one still up
}

TEST(Hold, ReturningPointChangesTheForceWithinItsBound) {
  // One point that moves at random in and out of a block: down by at most K times the path, up by
  // at most a voxel step.
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {9, 9, 9});
  const Vec3 normal = Vec3(0.3, -0.4, 0.9).normalized();
  for (const auto kind :
       {contact::ContactModelKind::kAdapted, contact::ContactModelKind::kOriginal}) {
    contact::ContactRenderer renderer(voxmap, shell_of({{Vec3::Zero(), normal}}, kEdge), kind,
                                      {kStiffness});
    std::mt19937_64 random(99);
    Vec3 u(5, 5, 11);
    contact::StageResult last = renderer.render({kEdge * u, Quat::Identity()});
    int returns = 0, entries = 0;
    for (int n = 0; n < 200000; ++n) {
      Vec3 step(uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2));
      step -= 0.02 * (u - Vec3(5, 5, 9)).normalized();
      u += step;
      const contact::StageResult now = renderer.render({kEdge * u, Quat::Identity()});
      const double change =
          (now.contact.wrench.force.norm() - last.contact.wrench.force.norm()) / kUnit;
      if (last.contact.interior_hits == 1 && now.contact.surface_hits == 1) {
        ++returns;
        ASSERT_GE(change, -contact::limits::kFadePerMetre * step.norm() - 1e-9);
        ASSERT_LE(change, std::sqrt(0.75));
      }
      if (last.contact.surface_hits == 1 && now.contact.interior_hits == 1) {
        ++entries;
        ASSERT_GE(change, -1e-9);  // going through never takes force away
        ASSERT_LE(change, contact::limits::kLatchedDepthFloorEdges + 1e-9);
      }
      if (now.contact.interior_hits == 1) {
        ASSERT_GE(now.contact.wrench.force.norm(), 0.2499 * kUnit);
      }
      last = now;
    }
    EXPECT_GT(returns, 1000);
    EXPECT_GT(entries, 1000);
  }
}

TEST(Hold, DoesNotPushIntoTheFarWallOfASlot) {
  voxmap::Voxmap voxmap(kGrid, {-20, 0, 0}, {41, 63, 63});
  add_block(voxmap, {-20, 0, 0}, {0, 63, 63});
  add_block(voxmap, {21, 0, 0}, {41, 63, 63});
  voxmap.finish();
  for (const auto kind :
       {contact::ContactModelKind::kAdapted, contact::ContactModelKind::kOriginal}) {
    contact::ContactRenderer renderer(voxmap, sphere_shell(10.7 * kEdge, kEdge), kind,
                                      {kStiffness});
    const auto at = [&](double shift) {
      return renderer.render({kEdge * Vec3(11.0 + shift, 32.137, 31.771), Quat::Identity()});
    };
    double shift = 0.9;
    for (double x = 3.0; x > shift; x -= 0.05)
      at(x);
    // Clear of both walls is impossible here, so the shared direction is that of whichever wall
    // agreed last.
    for (; shift > -3.0; shift -= 0.05) {
      const contact::StageResult r = at(shift);
      ASSERT_TRUE(r.contact.wrench.finite());
      if (shift < -1.0) {
        EXPECT_GT(r.contact.wrench.force.x(), 0.0) << shift;
      }
    }
    for (; shift < 4.0; shift += 0.05) {
      const contact::StageResult r = at(shift);
      if (shift > 1.0) {
        EXPECT_LT(r.contact.wrench.force.x(), 0.0) << shift;
      }
    }
  }
}

TEST(Hold, RotatesWithACurvedWall) {
  const double radius = 30.0;
  voxmap::Voxmap voxmap(kGrid, {0, 0, 0}, {71, 71, 71});
  const Vec3 centre(36.1, 35.9, 36.0);
  for (voxmap::VoxelIndex v; v.i < 72; ++v.i)
    for (v.j = 0; v.j < 72; ++v.j)
      for (v.k = 0; v.k < 72; ++v.k) {
        const Vec3 low = Vec3(v.i, v.j, v.k) - centre, high = low + Vec3::Ones();
        const double far = low.cwiseAbs().cwiseMax(high.cwiseAbs()).norm();
        Vec3 nearest;
        for (int a = 0; a < 3; ++a)
          nearest[a] = std::max({low[a], -high[a], 0.0});
        if (nearest.norm() <= radius)
          voxmap.set(v, far >= radius ? voxmap::VoxelKind::kSurface : voxmap::VoxelKind::kInterior);
      }
  voxmap.finish();
  contact::ContactRenderer renderer(voxmap, ball(), contact::ContactModelKind::kAdapted,
                                    {kStiffness});
  const auto at = [&](double angle, double depth) {
    const Vec3 out(std::sin(angle), 0.0, std::cos(angle));
    return renderer.render({kEdge * (centre + (radius + 10.0 - depth) * out), Quat::Identity()});
  };
  for (double depth = -1.0; depth < 2.5; depth += 0.05)
    at(0.0, depth);
  for (double angle = 0.0; angle < 2.0 * std::numbers::pi; angle += 0.005) {
    const contact::StageResult r = at(angle, 2.5);
    EXPECT_TRUE(r.latched);
    const Vec3 out(std::sin(angle), 0.0, std::cos(angle));
    ASSERT_GT(r.contact.wrench.force.normalized().dot(out), 0.97) << angle;
  }
}

TEST(Stage, LeavesItsMemoryAloneWhenAPoseCannotBeUsed) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  contact::ContactRenderer disturbed(voxmap, ball(), contact::ContactModelKind::kAdapted,
                                     {kStiffness});
  contact::ContactRenderer clean(voxmap, ball(), contact::ContactModelKind::kAdapted, {kStiffness});
  int n = 0;
  for (double depth = -0.5; depth < 6.0; depth += 0.1, ++n) {
    Pose bad = over(60, depth);
    if (n % 2 == 0)
      bad.position.y() = std::numeric_limits<double>::quiet_NaN();
    else
      bad.position.y() = 1e12;
    const contact::StageResult refused = disturbed.render(bad);
    EXPECT_EQ(refused.contact.pose_status,
              n % 2 == 0 ? contact::PoseStatus::kNotAPose : contact::PoseStatus::kOutOfRange);
    EXPECT_TRUE(refused.contact.wrench.zero());
    EXPECT_FALSE(refused.latched || refused.fast);
    const contact::StageResult a = disturbed.render(over(60, depth)),
                               b = clean.render(over(60, depth));
    EXPECT_TRUE(same_bits(a.contact.wrench, b.contact.wrench));
    EXPECT_EQ(a.fast, b.fast);
  }
}

TEST(Fast, IsFlaggedOnlyWhenAPointMayHaveMovedMoreThanHalfAVoxel) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  contact::ContactRenderer renderer(voxmap, ball(), contact::ContactModelKind::kAdapted,
                                    {kStiffness});
  const Pose start{Vec3(0.5, 0.5, 0.5), Quat::Identity()};
  const auto after = [&](const Pose& next) {
    renderer.reset();
    EXPECT_FALSE(renderer.render(start).fast);  // the first pose has nothing to be fast against
    return renderer.render(next).fast;
  };
  const auto turned = [&](double angle, const Vec3& axis) {
    return Pose{start.position, Quat(Eigen::AngleAxisd(angle, axis.normalized()))};
  };
  EXPECT_FALSE(after(start));
  EXPECT_FALSE(after({start.position + Vec3(0.49 * kEdge, 0, 0), start.orientation}));
  EXPECT_TRUE(after({start.position + Vec3(0, 0, -0.51 * kEdge), start.orientation}));
  EXPECT_FALSE(after(turned(0.049, Vec3(1, -1, 2))));  // 10 e away: 0.49 e
  EXPECT_TRUE(after(turned(0.051, Vec3(1, -1, 2))));
  EXPECT_TRUE(after(turned(std::numbers::pi, Vec3(0, 1, 0))));
  Pose both = turned(0.03, Vec3(1, 0, 0));
  both.position.x() += 0.3 * kEdge;
  EXPECT_TRUE(after(both));
  Pose negative = start;  // q and -q are one orientation
  negative.orientation.coeffs() *= -1.0;
  EXPECT_FALSE(after(negative));
}

TEST(Fast, MotionBoundHoldsForEveryPoint) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {5, 5, 5});
  const pointshell::Pointshell shell = ball();
  contact::ContactRenderer renderer(voxmap, shell, contact::ContactModelKind::kAdapted,
                                    {kStiffness});
  std::mt19937_64 random(17);
  for (int n = 0; n < 300; ++n) {
    const Pose a{Vec3::Zero(), random_rotation(random)};
    const Quat small(
        Eigen::AngleAxisd(uniform(random, 0, 0.06),
                          Vec3(uniform(random, -1, 1), uniform(random, -1, 1), 1).normalized()));
    const Pose b{
        kEdge * 0.3 * Vec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)),
        small * a.orientation};
    double most = 0.0;
    for (std::size_t p = 0; p < shell.size(); ++p)
      most = std::max(most, (b * shell.point(p) - a * shell.point(p)).norm());
    renderer.reset();
    renderer.render(a);
    const bool fast = renderer.render(b).fast;
    if (most > 0.5 * kEdge) {
      EXPECT_TRUE(fast);
    }
  }
}

}  // namespace stage_hold_test
}  // namespace voxtouch::test
