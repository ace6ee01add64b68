#include "core/rendering/contact_range.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <random>

#include "core/contact/stiffness_sum.hpp"
#include "core/rendering/build.hpp"
#include "core/rendering/contact_parameters.hpp"
#include "core/scene/scene_file.hpp"

namespace voxtouch::rendering {
namespace {

pointshell::Pointshell shell_of(const std::vector<Vec3>& points) {
  pointshell::Pointshell shell;
  for (const Vec3& p : points)
    shell.x.push_back(p.x()), shell.y.push_back(p.y()), shell.z.push_back(p.z());
  return shell;
}

double largest_eigenvalue(const Mat3& m) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(m, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

TEST(ContactStiffness, CountsPointsAndLevers) {
  const StiffnessBounds none = contact_stiffness({}, {10.0});
  EXPECT_EQ(none.translation.all_points + none.rotation.all_points + none.translation.one_point,
            0.0);
  const StiffnessBounds one = contact_stiffness(shell_of({Vec3(0.3, 0, 0.4)}), {10.0});
  EXPECT_DOUBLE_EQ(one.translation.one_point, 10.0);
  EXPECT_DOUBLE_EQ(one.translation.all_points, 10.0);
  EXPECT_NEAR(one.rotation.one_point, 2.5, 1e-11);
  EXPECT_EQ(one.rotation.all_points, one.rotation.one_point);
  // A rod along x: about y and z both ends count, about x none.
  const StiffnessBounds rod =
      contact_stiffness(shell_of({Vec3(0.5, 0, 0), Vec3(-0.5, 0, 0), Vec3(0.1, 0, 0)}), {10.0});
  EXPECT_DOUBLE_EQ(rod.translation.all_points, 30.0);
  EXPECT_NEAR(rod.rotation.one_point, 2.5, 1e-11);
  EXPECT_NEAR(rod.rotation.all_points, 5.1, 1e-11);
  // Six points of a ball: two thirds of K sum |r|^2.
  const StiffnessBounds ball =
      contact_stiffness(shell_of({Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(),
                                  Vec3::UnitZ(), -Vec3::UnitZ()}),
                        {10.0});
  EXPECT_NEAR(ball.rotation.all_points, 10.0 * 4.0, 1e-9);
}

TEST(ContactStiffness, WeighsPointsByAreaIfTheSceneDoes) {
  pointshell::Pointshell shell = shell_of({Vec3(0.5, 0, 0), Vec3(-0.1, 0, 0)});
  shell.area_m2 = {2e-6, 6e-6};
  const StiffnessBounds bound = contact_stiffness(shell, {1e6, contact::PointWeights::kArea});
  EXPECT_DOUBLE_EQ(bound.translation.one_point, 6.0);
  EXPECT_DOUBLE_EQ(bound.translation.all_points, 8.0);
  EXPECT_NEAR(bound.rotation.one_point, 0.5, 1e-11);
  EXPECT_NEAR(bound.rotation.all_points, 0.56, 1e-11);
}

TEST(ContactParameters, WeighByAreaIfTheSceneOrModelRequiresIt) {
  pointshell::Pointshell shell = shell_of({Vec3(0.5, 0, 0), Vec3(-0.1, 0, 0)});
  shell.area_m2 = {2e-6, 6e-6};
  scene::ContactSpec by_point, by_area;
  by_point.stiffness_n_per_m = 4, by_area.stiffness_n_per_m3 = 5e5;
  const contact::ContactParameters paper =
      contact_parameters(by_point, contact::ContactModelKind::kAdapted, shell);
  EXPECT_EQ(paper.weights, contact::PointWeights::kOne);
  EXPECT_EQ(paper.stiffness, 4);
  for (const auto kind : {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted,
                          contact::ContactModelKind::kField}) {
    const contact::ContactParameters area = contact_parameters(by_area, kind, shell);
    EXPECT_EQ(area.weights, contact::PointWeights::kArea);
    EXPECT_EQ(area.stiffness, 5e5);
  }
  const contact::ContactParameters other =
      contact_parameters(by_point, contact::ContactModelKind::kField, shell);
  EXPECT_EQ(other.weights, contact::PointWeights::kArea);
  EXPECT_NEAR(other.stiffness, 1e6, 1e-6) << "8 N/m together, either way";
}

TEST(ContactStiffness, BoundsEverySetOfPointsWithAnyDirections) {
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto vector = [&] { return Vec3(number(random), number(random), number(random)); };
  double tightest = 0.0;
  for (int attempt = 0; attempt < 2000; ++attempt) {
    std::vector<Vec3> points;
    const auto count = 1 + attempt % 12;
    for (int p = 0; p < count; ++p)
      points.push_back(vector() + Vec3(0.5, 0, 0));
    const StiffnessBounds bound = contact_stiffness(shell_of(points), {3.0});
    contact::StiffnessSum sum;
    const Vec3 axis = vector().normalized();
    for (const Vec3& arm : points) {
      if (attempt % 3 == 0 && number(random) < 0.0)
        continue;
      // Every other trial chooses the worst direction for one axis.
      const Vec3 u = attempt % 2 == 0 ? vector() : axis.cross(arm);
      sum.add(arm, u.normalized());
    }
    Mat6 stiffness = Mat6::Zero();
    sum.add_to(3.0, stiffness);
    EXPECT_LE(largest_eigenvalue(stiffness.topLeftCorner<3, 3>()),
              bound.translation.all_points * (1 + 1e-12));
    const double rotation = largest_eigenvalue(stiffness.bottomRightCorner<3, 3>());
    EXPECT_LE(rotation, bound.rotation.all_points * (1 + 1e-12));
    tightest = std::max(tightest, rotation / bound.rotation.all_points);
  }
  EXPECT_GT(tightest, 0.99) << "the bound is reached";
}

TEST(ContactStiffness, HoldsForEveryFrameThatASceneRenders) {
  const scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  const auto built = build_scene(scene, serial_for());
  const Plan& plan = built->plan();
  EXPECT_EQ(plan.contact_n_per_m.one_point, scene.contact.stiffness_n_per_m);
  EXPECT_EQ(plan.contact_n_per_m.all_points,
            scene.contact.stiffness_n_per_m * static_cast<double>(plan.shell_points));
  double most = 0.0;
  for (int n = 0; n < 400; ++n) {
    const Pose pose{Vec3(0.0003 * n, 0, 0.012 - 0.0001 * n),
                    Quat(Eigen::AngleAxisd(0.01 * n, Vec3::UnitY()))};
    const contact::ContactResult r = built->renderer().render(pose).contact;
    const double translation = largest_eigenvalue(r.stiffness.topLeftCorner<3, 3>());
    most = std::max(most, translation);
    EXPECT_LE(translation, plan.contact_n_per_m.all_points * (1 + 1e-12));
    EXPECT_LE(largest_eigenvalue(r.stiffness.bottomRightCorner<3, 3>()),
              plan.contact_nm_per_rad.all_points * (1 + 1e-12));
  }
  EXPECT_GT(most, 0.0);
}

}  // namespace
}  // namespace voxtouch::rendering
