#include "core/contact/field_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <chrono>
#include <cmath>

#include "core/contact/field_samples.hpp"
#include "field_scenes.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace field_model_test {

constexpr double kEdge = 1e-3;

Quat turned_by(double angle) { return Quat(Eigen::AngleAxisd(angle, Vec3(1, 2, -1).normalized())); }

/// A block so high; its upper face lies always at the same place.
struct Scene {
  double height = 0.03;
  Ball tool{8 * kEdge, 4};
  Ground ground{
      box_mesh(Vec3(0.04, 0.04, height),
               {Vec3(0.01, 0.02, 0.03) + turned_by(0.4) * Vec3(0.0, 0.0, 0.5 * (0.03 - height)),
                turned_by(0.4)}),
      kEdge};
  contact::ContactRenderer renderer = ground.renderer(exact_shell(tool.mesh, kEdge));
  /// Over the upper face, or near its rim.
  Pose random_pose(std::mt19937_64& random) const {
    const Vec3 at(uniform(random, 0.0, 0.024), uniform(random, 0.0, 0.024),
                  0.015 + 0.008 - uniform(random, 0, 0.006));
    return tool.posed(Pose{Vec3(0.01, 0.02, 0.03), turned_by(0.4)} * at, random_rotation(random));
  }
};

TEST(FieldModel, PushesEachPointByNormalAreaAndDepth) {
  Scene s;
  std::mt19937_64 random(31);
  int interior = 0;
  for (int n = 0; n < 50; ++n) {
    const contact::ContactResult r = s.renderer.probe(s.random_pose(random));
    Wrench sum;
    double deepest = 0.0;
    const contact::HitList& hits = s.renderer.hits();
    for (const contact::Hits* list : {&hits.surface, &hits.interior})
      for (const contact::Hit& hit : *list) {
        const Vec3 u = s.ground.field.grid().to_grid(hits.pose_WT.position + hit.arm);
        const double depth = std::max(0.0, -s.ground.field.at(u).distance_m);
        const double area = s.renderer.query().shell().area_m2[hit.point];
        const Vec3 force = kPressure * area * depth * hit.normal;
        sum.force += force, sum.torque += hit.arm.cross(force);
        deepest = std::max(deepest, depth);
      }
    interior += r.interior_hits > 0;
    EXPECT_LE((sum.force - r.wrench.force).norm(), 1e-9 * sum.force.norm());
    EXPECT_LE((sum.torque - r.wrench.torque).norm(),
              1e-9 * (sum.torque.norm() + 1e-3 * sum.force.norm()));
    EXPECT_NEAR(r.deepest_depth_m, deepest, 1e-12);
    EXPECT_EQ(r.surface_hits, hits.surface.size());
    EXPECT_EQ(r.interior_hits, hits.interior.size());
    EXPECT_FALSE(r.fallback);
  }
  EXPECT_GT(interior, 20);
}

TEST(FieldModel, BatchedLookupIsBitIdenticalToSingle) {
  Scene s;
  std::mt19937_64 random(33);
  const voxmap::Grid& grid = s.ground.field.grid();
  int deep = 0, unknown = 0;
  contact::HitBlock block;
  contact::FieldSamples samples;
  contact::PenaltyForces along_normal, along_gradient;
  contact::PenaltyLanes lanes;
  for (int n = 0; n < 2000; ++n) {
    block.groups = 1 + random() % contact::HitBlock::kGroups, block.count = block.filled();
    // From far outside of the table to the middle of the block.
    const Vec3 local = Pose{Vec3(0.01, 0.02, 0.03), turned_by(0.4)}.position - grid.origin;
    for (std::size_t k = 0; k < block.filled(); ++k)
      for (auto& row : block.arm)
        row[k] = uniform(random, -0.05, 0.05) * uniform(random, 0, 1);
    for (std::size_t k = 0; k < block.filled(); ++k) {
      const Vec3 normal = random_rotation(random) * Vec3::UnitX();
      for (int axis = 0; axis < 3; ++axis)
        block.normal[axis][k] = normal[axis];
      block.weight[k] = uniform(random, 0.0, 1e-6);
    }
    contact::sample_block(s.ground.field, local, block, samples);
    contact::field_forces(block, samples, s.ground.field.arrays().depth_voxels, along_normal,
                          along_gradient, lanes);
    for (std::size_t k = 0; k < block.filled(); ++k) {
      const voxmap::FieldSample one = s.ground.field.at(
          (local + Vec3(block.arm[0][k], block.arm[1][k], block.arm[2][k])) / grid.edge);
      ASSERT_EQ(samples.distance_m[k], one.distance_m);
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_EQ(samples.gradient[axis][k], one.gradient[axis]);
      ASSERT_EQ(samples.least[k] <= -s.ground.field.arrays().depth_voxels, one.saturated);
      const double steepness = one.gradient.norm(), force = block.weight[k] * -one.distance_m;
      const Vec3 gradient = steepness > 0.0 ? Vec3(one.gradient * (1.0 / steepness)) : one.gradient;
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_EQ(along_gradient.j[axis][k], gradient[axis]);
      ASSERT_EQ(along_normal.force[k], force > 0.0 ? force : 0.0);
      ASSERT_EQ(along_normal.weight[k], force > 0.0 ? 0.5 * block.weight[k] * steepness : 0.0);
      deep += one.saturated, unknown += !one.known;
    }
  }
  EXPECT_GT(deep, 100);
  EXPECT_GT(unknown, 1000);
}

