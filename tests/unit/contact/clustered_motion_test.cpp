// `clustered` has no step anywhere: a fine sweep through everything that could switch. The paper's models beside it.
#include <gtest/gtest.h>

#include <cmath>

#include "core/contact/patch_normals.hpp"
#include "core/voxmap/voxelise.hpp"
#include "field_scenes.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace clustered_motion_test {

constexpr double kEdge = 2e-3, kRadius = 10 * kEdge;

/// A ground, and a way through it that lasts from 0 to 1.
struct Way {
  const char* name;
  mesh::TriangleMesh mesh;
  std::function<Pose(double)> pose;
  double length_m;  ///< of the ball's centre, at most
};

std::vector<Way> ways(const Ball& ball) {
  const Quat oblique(Eigen::AngleAxisd(0.6, Vec3(1, 2, 0.5).normalized()));
  const Pose base{Vec3(0.1, 0.2, 0.3), oblique};
  const auto box = [&](const Vec3& size, const Vec3& at) { return box_mesh(size, base * Pose{at, Quat::Identity()}); };
  const mesh::TriangleMesh floor = box({0.12, 0.12, 0.04}, {0, 0, -0.02});
  const auto line = [&ball, base](const Vec3& from, const Vec3& to) {
    return [&ball, base, from, to](double s) {
      return ball.posed(base * (from + s * (to - from)), Quat(Eigen::AngleAxisd(0.2, Vec3::UnitX())));
    };
  };
  return {
      {"slides over a plane", floor, line({-0.01, 0.001, kRadius - 0.5 * kEdge}, {0.01, 0.004, kRadius - 0.6 * kEdge}),
       0.021},
      {"comes down, three voxels deep", floor,
       line({0.003, 0.001, kRadius + kEdge}, {0.004, 0.002, kRadius - 3 * kEdge}), 0.009},
      {"leaves one wall of a corner", joined(floor, box({0.04, 0.12, 0.12}, {-0.02, 0, 0})),
       line({kRadius - 0.7 * kEdge, 0, kRadius - 0.5 * kEdge}, {kRadius + 1.5 * kEdge, 0.001, kRadius - 0.5 * kEdge}),
       0.005},
      {"crosses a slot",
       joined(box({0.12, 0.12, 0.04}, {0, 0, -0.02}), box({0.12, 0.12, 0.04}, {0, 0, 2 * kRadius + 0.019})),
       line({0, 0, kRadius - 1.2 * kEdge}, {0.002, 0, kRadius + 0.7 * kEdge}), 0.005},
      {"over an edge", floor, line({0.055, 0, kRadius - 0.5 * kEdge}, {0.068, 0.002, kRadius - 1.5 * kEdge}), 0.0135},
      {"turns on the spot", floor,
       [&ball, base](double s) {
         return ball.posed(base * Vec3(0, 0, kRadius - 0.6 * kEdge),
                           Quat(Eigen::AngleAxisd(0.5 * s, Vec3(1, 2, 3).normalized())));
       },
       0.5 * kRadius},
  };
}

/// Largest change of the force between poses `step_edges` apart, over k A e, A the ball's area in the layer.
double largest_step(contact::ContactRenderer& renderer, const Way& way, double step_edges, double from = 0.0, double to = 1.0,
                    double* at = nullptr) {
  const int steps = static_cast<int>((to - from) * way.length_m / (step_edges * kEdge));
  double largest = 0.0;
  Vec3 before = renderer.probe(way.pose(from)).wrench.force;
  for (int n = 1; n <= steps; ++n) {
    const double s = from + (to - from) * n / steps;
    const Vec3 now = renderer.probe(way.pose(s)).wrench.force;
    if ((now - before).norm() > largest) {
      largest = (now - before).norm();
      if (at != nullptr) *at = s;
    }
    before = now;
  }
  return largest;
}

/// The stated bound: 1e-3 e of motion changes the force by no more than this share of the largest force a layer one voxel deep gives.
constexpr double kStepBound = 2e-3;

