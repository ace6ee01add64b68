/// Equivalent scenes give equal forces: another unit in the file, another size, another place.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"
#include "core/types/motion.hpp"

namespace voxtouch::test {
namespace {

scene::Scene shipped(const std::string& name) {
  return scene::load_scene(std::filesystem::path(VOXTOUCH_DEPLOY) / "scenes" / (name + ".yaml"));
}

/// Tool poses of a scene's motions, every 20 ms for 10 s.
std::vector<Pose> poses_of(const scene::Scene& scene) {
  std::vector<Pose> poses;
  for (const auto& [name, motion] : scene.motions)
    for (int n = 0; n < 500; ++n)
      poses.push_back({motion_at(motion, 0.02 * n).position, motion.orientation});
  return poses;
}

std::vector<contact::ContactResult> probed(const scene::Scene& scene,
                                           const std::vector<Pose>& poses) {
  const auto built = rendering::build_scene(scene, serial_for());
  std::vector<contact::ContactResult> results;
  for (const Pose& pose : poses)
    results.push_back(built->renderer().probe(pose));
  return results;
}

constexpr double kStiffness = 30.0;  // of the shipped scenes, N/m

struct Difference {
  std::size_t contacts = 0;
  std::size_t other_hits = 0;  ///< poses with other counts of surface or interior hits
  double ratio_m =
      0.0;  ///< largest |difference of forces| / (N K), N the surface hits, over the others
  double torque_ratio_m2 = 0.0;
};

/// `b` compared with `a`, after `b`'s forces and torques are divided by their expected ratio.
Difference difference(const std::vector<contact::ContactResult>& a,
                      const std::vector<contact::ContactResult>& b, double forces_larger = 1.0,
                      double torques_larger = 1.0) {
  Difference out;
  for (std::size_t n = 0; n < a.size(); ++n) {
    out.contacts += a[n].surface_hits > 0;
    if (a[n].surface_hits != b[n].surface_hits || a[n].interior_hits != b[n].interior_hits) {
      ++out.other_hits;
      continue;
    }
    const double all = std::max(1U, a[n].surface_hits) * kStiffness;
    const Vec3 force = a[n].wrench.force - b[n].wrench.force / forces_larger;
    const Vec3 torque = a[n].wrench.torque - b[n].wrench.torque / torques_larger;
    out.ratio_m = std::max(out.ratio_m, force.norm() / all);
    out.torque_ratio_m2 = std::max(out.torque_ratio_m2, torque.norm() / all);
  }
  std::printf(
      "%zu poses, %zu in contact, %zu with other hits; force / (N K) off by %.2g m, torque by %.2g "
      "m^2\n",
      a.size(), out.contacts, out.other_hits, out.ratio_m, out.torque_ratio_m2);
  return out;
}

TEST(SceneInMillimetres, GivesTheForcesOfTheSceneInMetres) {
  const scene::Scene metres = shipped("cup"), millimetres = shipped("cup_mm");
  ASSERT_EQ(metres.contact.stiffness_n_per_m, kStiffness);
  const std::vector<Pose> poses = poses_of(metres);
  const Difference off = difference(probed(metres, poses), probed(millimetres, poses));
  EXPECT_GT(off.contacts, poses.size() / 4);
  EXPECT_EQ(off.other_hits, 0U);
  const double spacing =
      0x1p-20 * 1e-3;  // of single precision at the sphere's 10 mm, in the STL file
  EXPECT_LE(off.ratio_m, spacing);
  EXPECT_LE(off.torque_ratio_m2, spacing * 0.01);
}

TEST(SceneTenTimesAsLarge, GivesTenTimesTheForces) {
  const scene::Scene cup = shipped("cup"), large = shipped("cup_metre");
  ASSERT_EQ(large.contact.stiffness_n_per_m, kStiffness);
  std::vector<Pose> poses = poses_of(cup), far = poses;
  for (Pose& pose : far)
    pose.position *= 10.0;
  const Difference off = difference(probed(cup, poses), probed(large, far), 10.0, 100.0);
  EXPECT_EQ(off.other_hits, 0U);
  EXPECT_LE(off.ratio_m, 1e-15);  // rounding of numbers near 0.1
  EXPECT_LE(off.torque_ratio_m2, 1e-17);
}

class SceneFarAway : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(ShippedScenes, SceneFarAway,
                         testing::Values("cup", "cup_mm", "cup_metre", "cylinder", "plane",
                                         "tilted_plane"),
                         [](const auto& test) { return test.param; });

TEST_P(SceneFarAway, GivesTheSameForcesToAFewUnitsInTheLastPlace) {
  const Vec3 away(1e6, -1e6, 1e6);
  const scene::Scene here = shipped(GetParam());
  scene::Scene there = here;
  for (scene::MeshSpec& mesh : there.static_meshes)
    mesh.pose.position += away;
  std::vector<Pose> poses = poses_of(here);
  for (Pose& pose : poses)
    pose.position.z() += 1e-5;  // the plane's `hit` rests with the sphere's pole on a voxel border,
                                // where rounding decides
  std::vector<Pose> far = poses;
  for (Pose& pose : far)
    pose.position += away;
  const Difference off = difference(probed(here, poses), probed(there, far));
  EXPECT_GT(off.contacts, poses.size() / 4);
  EXPECT_EQ(off.other_hits, 0U);
  const double spacing = 0x1p-33;  // of double precision at 1e6 m
  EXPECT_LE(off.ratio_m, 4 * spacing);
  EXPECT_LE(off.torque_ratio_m2, 4 * spacing * (GetParam() == "cup_metre" ? 0.1 : 0.01));
}

}  // namespace
}  // namespace voxtouch::test