TEST(FieldModel, StiffnessBoundsHowTheForceChangesWithThePose) {
  Scene s;
  std::mt19937_64 random(32);
  const double step = 1e-9;
  int compared = 0;
  for (int n = 0; n < 200; ++n) {
    const Pose pose = s.random_pose(random);
    const contact::ContactResult r = s.renderer.probe(pose);
    ASSERT_EQ(r.stiffness, Mat6(r.stiffness.transpose()));
    const Eigen::SelfAdjointEigenSolver<Mat6> all(r.stiffness, Eigen::EigenvaluesOnly);
    EXPECT_GE(all.eigenvalues()[0], -1e-9 * all.eigenvalues()[5]);
    const Mat3 given = r.stiffness.topLeftCorner<3, 3>();
    EXPECT_NEAR(given.trace(), r.stiffness_bound_n_per_m, 1e-9 * r.stiffness_bound_n_per_m);
    if (r.surface_hits + r.interior_hits < 10)
      continue;
    Mat3 seen;
    for (int axis = 0; axis < 3; ++axis) {
      Pose ahead = pose, behind = pose;
      ahead.position[axis] += step, behind.position[axis] -= step;
      seen.col(axis) =
          -(s.renderer.probe(ahead).wrench.force - s.renderer.probe(behind).wrench.force) /
          (2 * step);
    }
    const Mat3 slack = given - 0.5 * (seen + seen.transpose());
    const double size = r.stiffness_bound_n_per_m;
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Mat3>(slack, Eigen::EigenvaluesOnly).eigenvalues()[0],
              -1e-4 * size);
    EXPECT_LE(seen.jacobiSvd().singularValues()[0], size * (1 + 1e-4));
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(FieldModel, IsEqualAMillionMetresAway) {
  const double e = 0x1p-10;
  const Vec3 offset(1e6, -1e6, 5e5);
  mesh::TriangleMesh near = sphere_mesh(20 * e, 3);
  for (Vec3& v : near.vertices)
    v = (v * 0x1p20).array().round().matrix() * 0x1p-20;
  mesh::TriangleMesh far = near;
  for (Vec3& v : far.vertices)
    v += offset;
  voxmap::Grid grid = voxmap::default_grid(near, e);
  const Ground here(near, grid, 12.0);
  grid.origin += offset;
  const Ground there(far, grid, 12.0);
  const pointshell::Pointshell shell = exact_shell(sphere_mesh(8 * e, 3), e);
  contact::ContactRenderer a = here.renderer(shell), b = there.renderer(shell);
  std::mt19937_64 random(33);
  int pushed = 0;
  for (int n = 0; n < 300; ++n) {
    Vec3 at = e * uniform(random, 23, 29) * (random_rotation(random) * Vec3::UnitX());
    at = (at * 0x1p30).array().round().matrix() * 0x1p-30;
    const Quat turn = random_rotation(random);
    const contact::ContactResult one = a.probe({at, turn}), two = b.probe({at + offset, turn});
    ASSERT_TRUE(same_bits(one.wrench, two.wrench));
    pushed += !one.wrench.zero();
  }
  EXPECT_GT(pushed, 100);
}

TEST(FieldModel, PassesThroughTheStageWithTheFastFlagOnly) {
  Scene s;
  std::mt19937_64 random(34);
  for (int n = 0; n < 50; ++n) {
    const Pose pose = s.random_pose(random);
    const contact::StageResult r = s.renderer.render(pose);
    const contact::ContactResult plain = s.renderer.probe(pose);
    EXPECT_TRUE(same_bits(r.contact.wrench, plain.wrench));
    EXPECT_EQ(r.contact.saturated, plain.saturated);
    EXPECT_FALSE(r.latched);
    EXPECT_EQ(r.fast, n > 0);  // the poses are millimetres apart
  }
  const Pose pose = s.random_pose(random);
  s.renderer.render(pose);
  EXPECT_FALSE(s.renderer.render({pose.position + Vec3(0.3 * kEdge, 0, 0), pose.orientation}).fast);
  EXPECT_TRUE(s.renderer.render({pose.position - Vec3(0.3 * kEdge, 0, 0), pose.orientation}).fast);
}

TEST(FieldModel, GivesNothingWithoutAHitOrAValidPose) {
  Scene s;
  const contact::ContactResult free = s.renderer.probe({Vec3(1, 1, 1), Quat::Identity()});
  EXPECT_TRUE(free.wrench.zero() && free.stiffness.isZero(0.0));
  EXPECT_EQ(free.coherence, 0.0);
  const contact::ContactResult bad = s.renderer.probe({Vec3(std::nan(""), 0, 0), Quat::Identity()});
  EXPECT_EQ(bad.pose_status, contact::PoseStatus::kNotAPose);
  EXPECT_TRUE(bad.wrench.zero());
}

TEST(FieldModel, IsRefusedWithoutAreasOrWithoutAField) {
  const Ground ground(box_mesh(Vec3(0.01, 0.01, 0.01)), kEdge);
  const auto sentence = [](const contact::ContactParameters& parameters,
                           const voxmap::DistanceField* under) {
    try {
      contact::make_contact_model(contact::ContactModelKind::kField, parameters, under);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("no exception");
  };
  EXPECT_NE(sentence({1.0, contact::PointWeights::kOne}, &ground.field).find("stiffness_n_per_m3"),
            std::string::npos);
  EXPECT_NE(sentence({1.0, contact::PointWeights::kArea}, nullptr).find("build"),
            std::string::npos);
  EXPECT_EQ(sentence({1.0, contact::PointWeights::kArea}, &ground.field), "no exception");
}

/// Printed only: no test depends on the speed of a machine.
TEST(FieldModel, PrintsItsCostNextToAdapted) {
  const Ground ground(box_mesh(Vec3(0.08, 0.08, 0.04), {Vec3::Zero(), turned_by(0.2)}), kEdge);
  const Ball tool(30 * kEdge, 5);
  const pointshell::Pointshell shell = exact_shell(tool.mesh, kEdge);
  contact::ContactRenderer renderers[2] = {
      ground.renderer(shell, contact::ContactModelKind::kAdapted), ground.renderer(shell)};
  std::vector<double> cost[2];
  const auto models = {std::pair{contact::ContactModelKind::kAdapted, 0},
                       std::pair{contact::ContactModelKind::kField, 1}};
  for (int round = 0; round < 15; ++round)
    for (const auto& [kind, n] : models) {
      const auto model = contact::make_contact_model(
          kind, {kPressure, contact::PointWeights::kArea}, &ground.field);
      contact::ContactResult result;
      double hits = 0.0, ns = 0.0;
      for (int step = 0; step < 40; ++step) {
        const Vec3 at = turned_by(0.2) * Vec3(0.0002 * step, 0, 0.02 + 0.03 - 0.0012);
        renderers[n].probe(tool.posed(at, turned_by(0.01 * step)));
        const contact::HitList list = renderers[n].hits();
        const auto begin = std::chrono::steady_clock::now();
        for (int repeat = 0; repeat < 10; ++repeat)
          model->evaluate(list, result);
        ns += std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin)
                  .count() /
              10;
        hits += static_cast<double>(list.surface.size() + list.interior.size());
      }
      cost[n].push_back(ns / hits);
    }
  const double adapted = quantile(cost[0], 0.5), field = quantile(cost[1], 0.5);
  std::printf("per contact point: adapted %.1f ns, field %.1f ns, ratio %.2f\n", adapted, field,
              field / adapted);
  EXPECT_GT(field, 0.0);
}

}  // namespace field_model_test
}  // namespace voxtouch::test