TEST(ClusteredMotion, HasNoStepWherePatchesMeetPointsComeAndGoOrVoxelsEnd) {
  const Ball ball(kRadius, 4);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  const double layer_force =
      kPressure * kEdge * 2 * 3.14159 * kRadius * kEdge;  // k e times the area of a cap one voxel high
  for (const Way& way : ways(ball)) {
    const voxmap::Voxmap map = voxmap::voxelise(way.mesh, voxmap::default_grid(way.mesh, kEdge), serial_for());
    contact::ContactRenderer clustered(map, shell, contact::ContactModelKind::kClustered, {kPressure, contact::PointWeights::kArea}),
        original(map, shell, contact::ContactModelKind::kOriginal, {kPressure, contact::PointWeights::kArea}),
        adapted(map, shell, contact::ContactModelKind::kAdapted, {kPressure, contact::PointWeights::kArea});
    double at = 0.0;
    const double c = largest_step(clustered, way, 1e-3, 0, 1, &at) / layer_force;
    const double half_way = 20e-3 * kEdge / way.length_m;
    const double finer =
        largest_step(clustered, way, 1e-4, std::max(0.0, at - half_way), std::min(1.0, at + half_way)) / layer_force;
    const double o = largest_step(original, way, 1e-3) / layer_force,
                 a = largest_step(adapted, way, 1e-3) / layer_force;
    std::printf(
        "%-30s largest step per 1e-3 e, share of a layer's force: clustered %.5f (per 1e-4 e %.5f), original %.4f, "
        "adapted %.4f\n",
        way.name, c, finer, o, a);
    EXPECT_LE(c, kStepBound) << way.name;
    EXPECT_LE(finer, 0.2 * c) << way.name << ": a step would stay as large";
    EXPECT_GT(std::max(o, a), 2 * c) << "the sweep crosses what makes the paper's models step";
  }
}

TEST(ClusteredMotion, GoesOnPushingDownToThreeVoxelsAndSaysThatItIsAtItsEnd) {
  const Ball ball(kRadius, 4);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  const Pose base{Vec3(0.1, 0.2, 0.3), Quat(Eigen::AngleAxisd(0.6, Vec3(1, 2, 0.5).normalized()))};
  const mesh::TriangleMesh floor = box_mesh({0.12, 0.12, 0.08}, base * Pose{Vec3(0, 0, -0.04), Quat::Identity()});
  const voxmap::Voxmap map = voxmap::voxelise(floor, voxmap::default_grid(floor, kEdge), serial_for());
  contact::ContactRenderer renderer(map, shell, contact::ContactModelKind::kClustered, {kPressure, contact::PointWeights::kArea});
  double before = 0.0;
  for (int n = 1; n <= 12; ++n) {
    const double depth = 0.25 * n * kEdge;
    const contact::StageResult r = renderer.render(ball.posed(base * Vec3(0, 0, kRadius - depth), Quat::Identity()));
    const Vec3 force = base.orientation.conjugate() * r.contact.wrench.force;
    EXPECT_GT(force.z(), before) << depth / kEdge << " e deep";
    EXPECT_FALSE(r.retained) << "nothing is remembered";
    before = force.z();
    if (depth < 0.5 * kEdge || depth > 2.5 * kEdge) {
      EXPECT_EQ(r.contact.saturated, depth > 2.5 * kEdge);
    }
  }
}

TEST(ClusteredMotion, StiffnessBoundsHowTheForceGrows) {
  const Ball ball(kRadius, 4);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  for (const Way& way : ways(ball)) {
    const voxmap::Voxmap map = voxmap::voxelise(way.mesh, voxmap::default_grid(way.mesh, kEdge), serial_for());
    contact::ContactRenderer renderer(map, shell, contact::ContactModelKind::kClustered, {kPressure, contact::PointWeights::kArea});
    double worst = 0.0;
    for (int n = 0; n <= 60; ++n) {
      Pose pose = way.pose(n / 60.0);
      const contact::ContactResult here = renderer.probe(pose);
      if (here.wrench.force.isZero(0.0)) continue;
      const Mat3 translation = here.stiffness.topLeftCorner<3, 3>();
      EXPECT_LE(translation.norm(), here.stiffness_bound_n_per_m * (1 + 1e-12));
      const Vec3 push = here.wrench.force.normalized();
      pose.position -= 0.02 * kEdge * push;
      worst = std::max(worst, (renderer.probe(pose).wrench.force - here.wrench.force).norm() /
                                  (0.02 * kEdge * here.stiffness_bound_n_per_m));
    }
    std::printf("%-30s force growth over the bound %.2f\n", way.name, worst);
    EXPECT_LE(worst, 1.0) << way.name;
  }
}

