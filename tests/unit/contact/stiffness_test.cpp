// The stiffness matrix predicts the change of the wrench.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "core/contact/stiffness_sum.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace stiffness_test {

constexpr double kEdge = 0.001, kStiffness = 100.0;
const voxmap::Grid kGrid{Vec3::Zero(), kEdge};
constexpr std::array kBothModels = {contact::ContactModelKind::kOriginal,
                                    contact::ContactModelKind::kAdapted};

Pose moved(const Pose& pose, int axis, double step) {
  Pose out = pose;
  if (axis < 3) {
    out.position[axis] += step;
  } else {
    out.orientation = Quat(Eigen::AngleAxisd(step, Vec3::Unit(axis - 3))) * out.orientation;
  }
  return out;
}

Vec6 as_vector(const Wrench& wrench) {
  Vec6 out;
  out << wrench.force, wrench.torque;
  return out;
}

/// A rotation about `axis` also rotates the arms and the force directions of the points: that part
/// of d(wrench)/d(angle), of the size of the wrench itself.
Vec6 rotation_part(const contact::HitList& hits, const contact::ContactResult& result,
                   contact::ContactModelKind model, const Vec3& axis) {
  Wrench out;
  for (const contact::Hit& hit : hits.surface) {
    const Vec3 u = model == contact::ContactModelKind::kAdapted && !result.fallback
                       ? result.mean_normal
                       : hit.normal;
    const double depth = u.dot(hit.to_centre);
    if (!(depth > 0.0))
      continue;
    const Vec3 turned = axis.cross(u),
               force = kStiffness * (turned.dot(hit.to_centre) * u + depth * turned);
    out.force += force;
    out.torque += hit.arm.cross(force) + axis.cross(hit.arm).cross(kStiffness * depth * u);
  }
  return as_vector(out);
}

bool same_points(const contact::ContactResult& a, const contact::ContactResult& b,
                 const std::vector<std::uint32_t>& ids_a, const std::vector<std::uint32_t>& ids_b) {
  return ids_a == ids_b && a.stiffness_bound_n_per_m == b.stiffness_bound_n_per_m;
}

void expect_sound(const contact::ContactResult& r) {
  EXPECT_EQ(r.stiffness, r.stiffness.transpose());
  const Eigen::SelfAdjointEigenSolver<Mat6> solver(r.stiffness, Eigen::EigenvaluesOnly);
  EXPECT_GE(solver.eigenvalues()[0], -1e-13 * solver.eigenvalues()[5]);
  EXPECT_LE((r.stiffness.topLeftCorner<3, 3>().trace()), r.stiffness_bound_n_per_m * (1 + 1e-12));
}

TEST(Stiffness, IsTheDerivativeOfTheWrench) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {60, 60, 30});
  std::mt19937_64 random(21);
  for (const auto kind : kBothModels) {
    // Off the tool's origin: a sphere about it has no levers along its own normals.
    pointshell::Pointshell shell = sphere_shell(10 * kEdge, kEdge);
    for (double& x : shell.x)
      x += 7 * kEdge;
    contact::ContactRenderer renderer(voxmap, shell, kind, {kStiffness});
    int compared = 0;
    for (int n = 0; n < 150; ++n) {
      const Quat turn = random_rotation(random);
      const Vec3 middle = kEdge * Vec3(uniform(random, 25, 35), uniform(random, 25, 35),
                                       uniform(random, 40.1, 40.6));
      const Pose pose{middle - turn * Vec3(7 * kEdge, 0, 0), turn};
      std::vector<std::uint32_t> ids, ids_of_moved;
      const contact::ContactResult here = renderer.probe(pose, ids);
      const contact::HitList hits = renderer.hits();
      if (here.stiffness_bound_n_per_m == 0.0)
        continue;
      expect_sound(here);
      for (int axis = 0; axis < 6; ++axis) {
        const double step = axis < 3 ? 1e-9 : 1e-7;
        const contact::ContactResult after = renderer.probe(moved(pose, axis, step), ids_of_moved);
        bool same = same_points(here, after, ids, ids_of_moved);
        const contact::ContactResult before =
            renderer.probe(moved(pose, axis, -step), ids_of_moved);
        if (!(same = same && same_points(here, before, ids, ids_of_moved)))
          continue;
        ++compared;
        const Vec6 measured = (as_vector(after.wrench) - as_vector(before.wrench)) / (2.0 * step);
        Vec6 said = -here.stiffness.col(axis);
        if (axis >= 3)
          said += rotation_part(hits, here, kind, Vec3::Unit(axis - 3));
        EXPECT_LE((measured - said).head<3>().norm(), 1e-5 * said.head<3>().norm() + 1e-6) << axis;
        EXPECT_LE((measured - said).tail<3>().norm(), 1e-5 * said.tail<3>().norm() + 1e-8) << axis;
      }
    }
    EXPECT_GT(compared, 600);
  }
}

