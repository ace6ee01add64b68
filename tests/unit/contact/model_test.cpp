// The memoryless laws in the hard cases, through the whole path from pose to wrench.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "fixtures.hpp"

namespace voxtouch::test {
namespace {

constexpr double kEdge = 0.001;
const voxmap::Grid kGrid{Vec3::Zero(), kEdge};

/// Two walls with a slot between them, mirror-symmetric about x = 11 edges; a ball of radius 10.7 e
/// reaches both layers.
voxmap::Voxmap slot() {
  voxmap::Voxmap voxmap(kGrid, {-8, 0, 0}, {29, 63, 63});
  add_block(voxmap, {-8, 0, 0}, {0, 63, 63});
  add_block(voxmap, {21, 0, 0}, {29, 63, 63});
  voxmap.finish();
  return voxmap;
}
const Vec3 kSlotCentre = kEdge * Vec3(11.0, 32.137, 31.771);

TEST(ContactModels, GiveNothingWithoutContact) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {20, 20, 20});
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer(voxmap, sphere_shell(5 * kEdge, kEdge), kind, {1000.0});
    const contact::ContactResult r = renderer.probe({Vec3(0.01, 0.01, 0.1), Quat::Identity()});
    EXPECT_TRUE(r.wrench.zero());
    EXPECT_EQ(r.surface_hits + r.interior_hits, 0U);
    EXPECT_EQ(r.coherence, 0.0);
    EXPECT_EQ(r.stiffness_bound_n_per_m, 0.0);
    EXPECT_TRUE(r.mean_normal.isZero(0.0));
    EXPECT_FALSE(r.fallback);
  }
}

TEST(ContactModels, PushOnePointByItsDepthBelowTheVoxelCentre) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {20, 20, 20});
  const pointshell::Pointshell shell = shell_of({{Vec3(0.004, 0, 0), Vec3::UnitZ()}}, kEdge);
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer(voxmap, shell, kind, {500.0});
    const contact::ContactResult r =
        renderer.probe({Vec3(0.0063, 0.0102, 0.0202), Quat::Identity()});  // 0.3 e below the centre
    EXPECT_NEAR(r.wrench.force.z(), 500.0 * 0.0003, 1e-15);
    EXPECT_NEAR(r.deepest_depth_m, 0.0003, 1e-17);
    EXPECT_NEAR((r.deepest_point - Vec3(0.0103, 0.0102, 0.0202)).norm(), 0.0, 1e-17);
    EXPECT_EQ(r.stiffness_bound_n_per_m, 500.0);
    const contact::ContactResult above =
        renderer.probe({Vec3(0.0063, 0.0102, 0.0207), Quat::Identity()});
    EXPECT_EQ(above.surface_hits,
              1U);  // in the layer, but not below its centre: in S, without a force
    EXPECT_TRUE(above.wrench.zero());
    EXPECT_EQ(above.stiffness_bound_n_per_m, 0.0);
  }
}

TEST(ContactModels, TakeTorqueAboutTheToolsOriginInWorldAxes) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {20, 20, 20});
  // The tool's x axis rotated to world y: the point is 4 mm away along world y, the force along
  // world z.
  const pointshell::Pointshell shell = shell_of({{Vec3(0.004, 0, 0), Vec3::UnitZ()}}, kEdge);
  const Pose pose{Vec3(0.0103, 0.0063, 0.0202),
                  Quat(Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitZ()))};
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer(voxmap, shell, kind, {500.0});
    const Wrench w = renderer.probe(pose).wrench;
    EXPECT_NEAR(w.torque.x(), 0.004 * 500.0 * 0.0003, 1e-15);
    EXPECT_NEAR(w.torque.y(), 0.0, 1e-15);
    EXPECT_NEAR(w.torque.z(), 0.0, 1e-15);
  }
}

TEST(ContactModels, NeverPullAndNeverExceedTheLayer) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {60, 60, 30});
  const pointshell::Pointshell shell = sphere_shell(10 * kEdge, kEdge);
  std::mt19937_64 random(5);
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer(voxmap, shell, kind, {100.0});
    for (int n = 0; n < 500; ++n) {
      const Vec3 u(uniform(random, 25, 35), uniform(random, 25, 35), 41.5 - uniform(random, 0, 2));
      const contact::ContactResult r = renderer.probe({kEdge * u, random_rotation(random)});
      EXPECT_GE(r.wrench.force.z(), 0.0);
      EXPECT_LE(r.wrench.force.norm(), 100.0 * r.surface_hits * std::sqrt(0.75) * kEdge);
    }
  }
}