TEST(ClusteredMotion, GivesTheSameFarFromTheOrigin) {
  const Ball ball(kRadius, 3);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  const mesh::TriangleMesh floor =
      box_mesh({0.12, 0.12, 0.04}, {Vec3(0, 0, -0.02), Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX()))});
  const double far = 1048576.0;  // a power of two: the grid's own coordinates stay exact
  voxmap::Grid grid = voxmap::default_grid(floor, 1.0 / 512), away = grid;
  away.origin += Vec3(far, 0, 0);
  mesh::TriangleMesh moved = floor;
  const voxmap::Voxmap near_map = voxmap::voxelise(floor, grid, serial_for());
  contact::ContactRenderer near(near_map, shell, contact::ContactModelKind::kClustered, {kPressure, contact::PointWeights::kArea});
  voxmap::Voxmap far_map(away, near_map.base(),
                 {near_map.base().i + static_cast<std::int32_t>(8 * near_map.cells()[0]) - 1,
                  near_map.base().j + static_cast<std::int32_t>(8 * near_map.cells()[1]) - 1,
                  near_map.base().k + static_cast<std::int32_t>(8 * near_map.cells()[2]) - 1});
  near_map.for_each_occupied([&](const voxmap::VoxelIndex& v, voxmap::VoxelKind kind) { far_map.set(v, kind); });
  far_map.finish();
  contact::ContactRenderer distant(far_map, shell, contact::ContactModelKind::kClustered, {kPressure, contact::PointWeights::kArea});
  for (int n = 0; n < 20; ++n) {
    Pose pose{Vec3(n / 4096.0, 0, 0.0176), Quat(Eigen::AngleAxisd(0.1 * n, Vec3::UnitZ()))};
    const Wrench a = near.probe(pose).wrench;
    pose.position.x() += far;
    const Wrench b = distant.probe(pose).wrench;
    EXPECT_EQ(a.force, b.force);
    EXPECT_EQ(a.torque, b.torque);
  }
}

TEST(PatchNormals, MeanIsThatOfNearNormalsOnly) {
  contact::PatchNormals patches;
  std::mt19937_64 random(31);
  for (int n = 0; n < 200; ++n) {
    const Vec3 wobble(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1));
    patches.add((Vec3::UnitX() + wobble).normalized(), 1.0);
    patches.add((Vec3::UnitZ() + wobble).normalized(), 5.0);
  }
  EXPECT_LT(degrees_between(patches.mean_near(Vec3::UnitX()), Vec3::UnitX()), 2.0);
  EXPECT_LT(degrees_between(patches.mean_near(Vec3::UnitZ()), Vec3::UnitZ()), 2.0);
  EXPECT_EQ(patches.mean_near(-Vec3::UnitX()), -Vec3::UnitX()) << "nobody is near";
}

TEST(PatchNormals, EveryDirectionHasBinsAndGivesItselfBack) {
  std::mt19937_64 random(32);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 normal = random_rotation(random) * Vec3::UnitZ();
    contact::PatchNormals patches;
    patches.add(normal, 0.5);
    EXPECT_LT((patches.mean_near(normal) - normal).norm(), 1e-12);
    const Vec3 near = (normal + 0.05 * (random_rotation(random) * Vec3::UnitX())).normalized();
    EXPECT_LT((patches.mean_near(near) - normal).norm(), 1e-12) << "three degrees away the patch is the same";
  }
}

TEST(ClusteredModel, RefusesWhatItCannotDoWithASentence) {
  const voxmap::Voxmap map = block({Vec3::Zero(), 1.0}, {0, 0, 0}, {3, 3, 3});
  EXPECT_THROW(contact::make_contact_model(contact::ContactModelKind::kClustered, {1.0, contact::PointWeights::kOne}, {&map}),
               std::invalid_argument);
  EXPECT_THROW(contact::make_contact_model(contact::ContactModelKind::kClustered, {1.0, contact::PointWeights::kArea}, {}),
               std::invalid_argument);
}

}  // namespace clustered_motion_test
}  // namespace voxtouch::test
