// What a scene with the effect `proximity` builds, and that others do not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/rendering/build.hpp"
#include "tests/unit/scene/scene_fixture.hpp"

namespace voxtouch::effects {
namespace {

bool any_has(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& s) { return s.find(text) != std::string::npos; });
}

/// A box from 0 to `size`; `faces` of its twelve triangles.
std::string box_obj(double size, std::size_t faces = 12) {
  std::string text;
  for (int n = 0; n < 8; ++n)
    text += "v " + std::to_string(n & 1 ? size : 0.0) + " " + std::to_string(n & 2 ? size : 0.0) +
            " " + std::to_string(n & 4 ? size : 0.0) + "\n";
  const char* const all[] = {"1 3 2", "2 3 4", "5 6 7", "6 8 7", "1 2 5", "2 6 5",
                             "3 7 4", "4 7 8", "1 5 3", "3 5 7", "2 4 6", "4 8 6"};
  for (std::size_t n = 0; n < faces; ++n)
    text += "f " + std::string(all[n]) + "\n";
  return text;
}

class ProximityScene : public scene::SceneFolder {
 protected:
  void SetUp() override {
    scene::SceneFolder::SetUp();
    write("tool.obj", box_obj(0.01));
    write("block.obj", box_obj(0.06));
    write("open.obj", box_obj(0.06, 11));
  }
  std::unique_ptr<rendering::BuiltScene> built(
      const std::string& effects, const std::string& meshes = "{mesh: block.obj}",
      const std::string& contact = "stiffness_n_per_m: 30") const {
    return rendering::build_scene(parse("scene: s\nvoxel_size: 0.002\nstatic: [" + meshes +
                                        "]\ndynamic: {mesh: tool.obj}\ncontact: {" + contact +
                                        "}\neffects: [" + effects + "]\n"),
                                  serial_for());
  }
  std::string refusal(const std::string& effects, const std::string& meshes) const {
    try {
      built(effects, meshes);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no exception";
  }
  static constexpr const char* kProximity =
      "{proximity: {limit_n: 3, range_m: 0.01, smoothing_m: 0.003}}";
  static constexpr const char* kMagnet =
      "{magnet: {point: [0, 0, 0.1], radius_m: 0.02, force_n: 1}}";
};

TEST_F(ProximityScene, BuildsDistancesOnlyIfAnEffectNeedsThem) {
  const auto with = built(kProximity), magnet = built(kMagnet), none = built("");
  ASSERT_TRUE(with->effect_ground().proximity.has_value());
  for (const rendering::BuiltScene* scene : {magnet.get(), none.get()}) {
    EXPECT_FALSE(scene->effect_ground().proximity.has_value());
    EXPECT_TRUE(scene->effect_ground().tool.points.empty());
    EXPECT_FALSE(any_has(scene->plan().built, "Distances round"));
    EXPECT_TRUE(any_has(scene->plan().skipped, "Distances outside"));
  }
  EXPECT_EQ(magnet->plan().bytes, none->plan().bytes);
  EXPECT_GT(magnet->plan().expected_ns_per_frame, none->plan().expected_ns_per_frame);
  const rendering::EffectGround& ground = with->effect_ground();
  EXPECT_EQ(with->plan().bytes - none->plan().bytes,
            ground.proximity->bytes() + ground.tool.points.size() * sizeof(ToolPoint));
  EXPECT_EQ(ground.tool.points.size(), rendering::ToolPoints::kMaxPoints);
  EXPECT_GT(with->plan().expected_ns_per_frame,
            2.0 * magnet->plan().expected_ns_per_frame - none->plan().expected_ns_per_frame)
      << "128 points, not one";
  for (const char* figure : {"up to 10 mm", "over 4 mm", "128 points", "25.6 us"})
    EXPECT_TRUE(any_has(with->plan().built, figure)) << figure;
  EXPECT_FALSE(any_has(with->plan().skipped, "Distances outside"));
  EXPECT_EQ(with->field(), nullptr) << "the contact model asks for none";
}

TEST_F(ProximityScene, TheModelFieldKeepsAFieldOfItsOwn) {
  const char* const kField = "model: field, stiffness_n_per_m3: 1.0e7";
  const auto with = built(kProximity, "{mesh: block.obj}", kField),
             without = built("", "{mesh: block.obj}", kField);
  ASSERT_NE(with->field(), nullptr);
  EXPECT_EQ(with->field()->bytes(), without->field()->bytes());
}

TEST_F(ProximityScene, PushesBeforeTouchWithinThePlannedBound) {
  const auto scene = built(kProximity), none = built("");
  rendering::ToolState tool;
  tool.pose = {Vec3(0.025, 0.025, 0.064), Quat::Identity()};
  const rendering::SceneFrame frame = scene->scene_renderer().render(tool, 0.0),
                              bare = none->scene_renderer().render(tool, 0.0);
  EXPECT_TRUE(bare.wrench.zero());
  EXPECT_TRUE(frame.touch.contact.wrench.zero());
  EXPECT_GT(frame.wrench.force.z(), 0.2);
  EXPECT_TRUE(frame.wrench.torque.isZero(0.0));
  EXPECT_GT(frame.stiffness(2, 2), 10.0);
  EXPECT_LE(frame.stiffness_bound_n_per_m, scene->plan().contact_n_per_m.all_points);
  EXPECT_NEAR(scene->plan().contact_n_per_m.all_points - none->plan().contact_n_per_m.all_points,
              3 * 1.5 * 3 / 0.01 + 6 * 3 / 0.003, 1e-6);
  tool.pose.position.z() = 0.0706;  // no edge is near
  EXPECT_TRUE(scene->scene_renderer().render(tool, 0.001).wrench.zero());
}

TEST_F(ProximityScene, RefusesOpenMeshesAndShortLevers) {
  EXPECT_NE(refusal(kProximity, "{mesh: open.obj}").find("closed"), std::string::npos);
  const auto both = built(kProximity, "{mesh: block.obj}, {mesh: open.obj, position: [0, 0, 0.2]}");
  EXPECT_TRUE(any_has(both->plan().warnings, "open.obj: "));
  EXPECT_NE(refusal("{proximity: {limit_n: 3, range_m: 0.01, lever_m: 0.01}}", "{mesh: block.obj}")
                .find("minimum 0.01"),
            std::string::npos);
  EXPECT_EQ(
      refusal("{proximity: {limit_n: 3, range_m: 0.01, lever_m: 0.018}}", "{mesh: block.obj}"),
      "no exception");
}

}  // namespace
}  // namespace voxtouch::effects
