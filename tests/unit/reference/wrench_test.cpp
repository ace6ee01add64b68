#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <tuple>

#include "core/reference/reference_scene.hpp"
#include "core/reference/reference_wrench.hpp"
#include "core/scene/scene_file.hpp"
#include "tests/support/parts.hpp"
#include "tests/unit/reference/sampled_wrench.hpp"

namespace voxtouch::reference {
namespace {

scene::Scene shipped(const std::string& name) {
  return scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/" + name + ".yaml");
}

/// Sphere of radius R, h deep in a half space: k pi h^2 (R - h / 3).
double cap(double radius, double h) { return std::numbers::pi * h * h * (radius - h / 3.0); }

TEST(ReferenceWrench, MatchesASphereInAHalfSpace) {
  const ReferenceWrench reference(shipped("plane"), 0.25e-3);
  const double chord = ReferenceScene(shipped("plane")).chord_error_m();
  ASSERT_LT(chord, 5e-5);
  for (const double h : {0.5e-3, 1e-3, 2e-3, 4e-3}) {
    const TrueWrench w = reference.at(
        {Vec3(0.001, 0.002, 0.01 - h), Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()))});
    // The facets lie inside the sphere, by the chord error at most.
    EXPECT_LT(w.wrench.force.z(), 1.001 * cap(0.01, h)) << h;
    EXPECT_GT(w.wrench.force.z(), 0.999 * cap(0.01, h - chord)) << h;
    EXPECT_LT(w.wrench.force.head<2>().norm(), 0.01 * w.wrench.force.z()) << h;
    EXPECT_LT(w.wrench.torque.norm(), 1e-4 * w.wrench.force.z())
        << "a push through the centre has no lever";
    EXPECT_NEAR(w.depth_m, h, 5e-5);
    EXPECT_NEAR(w.area_m2 / (2 * std::numbers::pi * 0.01 * h), 1.0, 0.08);
  }
}

/// Archimedes: the force on a body that dips into a half space is straight up, k times the
/// displaced volume. For a box on an edge, tilted by 45 degrees, that is a wedge h deep, h h per
/// length of the edge; its triangles are far larger than the resolution, and cross the surface.
TEST(ReferenceWrench, IsTheWeightOfWhatABoxDisplaces) {
  scene::Scene scene = shipped("plane");
  const std::string path = ::testing::TempDir() + "voxtouch_box_reference.obj";
  std::FILE* file = std::fopen(path.c_str(), "w");
  ASSERT_NE(file, nullptr);
  for (int n = 0; n < 8; ++n)
    std::fprintf(file, "v %d %d %d\n", n & 1, n >> 1 & 1, n >> 2 & 1);
  std::fputs("f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n", file);
  std::fclose(file);
  scene.dynamic_mesh.path = path;
  scene.dynamic_mesh.scale = 0.02;
  scene.dynamic_mesh.primitives.clear();
  const ReferenceWrench reference(scene, 0.25e-3);
  const Quat turn(Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitX()));
  for (const double h : {0.5e-3, 1e-3, 3e-3}) {
    const TrueWrench w = reference.at({Vec3(-0.01, 0.001, -h), turn});
    const double displaced = h * h * 0.02;
    EXPECT_NEAR(w.wrench.force.z() / displaced, 1.0, 0.02) << h;
    EXPECT_LT(w.wrench.force.head<2>().norm(), 0.02 * displaced) << h;
    EXPECT_NEAR(w.wrench.torque.y(), -0.01 * w.wrench.force.z(), 0.01 * 0.01 * displaced)
        << "it acts at half the edge";
  }
  std::remove(path.c_str());
}

