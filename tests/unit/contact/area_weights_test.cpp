// Effect of area weights in the paper's two models. R = 10 e, 0.5 e deep.
#include <gtest/gtest.h>

#include <cmath>

#include "core/voxmap/voxelise.hpp"
#include "field_scenes.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace {

constexpr double kEdge = 2e-3, kRadius = 10 * kEdge, kDepth = 0.5 * kEdge;

const Ball& ball() {
  static const Ball one(kRadius, 5);
  return one;
}
const pointshell::Pointshell& shell() {
  static const pointshell::Pointshell one = exact_shell(ball().mesh, kEdge);
  return one;
}

/// One contact model over one voxmap.
contact::ContactRenderer model_over(const voxmap::Voxmap& voxmap, contact::ContactModelKind kind,
                                    contact::PointWeights weights) {
  return {voxmap, shell(), kind, {1.0, weights}};
}
voxmap::Voxmap voxels(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid) {
  return voxmap::voxelise(mesh, grid, serial_for());
}

/// A place on a surface, and its outward normal.
struct Place {
  Vec3 point, normal;
};
struct Setting {
  std::string name;
  mesh::TriangleMesh mesh;
  std::function<Place(std::mt19937_64&)> place;
};

/// `offset_edges`: position of the face in its voxel, for a plane along the grid.
Setting plane(const std::string& name, const Quat& turn, double offset_edges) {
  const Pose pose{Vec3(0.1, 0.2, 0.3 + offset_edges * kEdge), turn};
  return {name, box_mesh(Vec3(0.12, 0.12, 0.04), pose), [pose](std::mt19937_64& random) {
            return Place{
                pose * Vec3(uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02), 0.02),
                pose.orientation * Vec3::UnitZ()};
          }};
}
Setting cylinder(const std::string& name, double radius, const Quat& turn) {
  mesh::TriangleMesh mesh = cylinder_mesh(radius, 0.12, 720);
  for (Vec3& v : mesh.vertices)
    v = turn * v;
  return {name, mesh, [radius, turn](std::mt19937_64& random) {
            const double angle = uniform(random, 0, 7);
            const Vec3 normal(std::cos(angle), std::sin(angle), 0);
            return Place{turn * (radius * normal + Vec3(0, 0, uniform(random, -0.02, 0.02))),
                         turn * normal};
          }};
}
Quat about(double degrees, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(degrees * 3.14159265358979 / 180, axis.normalized()));
}

std::vector<Setting> settings() {
  return {plane("plane along the grid, face 0.7 up its voxel", Quat::Identity(), 0.7),
          plane("plane along the grid, face 0.9 up its voxel", Quat::Identity(), 0.9),
          plane("plane tilted by 10 deg", about(10, Vec3::UnitX()), 0.0),
          plane("plane tilted by 26.6 deg", about(26.6, Vec3::UnitX()), 0.0),
          plane("plane tilted by 34 deg about (1, 2, 0.5)", about(34, Vec3(1, 2, 0.5)), 0.0),
          plane("plane along a diagonal", Quat::FromTwoVectors(Vec3::UnitZ(), Vec3(1, 1, 1)), 0.0),
          cylinder("cylinder of 20 mm", 0.02, Quat::Identity()),
          cylinder("cylinder of 40 mm", 0.04, Quat::Identity()),
          cylinder("cylinder of 40 mm, tilted by 20 deg", 0.04, about(20, Vec3(1, 0.3, 0)))};
}

/// RMS of the force across the normal, over the mean force along it.
double tangential_noise(contact::ContactRenderer renderer, const Setting& setting,
                        std::uint64_t seed) {
  constexpr int kPoses = 150;
  std::mt19937_64 random(seed);
  std::vector<double> across;
  double mean = 0.0;
  for (int n = 0; n < kPoses; ++n) {
    const Place place = setting.place(random);
    const Pose pose =
        ball().posed(place.point + (kRadius - kDepth) * place.normal, random_rotation(random));
    const Vec3 force = renderer.probe(pose).wrench.force;
    const double along = force.dot(place.normal);
    across.push_back((force - along * place.normal).norm());
    mean += along / kPoses;
  }
  return rms(across) / mean;
}

TEST(AreaWeights, ReduceTheMeanNormalsNoise) {
  std::vector<double> of_original, of_adapted;
  for (const Setting& s : settings()) {
    const voxmap::Voxmap map = voxels(s.mesh, voxmap::default_grid(s.mesh, kEdge));
    const auto ratio = [&](contact::ContactModelKind kind) {
      return tangential_noise(model_over(map, kind, contact::PointWeights::kArea), s, 24) /
             tangential_noise(model_over(map, kind, contact::PointWeights::kOne), s, 24);
    };
    of_original.push_back(ratio(contact::ContactModelKind::kOriginal));
    of_adapted.push_back(ratio(contact::ContactModelKind::kAdapted));
  }
  std::printf(
      "tangential rms with area weights over without, median: original %.2f, adapted %.2f\n",
      quantile(of_original, 0.5), quantile(of_adapted, 0.5));
  EXPECT_LT(quantile(of_adapted, 0.5), 1.0);
}

/// A point that replaces two of half its area has the force of both.
TEST(AreaWeights, SplittingAPointChangesNothing) {
  const voxmap::Voxmap map = block({Vec3::Zero(), 1.0}, {0, 0, 0}, {20, 20, 5});
  pointshell::Pointshell whole = shell_of(
      {{Vec3(0, 0, 0), Vec3(0, 0, 1)}, {Vec3(1.3, 0.2, 0.1), Vec3(0.1, 0, 1).normalized()}}, 1.0);
  whole.area_m2 = {0.8, 0.6};
  pointshell::Pointshell split = shell_of({{Vec3(0, 0, 0), Vec3(0, 0, 1)},
                                           {Vec3(1.3, 0.2, 0.1), Vec3(0.1, 0, 1).normalized()},
                                           {Vec3(1.3, 0.2, 0.1), Vec3(0.1, 0, 1).normalized()}},
                                          1.0);
  split.area_m2 = {0.8, 0.3, 0.3};
  for (const contact::ContactModelKind kind :
       {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
    contact::ContactRenderer one(map, whole, kind, {7.0, contact::PointWeights::kArea}),
        two(map, split, kind, {7.0, contact::PointWeights::kArea});
    const Pose pose{Vec3(8.4, 9.2, 5.35), Quat::Identity()};
    const contact::ContactResult a = one.probe(pose), b = two.probe(pose);
    ASSERT_GT(a.wrench.force.norm(), 0.0) << contact::name_of(kind);
    EXPECT_LT((a.wrench.force - b.wrench.force).norm(), 1e-12 * a.wrench.force.norm())
        << contact::name_of(kind);
    EXPECT_LT((a.wrench.torque - b.wrench.torque).norm(), 1e-12 * a.wrench.force.norm());
    EXPECT_NEAR(a.stiffness_bound_n_per_m, b.stiffness_bound_n_per_m, 1e-12);
    EXPECT_NEAR(a.coherence, b.coherence, 1e-12);
  }
}

}  // namespace
}  // namespace voxtouch::test