TEST(ContactModels, StiffnessBoundExceedsTheMeasured) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {60, 60, 30});
  const pointshell::Pointshell shell = sphere_shell(10 * kEdge, kEdge);
  std::mt19937_64 random(6);
  const double step = 1e-10;
  int compared = 0;
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer(voxmap, shell, kind, {100.0});
    for (int n = 0; n < 200; ++n) {
      Pose pose{kEdge * Vec3(uniform(random, 25, 35), uniform(random, 25, 35), 40.3),
                random_rotation(random)};
      std::vector<std::uint32_t> ids, moved_ids;
      const contact::ContactResult before = renderer.probe(pose, ids);
      Mat3 stiffness;
      bool same = before.stiffness_bound_n_per_m > 0;
      for (int axis = 0; axis < 3; ++axis) {
        Pose moved = pose;
        moved.position[axis] += step;
        const contact::ContactResult after = renderer.probe(moved, moved_ids);
        same = same && moved_ids == ids &&
               after.stiffness_bound_n_per_m == before.stiffness_bound_n_per_m;
        stiffness.col(axis) = (before.wrench.force - after.wrench.force) / step;
      }
      if (!same)
        continue;
      ++compared;
      const double measured = stiffness.jacobiSvd().singularValues()[0];
      EXPECT_LE(measured, before.stiffness_bound_n_per_m * (1 + 1e-5));
      if (kind == contact::ContactModelKind::kAdapted) {
        EXPECT_GE(measured, before.stiffness_bound_n_per_m * (1 - 1e-5));
      }
    }
  }
  EXPECT_GT(compared, 300);
}

TEST(ContactModels, GiveTheSameForceForASceneAMillionMetresAway) {
  const Vec3 shift(1e6, -1e6, 1e6);
  const double e = 0x1p-9;  // exact origin and positions, so that only the arithmetic is tested
  const voxmap::Grid here{e * Vec3(3, -5, 7), e}, there{here.origin + shift, e};
  const voxmap::Voxmap near = block(here, {0, 0, 0}, {60, 60, 30}),
                       far = block(there, {0, 0, 0}, {60, 60, 30});
  const pointshell::Pointshell shell = sphere_shell(10 * e, e);
  std::mt19937_64 random(11);
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer a(near, shell, kind, {100.0}), b(far, shell, kind, {100.0});
    for (int n = 0; n < 300; ++n) {
      Pose pose{Vec3::Zero(), random_rotation(random)};
      for (int axis = 0; axis < 3; ++axis)
        pose.position[axis] =
            here.origin[axis] +
            std::round(uniform(random, axis == 2 ? 39.0 : 20.0, 41.0) * 4096.0) / 4096.0 * e;
      const Pose moved{pose.position + shift, pose.orientation};
      ASSERT_EQ(moved.position - shift, pose.position);
      const contact::ContactResult r = a.probe(pose), s = b.probe(moved);
      EXPECT_EQ(r.surface_hits, s.surface_hits);
      EXPECT_TRUE(same_bits(r.wrench, s.wrench));  // stronger than the bound N K 4 ulp(1e6)
    }
  }
}

TEST(ContactModels, LoseOnlyRoundingAMillionMetresAway) {
  const Vec3 shift(1e6, -1e6, 1e6);
  const double e = 0.002, stiffness = 100.0, ulp = std::nextafter(1e6, 2e6) - 1e6;
  const voxmap::Grid here{Vec3(0.25, -0.5, 0.125), e}, there{here.origin + shift, e};
  const voxmap::Voxmap near = block(here, {0, 0, 0}, {60, 60, 30}),
                       far = block(there, {0, 0, 0}, {60, 60, 30});
  const pointshell::Pointshell shell = sphere_shell(10 * e, e);
  std::mt19937_64 random(12);
  int compared = 0;
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer a(near, shell, kind, {stiffness}), b(far, shell, kind, {stiffness});
    std::vector<std::uint32_t> ids, moved_ids;
    for (int n = 0; n < 300; ++n) {
      const Pose pose{here.origin + e * Vec3(uniform(random, 20, 40), uniform(random, 20, 40),
                                             uniform(random, 39.5, 41)),
                      random_rotation(random)};
      const contact::ContactResult r = a.probe(pose, ids),
                                   s = b.probe({pose.position + shift, pose.orientation},
                                               moved_ids);
      if (ids != moved_ids)
        continue;  // a point within 1e-10 m of a border: a documented voxel step
      ++compared;
      EXPECT_LE((r.wrench.force - s.wrench.force).norm(), r.surface_hits * stiffness * 4 * ulp);
    }
  }
  EXPECT_GT(compared, 590);
}

