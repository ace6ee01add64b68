// The culling tree may only skip points that are free.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fixtures.hpp"

namespace voxtouch::test {
namespace culling_test {

struct BruteForce {
  std::vector<std::uint32_t> surface, interior;
};

/// Every point, one by one, with the same arithmetic but no tree.
BruteForce brute_force(const voxmap::Voxmap& voxmap, const pointshell::Pointshell& shell,
                       const Pose& pose) {
  BruteForce out;
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  const Vec3 t = pose.position - voxmap.grid().origin;
  for (std::uint32_t p = 0; p < shell.size(); ++p) {
    Vec3 u;
    for (int a = 0; a < 3; ++a)
      u[a] = (rotation(a, 0) * shell.x[p] + rotation(a, 1) * shell.y[p] +
              rotation(a, 2) * shell.z[p] + t[a]) /
             voxmap.grid().edge;
    const voxmap::VoxelKind kind = voxmap.at(voxmap::Grid::voxel_of(u));
    if (kind == voxmap::VoxelKind::kSurface)
      out.surface.push_back(p);
    if (kind == voxmap::VoxelKind::kInterior)
      out.interior.push_back(p);
  }
  return out;
}

std::vector<std::uint32_t> points(const contact::Hits& hits) {
  std::vector<std::uint32_t> out;
  for (std::size_t n = 0; n < hits.size(); ++n)
    out.push_back(hits.point(n));
  return out;
}

/// A cup-like scene: a floor, a wall, and a lone voxel in the far corner of the table.
voxmap::Voxmap scene(const voxmap::Grid& grid) {
  voxmap::Voxmap voxmap(grid, {0, 0, 0}, {63, 63, 63});
  add_block(voxmap, {0, 0, 0}, {63, 63, 6});
  add_block(voxmap, {0, 0, 0}, {5, 63, 40});
  voxmap.set({63, 63, 63}, voxmap::VoxelKind::kSurface);
  voxmap.finish();
  return voxmap;
}

TEST(SphereTree, EnclosesItsPoints) {
  const pointshell::Pointshell shell = sphere_shell(0.03, 0.001);
  const contact::SphereTree tree(shell);
  std::size_t span = contact::SphereTree::kLeafPoints, floats = 0;
  for (const contact::SphereTree::Level& level : tree.levels()) {
    EXPECT_EQ(level.count, (shell.size() + span - 1) / span);
    EXPECT_EQ(level.x.size() % contact::SphereTree::kFanOut, 0U);
    floats += level.x.size() + level.y.size() + level.z.size() + level.radius.size();
    for (std::size_t node = 0; node < level.count; ++node)
      for (std::size_t p = node * span; p < std::min(shell.size(), (node + 1) * span); ++p) {
        const Vec3 centre(level.x[node], level.y[node], level.z[node]);
        ASSERT_LE((shell.point(p) - centre).norm(), level.radius[node]);
      }
    span *= contact::SphereTree::kFanOut;
  }
  EXPECT_LE(tree.levels().back().count, contact::SphereTree::kFanOut);
  EXPECT_EQ(contact::SphereTree::bytes(shell.size()), floats * sizeof(float));
}

TEST(SphereTree, HasALeafForEveryPointOfAnyCount) {
  for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 128U, 129U, 2048U, 2049U}) {
    std::vector<std::pair<Vec3, Vec3>> list(count, {Vec3(1, 2, 3), Vec3::UnitX()});
    const pointshell::Pointshell shell = shell_of(list, 1.0);
    const contact::SphereTree tree(shell);
    EXPECT_EQ(tree.levels().empty(), count == 0);
    // All in one voxel: every point is found, once and in order.
    const voxmap::Voxmap voxmap = block({Vec3::Zero(), 1.0}, {0, 0, 0}, {8, 8, 8});
    contact::HitList hits;
    contact::ContactQuery(voxmap, shell).find({Vec3(2.5, 1.5, 0.5), Quat::Identity()}, hits);
    ASSERT_EQ(hits.interior.size(), count);
    EXPECT_EQ(hits.tested, count);
    for (std::uint32_t p = 0; p < count; ++p)
      EXPECT_EQ(hits.interior.point(p), p);
  }
}

