#include "tests/unit/scene/scene_fixture.hpp"

namespace voxtouch::scene {
namespace {

using EffectsSection = SceneFolder;

TEST_F(EffectsSection, EveryKeyReachesItsField) {
  const Scene s = parse(kSmall +
                        "effects:\n"
                        "  - {viscosity: {damping_ns_per_m: 1.5, damping_nms_per_rad: 0.02}, name: "
                        "oil, gain: 0.5, on: false,\n"
                        "     region: {box: {size: [0.1, 0.2, 0.3], position: [1, 2, 3], "
                        "orientation: [0, 1, 0, 0]}, blend_m: 0.004}}\n"
                        "  - {viscosity: {damping_ns_per_m: 2}, region: {sphere: {centre: [4, 5, "
                        "6], radius: 0.1}}}\n");
  ASSERT_EQ(s.effects.size(), 2u);
  const effects::EffectSpec& oil = s.effects[0];
  EXPECT_EQ(oil.name, "oil");
  EXPECT_EQ(oil.kind, effects::find_effect_kind("viscosity"));
  EXPECT_EQ(oil.values.number(0), 1.5);
  EXPECT_EQ(oil.values.number(1), 0.02);
  EXPECT_EQ(oil.gain, 0.5);
  EXPECT_FALSE(oil.on);
  EXPECT_EQ(oil.region.blend_m, 0.004);
  const auto& box = std::get<effects::BoxRegion>(oil.region.shape);
  EXPECT_EQ(box.size_m, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(box.pose.position, Vec3(1, 2, 3));
  EXPECT_EQ(box.pose.orientation.x(), 1.0);
  const effects::EffectSpec& other = s.effects[1];
  EXPECT_EQ(other.name, "viscosity");
  EXPECT_EQ(other.values.number(1), 0.0);
  EXPECT_EQ(other.gain, 1.0);
  EXPECT_TRUE(other.on);
  EXPECT_EQ(std::get<effects::SphereRegion>(other.region.shape).centre, Vec3(4, 5, 6));
  EXPECT_EQ(std::get<effects::SphereRegion>(other.region.shape).radius_m, 0.1);
}

TEST_F(EffectsSection, ASceneWithoutEffectsHasNone) {
  EXPECT_TRUE(parse(kSmall).effects.empty());
  EXPECT_TRUE(parse(kSmall + "effects: []\n").effects.empty());
}

}  // namespace
}  // namespace voxtouch::scene
