// Tools between walls that face each other, over sharp edges, far inside: no force that is not
// finite, flips or pulls.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/coupling_models/pt2.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::test {
namespace wedge_test {

constexpr double kEdge = 1e-3;
constexpr std::array kModels = {contact::ContactModelKind::kOriginal,
                                contact::ContactModelKind::kAdapted,
                                contact::ContactModelKind::kField};
constexpr double kRadius = 8 * kEdge;

mesh::TriangleMesh slab(const Vec3& size, const Vec3& at) {
  return box_mesh(size, {at, Quat::Identity()});
}

/// Two, four or six walls that face each other in pairs, `gap` apart, each 8 e thick; symmetric
/// about the origin.
mesh::TriangleMesh walls(int pairs, double gap) {
  const double far = 0.5 * gap + 4 * kEdge;
  mesh::TriangleMesh mesh;
  for (int axis = 0; axis < pairs; ++axis)
    for (const double side : {1.0, -1.0}) {
      Vec3 size = Vec3::Constant(40 * kEdge), at = Vec3::Zero();
      size[axis] = 8 * kEdge, at[axis] = side * far;
      mesh = joined(mesh, slab(size, at));
    }
  return mesh;
}

struct Wedge {
  const char* name;
  mesh::TriangleMesh ground, tool;
};

std::vector<Wedge> wedges() {
  const double gap = 2 * kRadius - 0.8 * kEdge;
  return {{"sphere in a slot", walls(1, gap), sphere_mesh(kRadius, 4)},
          {"pin in a hole", walls(2, gap), cylinder_mesh(kRadius, 24 * kEdge, 64)},
          {"sphere in a box", walls(3, gap), sphere_mesh(kRadius, 4)}};
}

Pose at(const Vec3& x) { return {x, Quat::Identity()}; }

/// Of the ring's stage, in the symmetric pose and 300 steps of 1e-9 e to both sides of it, and in
/// 1e-3 e steps to 0.3 e.
TEST(F1NormalsThatCancel, GiveZeroNetForceWithoutAJump) {
  // Of one wall's force: the spheres are symmetric about their own grid too, the pin's 64 sides are
  // not.
  const auto net = [](const Wedge& w) { return w.ground.triangles.size() == 48 ? 0.08 : 1e-6; };
  for (const Wedge& w : wedges()) {
    const pointshell::Pointshell shell = exact_shell(w.tool, kEdge);
    const Ground ground(w.ground, voxmap::Grid{Vec3::Zero(), kEdge}, 6.0);
    const Ground one(slab(Vec3(8, 40, 40) * kEdge, Vec3(kRadius - 0.4 * kEdge + 4 * kEdge, 0, 0)),
                     voxmap::Grid{Vec3::Zero(), kEdge}, 6.0);
    for (std::size_t m = 0; m < kModels.size(); ++m) {
      contact::ContactRenderer alone = one.renderer(shell, kModels[m]);
      const double wall = alone.probe(at(Vec3::Zero())).wrench.force.norm();
      contact::ContactRenderer renderer = ground.renderer(shell, kModels[m]);
      const contact::ContactResult still = renderer.render(at(Vec3::Zero())).contact;
      ASSERT_GT(wall, 0.0);
      ASSERT_TRUE(still.wrench.finite());
      EXPECT_LE(still.wrench.force.norm(), net(w) * wall)
          << w.name << ", " << contact::name_of(kModels[m]);
      double largest[2] = {0, 0}, flipped = 0.0;
      int fine = 0;
      for (const double step : {1e-9 * kEdge, 1e-3 * kEdge}) {
        renderer.reset();
        Vec3 last = renderer.render(at(Vec3(-300 * step, 0, 0))).contact.wrench.force;
        for (int n = -299; n <= 300; ++n) {
          const contact::ContactResult now = renderer.render(at(Vec3(n * step, 0, 0))).contact;
          EXPECT_TRUE(now.wrench.finite());
          const double change = (now.wrench.force - last).norm();
          largest[fine] = std::max(largest[fine], change);
          if (now.wrench.force.dot(last) < 0.0)
            flipped = std::max(flipped, change);
          last = now.wrench.force;
        }
        ++fine;
      }
      const bool steps = m < 2;  // at voxel borders: `original` and `adapted` only
      std::printf(
          "%-16s %-9s net %.4f of one wall's force %.3g N; largest step over 1e-9 e %.2g, over "
          "1e-3 e %.4f; a turn "
          "%.4f\n",
          w.name, std::string(contact::name_of(kModels[m])).c_str(),
          still.wrench.force.norm() / wall, wall, largest[0] / wall, largest[1] / wall,
          flipped / wall);
      EXPECT_LE(largest[0] / wall, 1e-7) << w.name << ", " << contact::name_of(kModels[m]);
      EXPECT_LE(largest[1] / wall, steps ? 0.1 : 0.02)
          << w.name << ", " << contact::name_of(kModels[m]);
    }
  }
}

TEST(F3ManyContacts, ForceDoesNotDependOnPointOrder) {
  const pointshell::Pointshell shell =
      exact_shell(slab(Vec3(100, 100, 4) * kEdge, Vec3(0.2, 0.3, 0.1) * kEdge), kEdge);
  ASSERT_GT(shell.size(), 10000U);
  const std::uint64_t seed = voxtouch::testing::seed(31);
  SCOPED_TRACE(voxtouch::testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  std::vector<std::size_t> order(shell.size());
  for (std::size_t n = 0; n < order.size(); ++n)
    order[n] = n;
  for (std::size_t n = order.size(); n > 1; --n)
    std::swap(order[n - 1], order[random() % n]);
  pointshell::Pointshell mixed;
  mixed.edge = shell.edge;
  for (const std::size_t p : order) {
    mixed.x.push_back(shell.x[p]), mixed.y.push_back(shell.y[p]), mixed.z.push_back(shell.z[p]);
    mixed.nx.push_back(shell.nx[p]), mixed.ny.push_back(shell.ny[p]),
        mixed.nz.push_back(shell.nz[p]);
    mixed.area_m2.push_back(shell.area_m2[p]), mixed.coherence.push_back(shell.coherence[p]),
        mixed.id.push_back(shell.id[p]);
  }
  const Ground ground(slab(Vec3(120, 120, 10) * kEdge, Vec3::Zero()), kEdge, 4.0);
  for (const contact::ContactModelKind kind : kModels) {
    contact::ContactRenderer a = ground.renderer(shell, kind), b = ground.renderer(mixed, kind),
                             again = ground.renderer(shell, kind);
    for (int n = 0; n < 8; ++n) {
      const Pose pose{Vec3(0.1 * n, -0.07 * n, 7.0 - 0.2 * n) * kEdge,
                      Quat(Eigen::AngleAxisd(0.01 * n, Vec3::UnitZ()))};
      const contact::ContactResult x = a.render(pose).contact, y = b.render(pose).contact,
                                   z = again.render(pose).contact;
      EXPECT_EQ(x.wrench.force, z.wrench.force) << "the same order: bit-identical results";
      EXPECT_EQ(x.surface_hits, y.surface_hits);
      // Sums of n terms in another order: n ulp of their largest partial sum at most.
      EXPECT_LE((x.wrench.force - y.wrench.force).norm(), 1e-11 * (1e-6 + x.wrench.force.norm()))
          << contact::name_of(kind);
      EXPECT_LE((x.stiffness - y.stiffness).norm(), 1e-10 * (1e-6 + x.stiffness.norm()))
          << contact::name_of(kind);
      if (n > 4) {
        EXPECT_GT(x.wrench.force.z(), 0.0) << contact::name_of(kind);
      }
    }
  }
}

/// `original` and `adapted` to 100 e: DeepPush in tests/unit/contact. Here the memoryless one.
TEST(F5DeepPenetration, FieldFlagsSaturationAndNeverPullsIn) {
  const pointshell::Pointshell shell = exact_shell(sphere_mesh(kRadius, 4), kEdge);
  const Ground ground(slab(Vec3(60, 60, 150) * kEdge, Vec3(0.2, 0.1, -75) * kEdge), kEdge);
  contact::ContactRenderer renderer = ground.renderer(shell);
  double peak = 0.0, flagged = HUGE_VAL, fallen = HUGE_VAL;
  const auto push = [&](double depth, bool in = true) {
    const contact::StageResult r = renderer.render(at(Vec3(0.13, 0.21, 8.0 - depth) * kEdge));
    const double up = r.contact.wrench.force.z();
    EXPECT_TRUE(r.contact.wrench.finite());
    EXPECT_GE(up, -0.02 * peak) << "at " << depth;
    if (r.contact.saturated)
      flagged = std::min(flagged, depth);
    if (in && up < 0.98 * peak) {
      fallen = std::min(fallen, depth);
      EXPECT_TRUE(r.contact.saturated)
          << "at " << depth << ": less force than before, and not reported";
    }
    return up;
  };
  for (double depth = 0.0; depth <= 100.0; depth += 0.2)
    peak = std::max(peak, push(depth));
  const double back = push(0.3, false);
  std::printf("field: grows to %.3g N, flagged from %.1f e, falls from %.1f e\n", peak, flagged,
              fallen);
  EXPECT_LE(flagged, fallen);
  EXPECT_GT(back, 0.0);
  EXPECT_EQ(back, renderer.probe(at(Vec3(0.13, 0.21, 7.7) * kEdge)).wrench.force.z())
      << "nothing is left of the way";
}

/// Over the edge of a cube and back, 0.5 e deep at the face; steps of 0.05 e.
TEST(F6SharpEdge, ForceStepIsBoundedAndNotAmplified) {
  const pointshell::Pointshell shell = exact_shell(sphere_mesh(kRadius, 4), kEdge);
  const Ground ground(slab(Vec3(40, 40, 40) * kEdge, Vec3(0.2, 0.1, -20.0) * kEdge), kEdge);
  for (const contact::ContactModelKind kind : kModels) {
    contact::ContactRenderer renderer = ground.renderer(shell, kind);
    coupling_models::Pt2 filter[3];
    for (coupling_models::Pt2& f : filter)
      f.design(2 * 3.14159265 * 5.0, 1.0, 1.0);
    double flat = 0.0, edge = 0.0, smooth = 0.0, worst = 0.0, largest = 0.0, smooth_step = 0.0;
    Vec3 last = Vec3::Zero(), last_smooth = Vec3::Zero();
    for (int leg = 0; leg < 2; ++leg)
      for (int n = 0; n <= 700; ++n) {
        const double s = 0.05 * (leg == 0 ? n : 700 - n);
        // Along the face, round the edge at (20.2, 0) and down the side, at a constant gap of -0.5
        // e.
        const double reach = 7.5, corner = 20.2 - 10.0;
        Vec3 x(10.0 + s, 0.1, reach);
        if (s > corner && s <= corner + reach * 1.5707963) {
          const double angle = (s - corner) / reach;
          x = Vec3(20.2 + reach * std::sin(angle), 0.1, reach * std::cos(angle));
        } else if (s > corner) {
          x = Vec3(20.2 + reach, 0.1, -(s - corner - reach * 1.5707963));
        }
        const Vec3 now = renderer.render(at(x * kEdge)).contact.wrench.force;
        Vec3 smoothed;
        for (int a = 0; a < 3; ++a)
          smoothed[a] = filter[a].step(now[a], 1e-3);
        const double size = now.norm();
        if (n > 0 || leg > 0) {
          const double step = (now - last).norm();
          worst = std::max(worst, step / std::max({size, last.norm(), 1e-12}));
          largest = std::max(largest, step),
          smooth_step = std::max(smooth_step, (smoothed - last_smooth).norm());
        }
        const double round = (s - corner) / reach;  // [rad]
        (round > 0.35 && round < 1.22 ? edge : flat) =
            std::max(round > 0.35 && round < 1.22 ? edge : flat, size);
        smooth = std::max(smooth, smoothed.norm());
        last = now, last_smooth = smoothed;
      }
    std::printf(
        "%-9s face %.3g N, edge %.3g N, 5 Hz %.3g N; largest step %.2f of the force, %.3g N, "
        "behind 5 Hz %.3g N\n",
        std::string(contact::name_of(kind)).c_str(), flat, edge, smooth, worst, largest,
        smooth_step);
    EXPECT_LE(worst, 2.0) << contact::name_of(kind);
    EXPECT_LE(edge, 0.6 * flat) << contact::name_of(kind)
                                << ": less of the ball is inside than on a face";
    EXPECT_LE(smooth, flat);
    EXPECT_LE(smooth_step, 0.05 * flat) << contact::name_of(kind);
  }
}

}  // namespace wedge_test
}  // namespace voxtouch::test
