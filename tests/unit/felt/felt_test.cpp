// What is told at the start against what contact and coupling give.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "core/felt/felt.hpp"
#include "core/fitting/design_problem.hpp"
#include "core/scene/scene_file.hpp"

namespace voxtouch::felt {
namespace {

coupling::design::DeviceModel stylus() {
  coupling::design::DeviceModel model;
  model.name = "stylus";
  model.translation = {.inertia_min = 0.1,
                       .inertia_max = 0.2,
                       .damping = 2.0,
                       .resolution = 3e-5,
                       .max_effort = 8.5,
                       .max_stiffness = 800.0};
  model.timing.delay_s = 1e-3;
  return model;
}

struct Scene {
  explicit Scene(const std::string& model,
                 scene::RenderingKind rendering = scene::RenderingKind::kPenalty,
                 const coupling::design::DeviceModel& device = stylus(),
                 double times_stiffness = 1.0)
      : Scene(with_contact(scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml"),
                           model, rendering, times_stiffness),
              device) {}
  explicit Scene(const scene::Scene& of, const coupling::design::DeviceModel& device = stylus())
      : scene(of) {
    const ParallelFor one_after_another = [](std::size_t count,
                                             const std::function<void(std::size_t)>& body) {
      for (std::size_t i = 0; i < count; ++i)
        body(i);
    };
    built = rendering::build_scene(scene, one_after_another);
    fitted = fitting::fit_coupling(
        scene, device, {built->plan().contact_n_per_m, built->plan().contact_nm_per_rad},
        fitting::demand_of(scene));
  }
  static scene::Scene with_contact(scene::Scene scene, const std::string& model,
                                   scene::RenderingKind rendering, double times_stiffness) {
    scene.contact.model = model, scene.contact.rendering = rendering,
    scene.contact.stiffness_n_per_m *= times_stiffness;
    return scene;
  }
  scene::Scene scene;
  std::unique_ptr<rendering::BuiltScene> built;
  fitting::FittedCoupling fitted;
};

Motion above() {
  Motion motion;
  motion.path = {Vec3(0, 0, 0.2)};
  return motion;
}

void expect_parts(const std::string& told, std::initializer_list<const char*> parts) {
  for (const char* part : parts)
    EXPECT_NE(told.find(part), std::string::npos) << part << " in " << told;
  EXPECT_EQ(told.find('\n'), std::string::npos);
}

/// Two ways to one figure: the spring's law, and the frames of a hand that presses. Where it
/// touches first is known to some 0.1 mm.
TEST(Press, FindsTheStiffnessThatAVirtualToolIsToldToHave) {
  for (const double scale : {1.0, 2.0}) {
    Scene s("field", scene::RenderingKind::kVirtualTool);
    ASSERT_EQ(s.fitted.refusal, "");
    s.scene.device.position_scale = scale;
    s.fitted = fitting::fit_coupling(
        s.scene, stylus(), {s.built->plan().contact_n_per_m, s.built->plan().contact_nm_per_rad},
        {});
    const double at_hand = fitting::stiffness_at_hand_n_per_m(
        s.fitted.spec, s.scene.device,
        fitting::spring_n_per_m(
            s.fitted, s.scene, stylus(),
            {s.built->plan().contact_n_per_m, s.built->plan().contact_nm_per_rad}));
    const std::vector<Pressed> pressed =
        press(*s.built, s.scene, s.fitted, stylus(), s.scene.motions.begin()->second);
    ASSERT_EQ(pressed.size(), 10U);
    for (const Pressed& p : pressed)
      EXPECT_NEAR(p.force_n, std::min(8.5, at_hand * p.depth_m),
                  0.2e-3 * at_hand + 0.02 * p.force_n)
          << p.depth_m;
    expect_parts(felt_sentence(s.fitted, s.scene, stylus(), *s.built),
                 {"felt: ", " N/m ", "What limits it: ", "More: ", " gives "});
  }
}

TEST(Press, OfEachModelIsWhatTheCouplingReturnsAtRest) {
  for (const char* model : {"original", "adapted", "field"}) {
    Scene s(model);
    ASSERT_EQ(s.fitted.refusal, "") << model;
    const std::vector<Pressed> pressed =
        press(*s.built, s.scene, s.fitted, stylus(), s.scene.motions.begin()->second);
    ASSERT_EQ(pressed.size(), 10U) << model;
    for (const Pressed& p : pressed) {
      EXPECT_GT(p.force_n, 0.0) << model;
      EXPECT_LE(p.force_n, s.fitted.design.translation.shown_stiffness * p.depth_m * 1.001)
          << model << ": no more than is certified";
    }
    EXPECT_EQ(pressed,
              press(*s.built, s.scene, s.fitted, stylus(), s.scene.motions.begin()->second))
        << "the same again";
    expect_parts(felt_sentence(s.fitted, s.scene, stylus(), *s.built),
                 {" N ", "10 mm deep", " 8.5 N ", "limits", "More: ",
                  model == std::string("field") ? "becomes unstable" : "only some way in"});
  }
}

/// Of each model: what comes back of the certified stiffness times the depth from the first touch.
/// It never falls while the hand goes in, and is all of it where the model tells the coupling its
/// depth and pushes enough: a ball is as stiff as is certified only some way in.
TEST(Press, RisesWithEveryDepthAndIsAllThatIsCertifiedWhereDepthCounts) {
  for (const auto& [model, times] : {std::pair{"original", 1.0},
                                     {"adapted", 1.0},
                                     {"adapted", 10.0},
                                     {"field", 1.0},
                                     {"field", 20.0},
                                     {"virtual_tool", 1.0}}) {
    const bool spring = model == std::string("virtual_tool");
    Scene s(spring ? "field" : model,
            spring ? scene::RenderingKind::kVirtualTool : scene::RenderingKind::kPenalty, stylus(),
            times);
    ASSERT_EQ(s.fitted.refusal, "") << model;
    const double certified = s.fitted.design.translation.shown_stiffness;
    double before = 0.0;
    std::string row;
    for (const Pressed& p :
         press(*s.built, s.scene, s.fitted, stylus(), s.scene.motions.begin()->second)) {
      const double share = p.force_n / (certified * p.depth_m);
      row += fmt::format(" {:.3f}", share);
      if (times > 1.0 &&
          p.depth_m < 0.0075) {  // the plane is 20 mm thick: in its middle no depth grows any more
        EXPECT_GE(share, 0.95) << model << " " << p.depth_m << " m deep";
      }
      EXPECT_GE(p.force_n, before * (1 - 1e-3)) << model << " falls " << p.depth_m << " m deep";
      before = p.force_n;
    }
    std::printf("%s, stiffness of the scene times %g, %.4g N/m certified: share at 1 to 10 mm%s\n",
                model, times, certified, row.c_str());
  }
}

/// The largest force comes some way in, and the sentence says where; nothing that gives no force
/// counts as giving more.
TEST(Press, OfAModelAloneFallsWhereItsPointsHaveGoneThroughAndTheSentenceSaysWhere) {
  for (const char* model : {"original", "adapted"}) {
    Scene alone(model, scene::RenderingKind::kModelAlone), held(model);
    ASSERT_EQ(alone.fitted.refusal, "") << model;
    const std::vector<Pressed> a = press(*alone.built, alone.scene, alone.fitted, stylus(),
                                         alone.scene.motions.begin()->second),
                               h = press(*held.built, held.scene, held.fitted, stylus(),
                                         held.scene.motions.begin()->second);
    ASSERT_EQ(a.size(), 10U) << model;
    double largest = 0.0;
    std::string row;
    for (const Pressed& p : a)
      largest = std::max(largest, p.force_n), row += fmt::format(" {:.3f}", p.force_n);
    std::printf("%s alone: N at 1 to 10 mm%s\n", model, row.c_str());
    EXPECT_LT(a.back().force_n, 0.5 * largest) << model;
    EXPECT_LT(a.back().force_n, 0.25 * h.back().force_n) << model;
    const std::string told = felt_sentence(alone.fitted, alone.scene, stylus(), *alone.built);
    expect_parts(told, {"10 mm deep", "; at most ", " mm deep.", "model alone",
                        "rendering: penalty", "More: "});
    EXPECT_EQ(told.find(" gives 0 N"), std::string::npos) << told;
  }
}

TEST(Press, OfWhatIsNotTouchedOrMustNotBeFeltSaysNothing) {
  Scene s("adapted");
  scene::Scene away = s.scene;
  away.motions = {{"above", above()}};
  EXPECT_EQ(felt_sentence(s.fitted, away, stylus(), *s.built), "");
  EXPECT_EQ(felt_sentence(s.fitted, s.scene, stylus(), *s.built, "nobody's"), "");
  coupling::design::DeviceModel light = stylus();
  light.translation.inertia_min = 0.0;
  Scene none("adapted", scene::RenderingKind::kPenalty, light);
  ASSERT_NE(none.fitted.refusal, "");
  EXPECT_EQ(felt_sentence(none.fitted, none.scene, light, *none.built), "");
  s.scene.motions.clear();
  EXPECT_EQ(felt_sentence(s.fitted, s.scene, stylus(), *s.built), "")
      << "nobody says where to press";
}

/// A body is pulled by the hand's grip alone, 200 N/m in the shipped scene; twice the scale at the
/// hand is twice the stiffness. A grip that the coupling caps is what the coupling shows.
TEST(Felt, OfABodyIsItsGrip) {
  Scene s(scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/block.yaml"));
  ASSERT_EQ(s.fitted.refusal, "");
  expect_parts(felt_sentence(s.fitted, s.scene, stylus(), *s.built),
               {"200 N/m", " 2 N ", " 10 mm ", "24 %", "8.5 N", "grip_n_per_m"});
  EXPECT_EQ(felt_sentence(s.fitted, s.scene, stylus(), *s.built),
            felt_sentence(s.fitted, s.scene, stylus(), *s.built, s.scene.motions.begin()->first));
  s.fitted.spec.stiffness_cap_n_per_m = 50.0;
  expect_parts(felt_sentence(s.fitted, s.scene, stylus(), *s.built), {"50 N/m", " 0.5 N "});
  s.fitted.refusal = "none holds";
  EXPECT_EQ(felt_sentence(s.fitted, s.scene, stylus(), *s.built), "");
}

/// The force depends on where the hand presses, so the motion is named; the one that is asked for,
/// where one is.
TEST(Felt, OfForcesOfDepthNamesTheMotionTheDeepestAndTheLargestForce) {
  Scene s(scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/cup_field.yaml"));
  expect_parts(felt_sentence(s.fitted, s.scene, stylus(), *s.built),
               {"10 mm deep where the motion 'circle' touches first", "; at most ", " 4 mm deep",
                "only some way in"});
  expect_parts(felt_sentence(s.fitted, s.scene, stylus(), *s.built, "slide"),
               {"10 mm deep where the motion 'slide' touches first"});
}

}  // namespace
}  // namespace voxtouch::felt
