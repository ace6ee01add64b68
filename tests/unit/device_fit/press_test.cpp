// A slow press compared with the forces of contact and coupling.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "core/device_fit/design_problem.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/design_text/design_text.hpp"
#include "tests/support/press/press.hpp"

namespace voxtouch::test {

using design_text::sentence_of;
namespace press_test {

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
    fitted = device_fit::fit_coupling(
        scene, device, {built->plan().contact_n_per_m, built->plan().contact_nm_per_rad},
        device_fit::demand_of(scene));
  }
  static scene::Scene with_contact(scene::Scene scene, const std::string& model,
                                   scene::RenderingKind rendering, double times_stiffness) {
    scene.contact.model = model, scene.contact.rendering = rendering,
    scene.contact.stiffness_n_per_m *= times_stiffness;
    return scene;
  }
  scene::Scene scene;
  std::unique_ptr<rendering::BuiltScene> built;
  device_fit::FittedCoupling fitted;
};

/// Two methods for one figure: the spring's law, and the frames of a pressing hand. The first touch
/// is known to about 0.1 mm.
TEST(Press, FindsTheConfiguredVirtualToolStiffness) {
  for (const double scale : {1.0, 2.0}) {
    Scene s("field", scene::RenderingKind::kVirtualTool);
    ASSERT_EQ(sentence_of(s.fitted.refusal), "");
    s.scene.device.position_scale = scale;
    s.fitted = device_fit::fit_coupling(
        s.scene, stylus(), {s.built->plan().contact_n_per_m, s.built->plan().contact_nm_per_rad},
        {});
    const double at_hand = device_fit::stiffness_at_hand_n_per_m(
        s.fitted.spec, s.scene.device,
        device_fit::spring_n_per_m(
            s.fitted, s.scene, stylus(),
            {s.built->plan().contact_n_per_m, s.built->plan().contact_nm_per_rad}));
    const std::vector<Pressed> pressed =
        press(*s.built, s.scene, s.fitted, stylus(), s.scene.motions.begin()->second);
    ASSERT_EQ(pressed.size(), 10U);
    for (const Pressed& p : pressed)
      EXPECT_NEAR(p.force_n, std::min(8.5, at_hand * p.depth_m),
                  0.2e-3 * at_hand + 0.02 * p.force_n)
          << p.depth_m;
  }
}

TEST(Press, EqualsTheCouplingAtRestForEachModel) {
  for (const char* model : {"original", "adapted", "field"}) {
    Scene s(model);
    ASSERT_EQ(sentence_of(s.fitted.refusal), "") << model;
    const std::vector<Pressed> pressed =
        press(*s.built, s.scene, s.fitted, stylus(), s.scene.motions.begin()->second);
    ASSERT_EQ(pressed.size(), 10U) << model;
    for (const Pressed& p : pressed) {
      EXPECT_GT(p.force_n, 0.0) << model;
      EXPECT_LE(p.force_n, s.fitted.design.translation.displayed_stiffness * p.depth_m * 1.001)
          << model << ": no more than is certified";
    }
    EXPECT_EQ(pressed,
              press(*s.built, s.scene, s.fitted, stylus(), s.scene.motions.begin()->second))
        << "the same again";
  }
}

/// For each model: the force divided by the certified stiffness times the depth from the first
/// touch. It never falls while the hand moves in, and never exceeds 1: a contact of K behind a
/// spring of K_c displays K K_c/(K + K_c). Deep in a stiff contact it is close to 1.
TEST(Press, RisesWithEveryDepthAndNeverExceedsTheCertified) {
  for (const auto& [model, times] : {std::pair{"original", 1.0},
                                     {"adapted", 1.0},
                                     {"adapted", 10.0},
                                     {"adapted", 100.0},
                                     {"field", 1.0},
                                     {"field", 20.0},
                                     {"field", 200.0},
                                     {"virtual_tool", 1.0}}) {
    const bool spring = model == std::string("virtual_tool");
    Scene s(spring ? "field" : model,
            spring ? scene::RenderingKind::kVirtualTool : scene::RenderingKind::kPenalty, stylus(),
            times);
    ASSERT_EQ(sentence_of(s.fitted.refusal), "") << model;
    const double certified = s.fitted.design.translation.displayed_stiffness;
    double before = 0.0;
    std::string row;
    for (const Pressed& p :
         press(*s.built, s.scene, s.fitted, stylus(), s.scene.motions.begin()->second)) {
      const double fraction = p.force_n / (certified * p.depth_m);
      row += fmt::format(" {:.3f}", fraction);
      if (times > 1.0 && p.depth_m > 0.0045) {
        EXPECT_GE(fraction, 0.8) << model << " " << p.depth_m << " m deep";
      }
      // The virtual tool's depth counts from the first touch of its facets, 0.1 mm late.
      EXPECT_LE(fraction, spring ? 1.001 + 0.15e-3 / p.depth_m : 1.001)
          << model << " " << p.depth_m << " m deep";
      EXPECT_GE(p.force_n, before * (1 - 1e-3)) << model << " falls " << p.depth_m << " m deep";
      before = p.force_n;
    }
    std::printf("%s, stiffness of the scene times %g, %.4g N/m certified: share at 1 to 10 mm%s\n",
                model, times, certified, row.c_str());
  }
}

TEST(Press, OfAMemorylessModelFallsOncePointsPassThrough) {
  for (const char* model : {"original", "adapted"}) {
    Scene alone(model, scene::RenderingKind::kMemoryless), held(model);
    ASSERT_EQ(sentence_of(alone.fitted.refusal), "") << model;
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
  }
}

}  // namespace press_test
}  // namespace voxtouch::test