TEST(Culling, NeverDropsAHitInThousandsOfRandomPoses) {
  std::mt19937_64 random(20010101);
  const double e = 0.003;  // no power of two
  const voxmap::Grid grid{Vec3(-0.7, 0.31, 0.123), e};
  const voxmap::Voxmap voxmap = scene(grid);
  const pointshell::Pointshell ball = sphere_shell(9.3 * e, e);
  std::vector<std::pair<Vec3, Vec3>>
      scattered;  // a shell in random order: the tree may be slow, not wrong
  for (int n = 0; n < 700; ++n)
    scattered.emplace_back(
        e * Vec3(uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9)),
        Vec3::UnitZ());
  std::size_t touched = 0, heavy = 0, culled = 0, poses = 0;
  for (const pointshell::Pointshell& shell : {ball, shell_of(scattered, e)}) {
    const contact::ContactQuery query(voxmap, shell);
    contact::HitList hits;
    hits.reserve(shell.size());
    for (int n = 0; n < 4000; ++n, ++poses) {
      // Everywhere in and beyond the table, its border, close to the floor, and far outside.
      const double spread = n % 4 == 3 ? 4000.0 : 100.0;
      Vec3 u(uniform(random, -0.5, 1.0) * spread, uniform(random, -0.5, 1.0) * spread,
             uniform(random, -0.5, 1.0) * spread);
      if (n % 4 == 0)
        u.z() = uniform(random, 0.0, 20.0);
      if (n % 4 == 1)
        u[n % 3] = (n % 8 < 4 ? -8.0 : 80.0) + uniform(random, -0.01, 0.01);
      const Pose pose{grid.origin + e * u, random_rotation(random)};
      query.find(pose, hits);
      // The query normalises the quaternion; uses its rotation so that the results are
      // bit-identical.
      const BruteForce all = brute_force(voxmap, shell, hits.pose_WT);
      ASSERT_EQ(points(hits.surface), all.surface) << "pose " << n << " u " << u.transpose();
      ASSERT_EQ(points(hits.interior), all.interior) << "pose " << n << " u " << u.transpose();
      ASSERT_EQ(hits.pose_status, contact::PoseStatus::kUsable);
      touched += !all.surface.empty();
      heavy += all.surface.size() + all.interior.size() > shell.size() / 4;
      culled += hits.tested < shell.size();
    }
  }
  EXPECT_GT(touched, poses / 10);
  EXPECT_GT(heavy, poses / 40);
  EXPECT_GT(culled, poses / 4);
}

TEST(Culling, TestsFewPointsPerHitInLightContact) {
  // A ball that touches a floor with about one point in a hundred, sampled more and more densely.
  const double e = 0.0005;
  const voxmap::Grid grid{Vec3::Zero(), e};
  const voxmap::Voxmap voxmap = block(grid, {0, 0, 0}, {255, 255, 15});
  std::mt19937_64 random(3);
  const double radius = 50.0;
  struct Case {
    double pitch, limit;
  };
  for (const auto& [pitch, limit] :
       {Case{1.772, 23.0}, Case{1.0, 17.0}, Case{0.5605, 9.0}, Case{0.17725, 6.0}}) {
    const pointshell::Pointshell shell = sphere_shell(radius * e, pitch * e);
    const contact::ContactQuery query(voxmap, shell);
    contact::HitList hits;
    hits.reserve(shell.size());
    std::size_t tested = 0, not_free = 0;
    for (int n = 0; n < 50; ++n) {
      const Vec3 u(128 + uniform(random, -8, 8), 128 + uniform(random, -8, 8), 16 + radius * 0.98);
      query.find({e * u, random_rotation(random)}, hits);
      tested += hits.tested;
      not_free += hits.surface.size() + hits.interior.size();
    }
    const double ratio = static_cast<double>(tested) / static_cast<double>(not_free);
    const double fraction =
        static_cast<double>(not_free) / 50.0 / static_cast<double>(shell.size());
    std::printf(
        "light contact: %zu points, %.2f %% not free, %.1f points tested per point that is not "
        "free\n",
        shell.size(), 100 * fraction, ratio);
    EXPECT_NEAR(fraction, 0.01, 0.005);
    EXPECT_LE(ratio, limit);
  }
}

TEST(Query, RefusesInvalidPoses) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  const voxmap::Voxmap voxmap = scene({Vec3::Zero(), 0.01});
  contact::ContactRenderer renderer(voxmap, sphere_shell(0.05, 0.01),
                                    contact::ContactModelKind::kAdapted, {1.0});
  const Pose touching{Vec3(0.3, 0.3, 0.11), Quat::Identity()};
  ASSERT_GT(renderer.probe(touching).surface_hits, 0U);
  std::vector<Pose> bad;
  for (const double value : {nan, inf, -inf})
    for (int n = 0; n < 7; ++n) {
      Pose pose = touching;
      (n < 3 ? pose.position[n] : pose.orientation.coeffs()[n - 3]) = value;
      bad.push_back(pose);
    }
  bad.push_back({touching.position, Quat(0, 0, 0, 0)});
  bad.push_back({touching.position, Quat(5e-324, 0, 0, 0)});
  bad.push_back({touching.position, Quat(1e200, 1e200, 0, 0)});
  for (const Pose& pose : bad) {
    const contact::ContactResult r = renderer.probe(pose);
    EXPECT_EQ(r.pose_status, contact::PoseStatus::kNotAPose);
    EXPECT_EQ(r.surface_hits + r.interior_hits + r.points_tested, 0U);
    EXPECT_TRUE(r.wrench.zero());
  }
}