TEST(ContactModels, GiveNoNetForceInASymmetricSlot) {
  const voxmap::Voxmap voxmap = slot();
  const pointshell::Pointshell shell = sphere_shell(10.7 * kEdge, kEdge);
  contact::ContactRenderer adapted(voxmap, shell, contact::ContactModelKind::kAdapted, {1000.0});
  const contact::ContactResult r = adapted.probe({kSlotCentre, Quat::Identity()});
  ASSERT_GT(r.surface_hits, 20U);
  EXPECT_TRUE(r.fallback);
  const double one_wall =
      adapted.probe({kSlotCentre - Vec3(0.4 * kEdge, 0, 0), Quat::Identity()}).wrench.force.norm();
  ASSERT_GT(one_wall, 0.0);
  EXPECT_LE(r.wrench.force.norm(), 0.02 * one_wall);
  EXPECT_LE(std::abs(r.wrench.force.x()), 1e-12 * one_wall + 1e-15);
}

TEST(ContactModels, DoNotFlipInTheSymmetricPoseOfASlot) {
  const voxmap::Voxmap voxmap = slot();
  const double stiffness = 1000.0;
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer(voxmap, sphere_shell(10.7 * kEdge, kEdge), kind, {stiffness});
    Vec3 last = Vec3::Zero();
    std::uint32_t hits = 0;
    for (int n = -1000; n <= 1000; ++n) {
      const Pose pose{kSlotCentre + Vec3(n * 1e-9, 0, 0), Quat::Identity()};
      const contact::ContactResult probed = renderer.probe(pose);
      const contact::StageResult rendered = renderer.render(pose);
      ASSERT_TRUE(rendered.contact.wrench.finite());
      EXPECT_TRUE(
          same_bits(probed.wrench, rendered.contact.wrench));  // s = 0: the stage is `original`
      if (n > -1000) {
        ASSERT_EQ(probed.surface_hits, hits) << "the sweep was meant to stay between voxel borders";
        EXPECT_LE((probed.wrench.force - last).norm(), stiffness * hits * 1e-9 * (1 + 1e-6));
      }
      last = probed.wrench.force;
      hits = probed.surface_hits;
    }
  }
}

TEST(ContactModels, RepeatedPosesAreBitIdentical) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {60, 60, 30});
  const pointshell::Pointshell shell = sphere_shell(10 * kEdge, kEdge);
  for (const auto kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer renderer(voxmap, shell, kind, {100.0}),
        other(voxmap, shell, kind, {100.0});
    std::mt19937_64 random(8);
    std::vector<Pose> poses;
    std::vector<Wrench> forward;
    for (int n = 0; n < 200; ++n)
      poses.push_back(
          {kEdge * Vec3(uniform(random, 5, 55), uniform(random, 5, 55), uniform(random, 35, 42)),
           random_rotation(random)});
    for (const Pose& pose : poses)
      forward.push_back(renderer.probe(pose).wrench);
    for (std::size_t n = poses.size(); n-- > 0;) {
      renderer.render(poses[n]);  // the ring's state must not affect a probe
      EXPECT_TRUE(same_bits(renderer.probe(poses[n]).wrench, forward[n]));
      EXPECT_TRUE(same_bits(other.probe(poses[n]).wrench, forward[n]));
    }
  }
}

TEST(ContactModels, NamesReadBack) {
  for (const auto kind : {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted,
                          contact::ContactModelKind::kField}) {
    contact::ContactModelKind back{};
    ASSERT_TRUE(contact::parse_contact_model(contact::name_of(kind), back));
    EXPECT_EQ(back, kind);
  }
  contact::ContactModelKind kind = contact::ContactModelKind::kField;
  EXPECT_FALSE(contact::parse_contact_model("Adapted", kind));
  EXPECT_FALSE(contact::parse_contact_model("clustered", kind)) << "a model that is gone";
  EXPECT_EQ(kind, contact::ContactModelKind::kField);
  EXPECT_EQ(contact::name_of(contact::ContactModelKind{3}), "unknown") << "its number stays empty";
}

TEST(ContactModels, RefuseANonPositiveOrNonFiniteStiffness) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(contact::make_contact_model(contact::ContactModelKind::kAdapted, {bad}),
                 std::invalid_argument);
}

}  // namespace
}  // namespace voxtouch::test
