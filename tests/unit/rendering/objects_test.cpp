// Several static objects, each with its own material, some of them moving; and the body among them.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/reference/reference_scene.hpp"
#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"
#include "core/scene/text_file.hpp"

namespace voxtouch::rendering {
namespace {

const std::string kDeploy = VOXTOUCH_DEPLOY;

/// A scene on the shipped meshes.
scene::Scene scene_of(const std::string& statics, const std::string& effects = "[]") {
  return scene::parse_scene("scene: objects\nvoxel_size: 0.002\nstatic:\n" + statics +
                                "dynamic: {mesh: sphere.obj, scale: 0.01}\ncontact: {model: "
                                "adapted, stiffness_n_per_m: 30}\n"
                                "effects: " +
                                effects + "\n",
                            kDeploy + "/meshes/test.yaml");
}
std::string refusal(const std::string& statics, const std::string& effects = "[]") {
  try {
    scene_of(statics, effects);
  } catch (const scene::SceneError& error) {
    return error.what();
  }
  return {};
}
ToolState at(const Vec3& x) {
  ToolState tool;
  tool.pose.position = x;
  return tool;
}
constexpr const char* kTwo =
    "  - {mesh: plane.obj}\n"
    "  - {mesh: plane.obj, position: [0.5, 0, 0], object: {name: soft, stiffness_n_per_m: 10}}\n";

TEST(Objects, EachPushesWithItsOwnStiffness) {
  const auto built = build_scene(scene_of(kTwo), serial_for());
  ASSERT_EQ(built->contacts().size(), 2u);
  const Vec3 hard = built->scene_renderer().render(at({0.003, 0.002, 0.009}), 0.0).wrench.force;
  built->scene_renderer().reset();
  const Vec3 soft = built->scene_renderer().render(at({0.503, 0.002, 0.009}), 0.0).wrench.force;
  ASSERT_GT(soft.z(), 0.0);
  EXPECT_NEAR(hard.z() / soft.z(), 3.0, 0.5);
}

/// All results of the contact, as numbers that are equal only for equal grids.
std::vector<double> sampled_forces(BuiltScene& built) {
  std::vector<double> all{static_cast<double>(built.plan().surface_voxels),
                          static_cast<double>(built.plan().interior_voxels)};
  for (int n = 0; n < 200; ++n) {
    const Vec3 force = built.renderer()
                           .probe({Vec3(-0.05 + 5e-4 * n, 1e-4 * n, 0.0085), Quat::Identity()})
                           .wrench.force;
    all.insert(all.end(), force.data(), force.data() + 3);
  }
  return all;
}

TEST(Objects, LieClearOfGridBordersByDefault) {
  const auto chosen = build_scene(scene_of("  - {mesh: plane.obj}\n"), serial_for());
  const voxmap::Grid& grid = chosen->contacts().object(0).voxmap.grid();
  EXPECT_NEAR((grid.origin - Vec3(-0.123, -0.123, -0.023)).norm(), 0.0, 1e-12);
  // 240 x 240 x 20 mm at e = 2 mm: faces in the middles of 121, 121 and 11 voxels, and no voxel
  // beyond.
  EXPECT_EQ(chosen->plan().interior_voxels, 119U * 119U * 9U);
  EXPECT_EQ(chosen->plan().surface_voxels, 121U * 121U * 11U - 119U * 119U * 9U);

  const auto given = build_scene(
      scene_of("  - {mesh: plane.obj, origin: [-0.122, -0.122, -0.022]}\n"), serial_for());
  EXPECT_EQ(given->contacts().object(0).voxmap.grid().origin, Vec3(-0.122, -0.122, -0.022));
  const auto again = build_scene(
      scene_of("  - {mesh: plane.obj, origin: [-0.123, -0.123, -0.023]}\n"), serial_for());
  ASSERT_EQ(grid.origin, Vec3(-0.123, -0.123, -0.023)) << "what the plan says, read back";
  EXPECT_EQ(sampled_forces(*chosen), sampled_forces(*again));
  EXPECT_NE(sampled_forces(*chosen), sampled_forces(*given));
}

TEST(Objects, HaveTheGridThatTheSceneGivesEachOfThem) {
  const auto built =
      build_scene(scene_of("  - {mesh: plane.obj, origin: [-0.2, -0.2, -0.1]}\n"
                           "  - {mesh: plane.obj, position: [0.5, 0, 0], object: {name: soft}}\n"
                           "  - {mesh: plane.obj, position: [0.5, 0, 0.1], object: soft, origin: "
                           "[0.3, -0.3, -0.2]}\n"
                           "  - {mesh: plane.obj, position: [1, 0, 0], object: {name: free}}\n"),
                  serial_for());
  EXPECT_EQ(built->contacts().object(0).voxmap.grid().origin, Vec3(-0.2, -0.2, -0.1));
  EXPECT_EQ(built->contacts().object(1).voxmap.grid().origin, Vec3(0.3, -0.3, -0.2));
  EXPECT_NEAR(
      (built->contacts().object(2).voxmap.grid().origin - Vec3(0.877, -0.123, -0.023)).norm(), 0.0,
      1e-12);
}

TEST(Objects, SeparateOnesSumToOneVoxmap) {
  const std::string wall =
      "  - {mesh: plane.obj, position: [0.13, 0, 0.12], orientation: [0.7071067811865476, 0, "
      "-0.7071067811865476, 0]";
  const auto one = build_scene(scene_of("  - {mesh: plane.obj}\n" + wall + "}\n"), serial_for());
  const auto two = build_scene(
      scene_of("  - {mesh: plane.obj}\n" + wall + ", object: {name: wall}}\n"), serial_for());
  const Pose floor{Vec3(0.003, 0.002, 0.009), Quat::Identity()},
      off_both{Vec3(0.122, 0.002, 0.05), Quat::Identity()},
      corner{Vec3(0.122, 0.002, 0.009), Quat::Identity()};
  std::vector<std::uint32_t> ids;
  EXPECT_LT((one->contacts().probe(floor, ids).wrench.force -
             two->contacts().probe(floor, ids).wrench.force)
                .norm(),
            0.05);
  const contact::ContactResult sum = two->contacts().probe(corner, ids),
                               a = two->contacts().object(0).renderer->probe(corner),
                               b = two->contacts().object(1).renderer->probe(corner);
  ASSERT_GT(a.wrench.force.norm(), 0.0);
  ASSERT_GT(b.wrench.force.norm(), 0.0);
  EXPECT_EQ(sum.wrench.force, Vec3(a.wrench.force + b.wrench.force));
  EXPECT_EQ(sum.wrench.torque, Vec3(a.wrench.torque + b.wrench.torque));
  EXPECT_EQ(sum.surface_hits, a.surface_hits + b.surface_hits);
  EXPECT_EQ(sum.stiffness, Mat6(a.stiffness + b.stiffness));
  EXPECT_EQ(sum.stiffness_bound_n_per_m, a.stiffness_bound_n_per_m + b.stiffness_bound_n_per_m);
  EXPECT_EQ(sum.deepest_depth_m, std::max(a.deepest_depth_m, b.deepest_depth_m));
  EXPECT_GT(two->contacts().probe(off_both, ids).wrench.force.norm(), 0.0);
}

TEST(Objects, MovingOneIsTouchedInPlaceAndReportsWork) {
  const auto built =
      build_scene(scene_of("  - mesh: plane.obj\n    object: {name: lift, moves: {path: [[0, 0, "
                           "0], [0, 0, 0.1]], speed_m_per_s: 0.1}}\n"),
                  serial_for());
  const Motion motion = scene_of(
                            "  - mesh: plane.obj\n    object: {name: lift, moves: {path: [[0, 0, "
                            "0], [0, 0, 0.1]], speed_m_per_s: 0.1}}\n")
                            .objects[0]
                            .moves.value();
  const auto still = build_scene(scene_of("  - {mesh: plane.obj}\n"), serial_for());
  double work = 0.0, last_supplied = 0.0;
  for (int n = 0; n < 1500; ++n) {
    const double t = 1e-3 * n;
    const MotionPoint lift = motion_at(motion, t);
    const Vec3 on_it = lift.position + Vec3(0.003, 0.002, 0.009);
    const SceneFrame frame = built->scene_renderer().render(at(on_it), t);
    const SceneFrame same = still->scene_renderer().render(at({0.003, 0.002, 0.009}), t);
    EXPECT_LT((frame.wrench.force - same.wrench.force).norm(), 1e-9) << t;
    EXPECT_NEAR(
        (frame.touch.contact.deepest_point - same.touch.contact.deepest_point - lift.position)
            .norm(),
        0.0, 1e-12);
    work += 1e-3 * frame.wrench.force.dot(lift.velocity);
    last_supplied = frame.supplied_energy_j;
  }
  EXPECT_GT(work, 0.005);
  EXPECT_NEAR(last_supplied, work, 1e-9);
}

TEST(Objects, TheReferenceMovesThemToo) {
  const scene::Scene scene = scene_of(
      "  - mesh: plane.obj\n    object: {name: lift, moves: {path: [[0, 0, 0], [0, 0, 0.1]], "
      "speed_m_per_s: 0.1}}\n");
  reference::ReferenceScene reference(scene);
  const Pose tool{Vec3(0, 0, 0.15), Quat::Identity()};
  EXPECT_NEAR(reference.gap(tool).gap_m, 0.14, 1e-3);
  reference.move_to(1000.0);
  EXPECT_NEAR(reference.gap(tool).gap_m, 0.04, 1e-3);
}

TEST(Objects, AnEffectMayBeOfOneOfThemAlone) {
  const auto built =
      build_scene(scene_of(kTwo, "[{friction: {coulomb: 0.5}, object: soft}]"), serial_for());
  const auto slide = [&](double x) {
    built->scene_renderer().reset();
    double across = 0.0;
    for (int n = 0; n < 100; ++n)
      across = built->scene_renderer()
                   .render(at({x + 1e-4 * n, 0.002, 0.009}), 1e-3 * n)
                   .effects.wrench.force.norm();
    return across;
  };
  EXPECT_EQ(slide(0.003), 0.0);
  EXPECT_GT(slide(0.503), 0.01);
}

TEST(Objects, AreRefusedWithAPlaceAndASentence) {
  const auto says = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  const std::string unknown = refusal("  - {mesh: plane.obj, object: lid}\n");
  EXPECT_TRUE(says(unknown, ":4:") && says(unknown, "'lid'")) << unknown;
  const std::string twice = refusal(
      "  - {mesh: plane.obj, object: {name: a}}\n  - {mesh: plane.obj, object: {name: a}}\n");
  EXPECT_TRUE(says(twice, ":5:") && says(twice, "'a'")) << twice;
  EXPECT_TRUE(says(refusal("  - {mesh: plane.obj, object: {name: a, stiffness_n_per_m3: 1}}\n"),
                   "different unit"));
  EXPECT_TRUE(says(refusal("  - {mesh: plane.obj, object: {name: a, colour: red}}\n"), "colour"));
  EXPECT_TRUE(says(refusal("  - {mesh: plane.obj, origin: [0, 0, 0], object: {name: a}}\n  - "
                           "{mesh: plane.obj, object: a, origin: [0, 0, 0]}\n"),
                   "'origin'"));
  EXPECT_TRUE(
      says(refusal("  - {mesh: plane.obj}\n", "[{friction: {coulomb: 1}, object: lid}]"), "lid"));
  EXPECT_TRUE(says(
      refusal("  - {mesh: plane.obj}\n", "[{viscosity: {damping_ns_per_m: 1}, object: ground}]"),
      "'viscosity'"));
  EXPECT_TRUE(
      says(refusal("  - {mesh: plane.obj}\n", "[{body: {mass_kg: 1}, gain: 0.5}]"), "'gain'"));
  EXPECT_TRUE(says(
      refusal("  - {mesh: plane.obj}\n", "[{body: {mass_kg: 1}}, {body: {mass_kg: 2}, name: b}]"),
      "'body'"))
      << "two gravities";
  std::string many = "  - {mesh: plane.obj}\n";
  for (int n = 0; n < 16; ++n)
    many += "  - {mesh: plane.obj, object: {name: o" + std::to_string(n) + "}}\n";
  EXPECT_TRUE(says(refusal(many), "limit 16"));
}

constexpr double kSixthM2 = (2 * 0.0016 + 4 * 0.0012) / 6.0;  ///< of the block's surface

TEST(BodyScene, RestsLessThanATenthOfAMillimetreDeepAtAnyMass) {
  for (const double mass_kg : {0.01, 0.08, 0.256, 2.0}) {
    scene::Scene scene = scene::load_scene(kDeploy + "/scenes/block.yaml");
    std::string text = scene::read_text_file(scene.file, "scene");
    const std::string given = "mass_kg: 0.08";
    text.replace(text.find(given), given.size(), "mass_kg: " + std::to_string(mass_kg));
    scene = scene::parse_scene(text, scene.file);
    const auto built = build_scene(scene, serial_for());
    SceneFrame frame;
    for (int n = 0; n < 1500; ++n)
      frame = built->scene_renderer().render(at({0.003, 0, 0.016}), 1e-3 * n);
    const double depth = 0.015 - frame.object.position.z();
    EXPECT_NEAR(depth, 1e-4 * kSixthM2 / 0.0016, 8e-6) << mass_kg;  // points of edges weigh as well
    EXPECT_LT(frame.object.orientation.angularDistance(Quat::Identity()), 1e-6) << mass_kg;
  }
}

TEST(BodyScene, FallsOnTheTableAndOnlyItsGripPushes) {
  scene::Scene scene = scene::load_scene(kDeploy + "/scenes/block.yaml");
  const auto built = build_scene(scene, serial_for());
  EXPECT_EQ(built->plan().contact_n_per_m.all_points, 200.0)
      << "the device meets the grip, not the table";
  ToolState tool = at({0, 0, 0.05});
  tool.buttons = 1;
  SceneFrame frame;
  for (int n = 0; n < 2000; ++n)
    frame = built->scene_renderer().render(tool, 1e-3 * n);
  EXPECT_NEAR(frame.wrench.force.z(), -0.08 * 9.81, 1e-3);
  EXPECT_NEAR(frame.stiffness_bound_n_per_m, 200.0, 1e-9);
  const double held = frame.object.position.z();
  tool.buttons = 0;
  for (int n = 2000; n < 3000; ++n)
    frame = built->scene_renderer().render(tool, 1e-3 * n);
  EXPECT_TRUE(frame.wrench.zero());
  EXPECT_EQ(frame.stiffness_bound_n_per_m, 0.0);
  EXPECT_LT(frame.object.position.z(), held - 0.02);
  EXPECT_NEAR(frame.object.position.z(), 0.015 - 1e-4 * kSixthM2 / 0.0016, 1e-5)
      << "a cube would rest 0.1 mm deep";
  EXPECT_NEAR(frame.touch.contact.wrench.force.z(), 0.08 * 9.81, 0.01);
}

TEST(Objects, AreBuiltWithAWordForEachMesh) {
  std::vector<std::string> steps;
  build_scene(scene_of("  - {mesh: plane.obj}\n  - {mesh: plane.obj}\n  - {mesh: plane.obj}\n"),
              serial_for(), {}, [&](const std::string& step) { steps.push_back(step); });
  for (const char* step :
       {"reading the static meshes", "reading mesh 2 of 3", "reading mesh 3 of 3"})
    EXPECT_EQ(std::count(steps.begin(), steps.end(), step), 1) << step;
}

TEST(BodyScene, NeedsAToolThatEnclosesAVolume) {
  scene::Scene scene = scene::load_scene(kDeploy + "/scenes/block.yaml");
  const std::string path = ::testing::TempDir() + "voxtouch_flat_body.obj";
  std::FILE* file = std::fopen(path.c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs("v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n", file);
  std::fclose(file);
  scene.dynamic_mesh.path = path;
  try {
    build_scene(scene, serial_for());
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("volume"), std::string::npos) << error.what();
  }
  std::remove(path.c_str());
}

}  // namespace
}  // namespace voxtouch::rendering