/// Two boxes, one of them inverted, as by manual mirroring: the force is that of two boxes.
TEST(ReferenceWrench, PushesOutwardForEitherOrientation) {
  scene::Scene scene = shipped("plane");
  const std::string path = ::testing::TempDir() + "voxtouch_inverted_reference.obj";
  scene.dynamic_mesh.path = path;
  scene.dynamic_mesh.scale = 0.01;
  scene.dynamic_mesh.primitives.clear();
  const auto wrench = [&](bool first_flipped, bool second_flipped) {
    std::FILE* file = std::fopen(path.c_str(), "w");
    for (int box = 0; box < 2; ++box)
      for (int n = 0; n < 8; ++n)
        std::fprintf(file, "v %d %d %d\n", (n & 1) + 3 * box, n >> 1 & 1, n >> 2 & 1);
    const int faces[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5},
                             {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
    for (int box = 0; box < 2; ++box)
      for (const auto& f : faces) {
        const bool flipped = box == 0 ? first_flipped : second_flipped;
        std::fprintf(file, "f %d %d %d %d\n", f[0] + 8 * box, f[flipped ? 3 : 1] + 8 * box,
                     f[2] + 8 * box, f[flipped ? 1 : 3] + 8 * box);
      }
    std::fclose(file);
    const Wrench w =
        ReferenceWrench(scene, 0.25e-3).at({Vec3(-0.02, 0, -2e-3), Quat::Identity()}).wrench;
    std::remove(path.c_str());
    return w;
  };
  const Wrench good = wrench(false, false);
  EXPECT_NEAR(good.force.z(), 2 * 2e-3 * 0.01 * 0.01, 1e-3 * good.force.z());
  for (const auto& [first, second] :
       {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
    const Wrench w = wrench(first, second);
    EXPECT_LT((w.force - good.force).norm(), 1e-9 * good.force.norm()) << first << second;
    EXPECT_LT((w.torque - good.torque).norm(), 1e-9 * good.force.norm() * 0.02) << first << second;
  }
}

TEST(ReferenceWrench, IsZeroApartAndForAnInvalidPose) {
  const ReferenceWrench reference(shipped("plane"), 0.5e-3);
  const TrueWrench apart = reference.at({Vec3(0, 0, 0.0101), Quat::Identity()});
  EXPECT_TRUE(apart.wrench.zero());
  EXPECT_LT(apart.samples, 100u) << "what is far away is skipped whole";
  EXPECT_TRUE(reference.at({Vec3(NAN, 0, 0), Quat::Identity()}).wrench.zero());
}

TEST(ReferenceWrench, ConvergesAsItsResolutionIsHalved) {
  const scene::Scene scene = shipped("cup");
  const Quat turned(Eigen::AngleAxisd(1.0, Vec3(1, -1, 0.5).normalized()));
  const Pose pose{scene.motions.at("hit").path.back(), turned};
  const Vec3 a = ReferenceWrench(scene, 1e-3).at(pose).wrench.force,
             b = ReferenceWrench(scene, 0.5e-3).at(pose).wrench.force,
             c = ReferenceWrench(scene, 0.25e-3).at(pose).wrench.force;
  ASSERT_GT(c.norm(), 0.0);
  EXPECT_LT((b - c).norm(), 0.002 * c.norm());
  EXPECT_LE((b - c).norm(), (a - c).norm() + 1e-4 * c.norm());
  RecordProperty("relative_error_half_millimetre", std::to_string((b - c).norm() / c.norm()));
}

/// F = -grad E, and the same for torque: the work on a closed path is zero, also over a curved wall
/// and into its edge.
TEST(ReferenceWrench, IsConservative) {
  const ReferenceWrench reference(shipped("cylinder"), 0.5e-3);
  const Vec3 touch = shipped("cylinder").motions.at("hit").path.back();
  double work = 0.0, displacement = 0.0, most = 0.0;
  constexpr int kSteps = 40;
  const auto pose = [&](int n) {
    const double a = 2 * std::numbers::pi * n / kSteps;
    return Pose{touch + Vec3(0.004 * std::cos(a), 0.003 * std::sin(a), 0.001 * std::sin(2 * a)),
                Quat(Eigen::AngleAxisd(0.2 * std::sin(a), Vec3::UnitY()))};
  };
  for (int n = 0; n < kSteps; ++n) {
    const Pose from = pose(n), to = pose(n + 1);
    const Wrench w =
        reference
            .at({0.5 * (from.position + to.position), from.orientation.slerp(0.5, to.orientation)})
            .wrench;
    const Eigen::AngleAxisd turn(to.orientation * from.orientation.conjugate());
    work += w.force.dot(to.position - from.position) + w.torque.dot(turn.angle() * turn.axis());
    displacement += (to.position - from.position).norm();
    most = std::max(most, w.force.norm());
  }
  EXPECT_GT(most, 0.0);
  EXPECT_LT(std::abs(work), 0.002 * most * displacement);
}

/// At random attitudes, in faces, edges, a fillet and teeth, at depths as
/// `voxtouch accuracy` has them.
TEST(ReferenceWrench, MatchesFullSamplingWithFewerQueries) {
  const std::filesystem::path folder = ::testing::TempDir();
  scene::Scene scene = shipped("plane");
  scene.dynamic_mesh.primitives.clear(), scene.static_meshes[0].primitives.clear();
  scene.static_meshes[0].pose = {}, scene.dynamic_mesh.pose = {};
  scene.static_meshes[0].scale = scene.dynamic_mesh.scale = 1.0;
  scene.dynamic_mesh.path = folder / "voxtouch_wrench_peg.obj";
  test::write_obj(test::peg(), scene.dynamic_mesh.path);
  std::mt19937_64 random(5);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  for (const auto& [name, part, fraction] :
       {std::tuple("bracket", test::bracket(), 0.18), std::tuple("gear", test::gear(), 0.205)}) {
    scene.static_meshes[0].path = folder / ("voxtouch_wrench_" + std::string(name) + ".obj");
    test::write_obj(part, scene.static_meshes[0].path);
    const ReferenceWrench fast(scene, 1e-3);
    const SampledWrench slow(scene);
    double asked = 0.0, asked_before = 0.0, largest = 0.0;
    int contacts = 0;
    for (int n = 0; n < 200 && contacts < 4; ++n) {
      const Vec3 axis(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      const Vec3 corner = part.vertices[random() % part.vertices.size()];
      const Pose pose{corner + Vec3(uniform(-8, 8), uniform(-8, 8), uniform(-12, 12)) * 1e-3,
                      Quat(Eigen::AngleAxisd(uniform(0, 3), axis.normalized()))};
      const TrueWrench a = fast.at(pose);
      if (a.depth_m < 2e-4 || a.depth_m > 4e-3)
        continue;
      ++contacts;
      const TrueWrench b = slow.at(pose, a.depth_m), again = fast.at(pose, a.depth_m);
      const double error = (again.wrench.force - b.wrench.force).norm() / b.wrench.force.norm();
      EXPECT_LT(error, 0.02) << name << ' ' << n << ", depth " << a.depth_m;
      EXPECT_LT((again.wrench.torque - b.wrench.torque).norm(),
                0.02 * 0.015 * b.wrench.force.norm())
          << name << ' ' << n;
      EXPECT_NEAR(again.depth_m, b.depth_m, 0.1 * b.depth_m);
      largest = std::max(largest, error);
      asked += static_cast<double>(again.samples), asked_before += static_cast<double>(b.samples);
    }
    EXPECT_EQ(contacts, 4);
    std::printf(
        "%s: %.2f %% off at most, %.0f distances a contact, %.0f where sampled everywhere\n", name,
        100 * largest, asked / 4.0, asked_before / 4.0);
    EXPECT_LT(asked, fraction * asked_before)
        << "what neighbours share is asked for once, and what "
           "the corners' distances cover is not asked for";
    std::filesystem::remove(scene.static_meshes[0].path);
  }
  std::filesystem::remove(scene.dynamic_mesh.path);
}

TEST(ReferenceWrench, RefusesAnOpenMeshWithASentence) {
  scene::Scene scene = shipped("plane");
  const std::string path = ::testing::TempDir() + "voxtouch_open_reference.obj";
  std::FILE* file = std::fopen(path.c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", file);
  std::fclose(file);
  scene.static_meshes[0].path = path;
  try {
    ReferenceWrench reference(scene, 1e-3);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("open"), std::string::npos);
  }
  std::remove(path.c_str());
}

}  // namespace
}  // namespace voxtouch::reference
