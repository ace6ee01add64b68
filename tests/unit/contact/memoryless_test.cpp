// A memoryless contact model: bit-identical to the model in every frame, nothing latched in a wall,
// and a flag when the tool passes one.
#include <gtest/gtest.h>

#include "field_scenes.hpp"
#include "fixtures.hpp"
#include "tests/support/exact_shell.hpp"

namespace voxtouch::test {
namespace memoryless_test {

using contact::ContactModelKind;
constexpr double kEdge = 0.002;

template <class Matrix>
bool same(const Matrix& a, const Matrix& b) {
  return (a.array() == b.array()).all();
}

/// In at one side of a slab, around in it, and out at the other, randomly rotated.
template <class F>
void through(double half_m, F&& at) {
  std::mt19937_64 random(7);
  for (int n = 0; n <= 400; ++n) {
    const double z = half_m + 0.012 - n * (2.0 * half_m + 0.024) / 400;
    at(Pose{Vec3(uniform(random, -1e-4, 1e-4), uniform(random, -1e-4, 1e-4), z),
            random_rotation(random)},
       z);
  }
}

TEST(Memoryless, MatchesTheStatefulModelBitForBit) {
  const Ground ground(box_mesh(Vec3(0.06, 0.06, 0.012)), kEdge);
  const Ball ball(0.01, 3);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  for (const ContactModelKind kind :
       {ContactModelKind::kOriginal, ContactModelKind::kAdapted, ContactModelKind::kField}) {
    contact::ContactRenderer memoryless = ground.renderer(shell, kind, true),
                             model = ground.renderer(shell, kind),
                             held = ground.renderer(shell, kind);
    int pushed = 0, others = 0, latched = 0;
    through(0.006, [&](const Pose& pose, double) {
      const contact::StageResult a = memoryless.render(pose), h = held.render(pose);
      const contact::ContactResult m = model.probe(pose);
      ASSERT_TRUE(same_bits(a.contact.wrench, m.wrench)) << contact::name_of(kind);
      ASSERT_TRUE(same(a.contact.stiffness, m.stiffness) &&
                  a.contact.stiffness_bound_n_per_m == m.stiffness_bound_n_per_m);
      ASSERT_TRUE(same(a.contact.mean_normal, m.mean_normal) &&
                  a.contact.coherence == m.coherence && a.contact.fallback == m.fallback);
      ASSERT_TRUE(a.contact.deepest_depth_m == m.deepest_depth_m &&
                  same(a.contact.deepest_point, m.deepest_point));
      ASSERT_TRUE(a.contact.surface_hits == m.surface_hits &&
                  a.contact.interior_hits == m.interior_hits);
      ASSERT_EQ(a.fast, h.fast);
      pushed += !a.contact.wrench.zero(), others += !same_bits(a.contact.wrench, h.contact.wrench),
          latched += a.latched;
    });
    EXPECT_GT(pushed, 200) << contact::name_of(kind);
    EXPECT_EQ(latched, 0);
    if (kind == ContactModelKind::kField)
      EXPECT_EQ(others, 0) << "nothing is held of it in any case";
    else
      EXPECT_GT(others, 200) << contact::name_of(kind) << ": the ring holds what has gone through";
  }
}

TEST(Memoryless, FlagsAToolCentreInAWallOrSheet) {
  mesh::TriangleMesh sheet;
  sheet.vertices = {Vec3(-0.03, -0.03, 0), Vec3(0.03, -0.03, 0), Vec3(0.03, 0.03, 0),
                    Vec3(-0.03, 0.03, 0)};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Ball ball(0.01, 3);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  for (const double half_m : {0.0, 0.0005, 0.006}) {
    const Ground ground(half_m > 0.0 ? box_mesh(Vec3(0.06, 0.06, 2.0 * half_m)) : sheet, kEdge);
    contact::ContactRenderer memoryless = ground.renderer(shell, ContactModelKind::kAdapted, true),
                             held = ground.renderer(shell, ContactModelKind::kAdapted);
    int passed_through = 0;
    through(half_m, [&](const Pose& pose, double) {
      const contact::StageResult a = memoryless.render(pose);
      const double middle = std::abs((pose * ball.centre).z());
      EXPECT_TRUE(!a.passed_through || middle < half_m + 1.01 * kEdge) << middle;
      EXPECT_TRUE(a.passed_through || !(middle < half_m)) << middle;
      EXPECT_FALSE(held.render(pose).passed_through);
      passed_through += a.passed_through;
    });
    EXPECT_GT(passed_through, 20) << half_m;
  }
}

/// A pole in a cup: the cup's middle is in the pole, and the cup has passed nothing.
TEST(Memoryless, DoesNotFlagAToolCentreOutsideTheTool) {
  const Ground pole(cylinder_mesh(0.003, 0.1, 48), kEdge);
  const mesh::TriangleMesh ring =
      joined(cylinder_mesh(0.02, 0.02, 96), inside_out(cylinder_mesh(0.016, 0.02, 96)));
  contact::ContactRenderer memoryless =
      pole.renderer(exact_shell(ring, kEdge), ContactModelKind::kAdapted, true);
  EXPECT_FALSE(memoryless.render({Vec3(1e-4, 2e-4, 1e-4), Quat::Identity()}).passed_through);
  contact::ContactRenderer rod = pole.renderer(exact_shell(cylinder_mesh(0.02, 0.02, 96), kEdge),
                                               ContactModelKind::kAdapted, true);
  EXPECT_TRUE(rod.render({Vec3(1e-4, 2e-4, 1e-4), Quat::Identity()}).passed_through)
      << "of one that is full it does";
}

}  // namespace memoryless_test
}  // namespace voxtouch::test