TEST(Stiffness, OfOnePointIsItsDirectionAndItsLever) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {20, 20, 20});
  for (const auto kind : kBothModels) {
    contact::ContactRenderer renderer(voxmap, shell_of({{Vec3(0.004, 0, 0), Vec3::UnitZ()}}, kEdge),
                                      kind, {500.0});
    const contact::ContactResult r =
        renderer.probe({Vec3(0.0063, 0.0102, 0.0202), Quat::Identity()});
    Vec6 j;
    j << 0, 0, 1, 0, -0.004, 0;  // arm x u
    EXPECT_LE((r.stiffness - 500.0 * j * j.transpose()).norm(), 1e-12);
    const contact::ContactResult above =
        renderer.probe({Vec3(0.0063, 0.0102, 0.0207), Quat::Identity()});
    ASSERT_EQ(above.surface_hits, 1U);
    EXPECT_TRUE(above.stiffness.isZero(0.0)) << "a point in the layer that does not push";
    EXPECT_TRUE(renderer.probe({Vec3(0, 0, 1), Quat::Identity()}).stiffness.isZero(0.0))
        << "free space";
    EXPECT_TRUE(renderer.render({Vec3(0, 0, 1), Quat::Identity()}).contact.stiffness.isZero(0.0));
  }
}

TEST(Stiffness, BothSumsAgreeForParallelForces) {
  std::mt19937_64 random(22);
  const Vec3 m = random_rotation(random) * Vec3::UnitX();
  contact::StiffnessSum each;
  contact::CommonDirectionSum common;
  EXPECT_TRUE(common.matrix(3.0, m).isZero(0.0));
  for (int n = 0; n < 50; ++n) {
    const Vec3 arm(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    each.add(arm, m), common.add(arm);
  }
  Mat6 sum = Mat6::Zero();
  each.add_to(3.0, sum);
  EXPECT_LE((sum - common.matrix(3.0, m)).norm(), 1e-12 * sum.norm());
}

/// Two walls with a slot between them: the ball's coherence passes through the blend.
TEST(Stiffness, IsTheDerivativeOfTheWrenchInTheBlendToo) {
  voxmap::Voxmap voxmap(kGrid, {-8, 0, 0}, {29, 63, 63});
  add_block(voxmap, {-8, 0, 0}, {0, 63, 63});
  add_block(voxmap, {21, 0, 0}, {29, 63, 63});
  voxmap.finish();
  contact::ContactRenderer renderer(voxmap, sphere_shell(10.7 * kEdge, kEdge),
                                    contact::ContactModelKind::kAdapted, {kStiffness});
  const double step = 1e-9;
  int compared = 0;
  for (int n = 0; n < 200; ++n) {
    const Pose pose{kEdge * Vec3(11.0 + 0.005 * n, 32.137, 31.771), Quat::Identity()};
    const auto fresh = [&](const Pose& p) {
      renderer.reset();
      return renderer.render(p).contact;
    };
    const contact::ContactResult here = fresh(pose);
    expect_sound(here);
    if (here.coherence <= 0.2 || here.coherence >= 0.5 || here.interior_hits > 0)
      continue;
    for (int axis = 0; axis < 3; ++axis) {
      const contact::ContactResult after = fresh(moved(pose, axis, step)),
                                   before = fresh(moved(pose, axis, -step));
      if (after.surface_hits != here.surface_hits || before.surface_hits != here.surface_hits ||
          after.stiffness_bound_n_per_m != here.stiffness_bound_n_per_m ||
          before.stiffness_bound_n_per_m != here.stiffness_bound_n_per_m)
        continue;
      ++compared;
      const Vec6 measured = (as_vector(after.wrench) - as_vector(before.wrench)) / (2.0 * step);
      EXPECT_LE((measured + here.stiffness.col(axis)).norm(),
                1e-5 * here.stiffness.col(axis).norm() + 1e-6);
    }
  }
  EXPECT_GT(compared, 60);
}

TEST(Stiffness, CountsPassedAndReturningPoints) {
  const voxmap::Voxmap voxmap = block(kGrid, {0, 0, 0}, {59, 59, 59});
  for (const auto kind : kBothModels) {
    contact::ContactRenderer renderer(voxmap, sphere_shell(10 * kEdge, kEdge), kind, {kStiffness});
    int latched = 0, free = 0;
    for (int n = 0; n < 600; ++n) {
      const double depth = 0.05 * (n < 300 ? n : 600 - n) - 1.0;
      const contact::StageResult r =
          renderer.render({kEdge * Vec3(30.13, 29.77, 70.0 - depth), Quat::Identity()});
      expect_sound(r.contact);
      // Every direction is of unit length here, so each point with a force has the trace K.
      const double trace = r.contact.stiffness.topLeftCorner<3, 3>().trace();
      EXPECT_NEAR(trace, r.contact.stiffness_bound_n_per_m,
                  1e-9 * r.contact.stiffness_bound_n_per_m);
      if (r.latched) {
        ++latched;
        EXPECT_GE(trace, kStiffness * r.contact.interior_hits * (1 - 1e-9));
      }
      if (r.contact.surface_hits + r.contact.interior_hits == 0) {
        ++free;
        EXPECT_TRUE(r.contact.stiffness.isZero(0.0));
      }
    }
    EXPECT_GT(latched, 400);
    EXPECT_GT(free, 20);
  }
}

}  // namespace stiffness_test
}  // namespace voxtouch::test