TEST(Query, ReportsAPoseTooFarForInt32) {
  const voxmap::Voxmap voxmap = scene({Vec3::Zero(), 0.01});
  contact::ContactRenderer renderer(voxmap, sphere_shell(0.05, 0.01),
                                    contact::ContactModelKind::kAdapted, {1.0});
  for (const double far : {2.2e7, -2.2e7, 1e300, -1e300, 1.7e308}) {
    const contact::ContactResult r = renderer.probe({Vec3(0.3, far, 0.11), Quat::Identity()});
    EXPECT_EQ(r.pose_status, contact::PoseStatus::kOutOfRange) << far;
    EXPECT_EQ(r.surface_hits + r.interior_hits, 0U);
  }
  const contact::ContactResult inside = renderer.probe({Vec3(0.3, 2.1e7, 0.11), Quat::Identity()});
  EXPECT_EQ(inside.pose_status, contact::PoseStatus::kUsable);
  EXPECT_EQ(inside.surface_hits, 0U);
}

TEST(Query, AcceptsQuaternionNormsFromThousandthToThousand) {
  const voxmap::Voxmap voxmap = scene({Vec3::Zero(), 0.01});
  contact::ContactRenderer renderer(voxmap, sphere_shell(0.05, 0.01),
                                    contact::ContactModelKind::kAdapted, {1.0});
  Pose pose{Vec3(0.3, 0.3, 0.11), Quat(0.5, 0.5, 0.5, 0.5)};
  const contact::ContactResult one = renderer.probe(pose);
  ASSERT_GT(one.wrench.force.norm(), 0.0);
  for (const double norm : {0.0078125, 512.0}) {
    pose.orientation = Quat(0.5 * norm, 0.5 * norm, 0.5 * norm, 0.5 * norm);
    EXPECT_TRUE(same_bits(renderer.probe(pose).wrench, one.wrench));
  }
}

TEST(Query, PutsAPointOnABorderOrCornerIntoOneVoxelOnly) {
  const voxmap::Voxmap voxmap = block({Vec3::Zero(), 0.125}, {0, 0, 0}, {7, 7, 7});
  contact::ContactRenderer renderer(voxmap, shell_of({{Vec3::Zero(), Vec3::UnitZ()}}, 0.125),
                                    contact::ContactModelKind::kOriginal, {1.0});
  const auto hits = [&](double x, double y, double z) {
    const contact::ContactResult r = renderer.probe({0.125 * Vec3(x, y, z), Quat::Identity()});
    return std::pair(r.surface_hits, r.interior_hits);
  };
  EXPECT_EQ(hits(0, 0, 0), std::pair(1U, 0U));  // the low corner belongs to the block,
  EXPECT_EQ(hits(8, 8, 8), std::pair(0U, 0U));  // the high corner to the free voxel beyond it,
  EXPECT_EQ(hits(1, 1, 1), std::pair(0U, 1U));  // an inner border to the voxel above it
  EXPECT_EQ(hits(7, 4, 4), std::pair(1U, 0U));
}

TEST(Query, RefusesABrokenShell) {
  const voxmap::Voxmap voxmap = block({Vec3::Zero(), 0.125}, {0, 0, 0}, {7, 7, 7});
  pointshell::Pointshell uneven = sphere_shell(0.5, 0.125);
  uneven.nz.pop_back();
  EXPECT_THROW(contact::ContactQuery(voxmap, uneven), std::invalid_argument);
  pointshell::Pointshell nan = sphere_shell(0.5, 0.125);
  nan.y[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(contact::ContactQuery(voxmap, nan), std::invalid_argument);
}

TEST(Query, FindsNothingForAnEmptyShell) {
  const voxmap::Voxmap voxmap = block({Vec3::Zero(), 0.125}, {0, 0, 0}, {7, 7, 7});
  contact::ContactRenderer renderer(voxmap, pointshell::Pointshell{},
                                    contact::ContactModelKind::kAdapted, {1.0});
  EXPECT_TRUE(renderer.render({Vec3(0.5, 0.5, 0.5), Quat::Identity()}).contact.wrench.zero());
}

}  // namespace culling_test
}  // namespace voxtouch::test
