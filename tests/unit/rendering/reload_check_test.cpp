#include "core/rendering/reload_check.hpp"

#include <gtest/gtest.h>

#include "core/scene/scene_file.hpp"

namespace voxtouch::rendering {
namespace {

scene::Scene shipped() {
  return scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
}

std::string reload_error(const std::function<void(scene::Scene&)>& change) {
  scene::Scene next = shipped();
  change(next);
  return reload_refusal(shipped(), next);
}

effects::EffectSpec external(const std::string& topic) {
  const effects::EffectKind* kind = effects::find_effect_kind("external");
  effects::EffectSpec spec{.name = "external",
                           .kind = kind,
                           .values = effects::EffectValues(kind->parameters),
                           .region = {}};
  spec.values.at(1) = {1.0, 0.0, 0.0};
  spec.text = topic;
  return spec;
}

effects::EffectSpec oil(double damping, const std::string& name = "viscosity") {
  const effects::EffectKind* kind = effects::find_effect_kind("viscosity");
  effects::EffectSpec spec{
      .name = name, .kind = kind, .values = effects::EffectValues(kind->parameters), .region = {}};
  spec.values.at(0) = {damping, 0.0, 0.0};
  return spec;
}

TEST(ReloadCheck, TakesOtherMeshesVoxelsContactsEffectsAndMotions) {
  EXPECT_EQ(reload_error([](scene::Scene&) {}), "");
  EXPECT_EQ(reload_error([](scene::Scene& s) { s.voxel_size_m = 0.001; }), "");
  EXPECT_EQ(reload_error([](scene::Scene& s) { s.contact.stiffness_n_per_m = 7.0; }), "");
  EXPECT_EQ(reload_error([](scene::Scene& s) { s.static_meshes[0].scale = 2.0; }), "");
  EXPECT_EQ(reload_error([](scene::Scene& s) { s.motions.clear(); }), "");
  EXPECT_EQ(reload_error([](scene::Scene& s) { s.effects = {oil(1.0)}; }), "");
}

TEST(ReloadCheck, RefusesChangesOtherNodesWouldMiss) {
  const auto names = [](const std::string& why, const char* section) {
    return why.find(section) != std::string::npos;
  };
  EXPECT_TRUE(names(reload_error([](scene::Scene& s) { s.device.force_scale = 2.0; }), "'device'"));
  EXPECT_TRUE(names(reload_error([](scene::Scene& s) { s.device.clutch_button = 1; }), "'device'"));
  EXPECT_TRUE(names(reload_error([](scene::Scene& s) { s.device.pose_PT.position.z() = 0.1; }),
                    "'device'"));
  EXPECT_TRUE(
      names(reload_error([](scene::Scene& s) { s.design->gain_margin = 3.0; }), "'coupling'"));
  EXPECT_TRUE(names(reload_error([](scene::Scene& s) {
                      s.design->given_rotation = coupling::design::HandRange{};
                    }),
                    "'coupling'"));
  EXPECT_TRUE(names(reload_error([](scene::Scene& s) { s.design.reset(); }), "'coupling'"));
  EXPECT_TRUE(
      names(reload_error([](scene::Scene& s) { s.coupling.cutoff_hz = 3.0; }), "'coupling'"));
  EXPECT_TRUE(
      names(reload_error([](scene::Scene& s) { s.effects = {external("")}; }), "'external'"))
      << "none reads its topic";
}

TEST(ReloadCheck, RefusesANewWrenchTopicButTakesNewValues) {
  scene::Scene now = shipped(), next = now;
  now.effects = {external("/sim/wrench")}, next.effects = {external("/sim/wrench")};
  next.effects[0].values.at(1)[0] = 0.5;
  EXPECT_EQ(reload_refusal(now, next), "");
  next.effects[0].text = "/sim/other";
  EXPECT_NE(reload_refusal(now, next), "");
  next.effects.clear();
  EXPECT_NE(reload_refusal(now, next), "");
  const std::vector<effects::EffectSpec> before = {external("/a")}, elsewhere = {external("/b")};
  std::vector<effects::EffectSpec> changed = before;
  changed[0].gain = 0.5;
  EXPECT_EQ(carried_over(before, changed, elsewhere)[0].gain, 1.0)
      << "of another topic nothing is carried over";
}

TEST(CarriedOver, KeepsChangesUnlessTheFileChanged) {
  const std::vector<effects::EffectSpec> before = {oil(1.0), oil(2.0, "viscosity2")};
  std::vector<effects::EffectSpec> now = before, next = {oil(3.0), oil(2.0, "viscosity2"),
                                                         oil(4.0, "viscosity3")};
  now[0].on = false, now[0].values.at(0)[0] = 9.0;
  now[1].on = false, now[1].gain = 0.5;
  const std::vector<effects::EffectSpec> runs = carried_over(before, now, next);
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_TRUE(runs[0].on) << "the file says something new";
  EXPECT_EQ(runs[0].values.number(0), 3.0);
  EXPECT_FALSE(runs[1].on);
  EXPECT_EQ(runs[1].gain, 0.5);
  EXPECT_EQ(runs[2].values.number(0), 4.0);
  next[1].region.blend_m = 0.01;
  EXPECT_TRUE(carried_over(before, now, next)[1].on) << "another region is another effect";
}

}  // namespace
}  // namespace voxtouch::rendering
