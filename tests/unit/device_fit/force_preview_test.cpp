// The force preview compared with the spring's law, and its limits.
#include <gtest/gtest.h>

#include "core/device_fit/design_problem.hpp"
#include "core/device_fit/force_preview.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::device_fit {

using design_text::sentence_of;
namespace force_preview_test {

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

coupling::design::DeviceModel arm() {
  coupling::design::DeviceModel model = stylus();
  model.translation.inertia_min = 2.0, model.translation.inertia_max = 4.0;
  model.gives_torque = true;
  model.rotation = {.inertia_min = 0.01,
                    .inertia_max = 0.02,
                    .damping = 0.05,
                    .resolution = 1e-5,
                    .max_effort = 5.0,
                    .max_stiffness = 50.0};
  return model;
}

/// A virtual tool on the shipped plane, or penalty forces with the bounds given.
struct Case {
  scene::Scene scene = scene::load_scene(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  coupling::design::DeviceModel device = stylus();
  rendering::StiffnessBounds bounds = rendering::spring_of_any_device(0.01);
  FittedCoupling fitted;

  Case() { scene.contact = {.model = "field", .rendering = scene::RenderingKind::kVirtualTool}; }
  std::optional<ForcePreview> preview() {
    fitted = fit_coupling(scene, device, bounds, demand_of(scene));
    return force_preview(fitted, scene, device, bounds);
  }
};

TEST(ForcePreview, ContainsTheSpringAndItsSaturation) {
  Case c;
  const auto p = c.preview();
  ASSERT_TRUE(p) << sentence_of(c.fitted.refusal);
  const double spring = spring_n_per_m(c.fitted, c.scene, c.device, c.bounds);
  EXPECT_DOUBLE_EQ(p->stiffness_n_per_m,
                   stiffness_at_hand_n_per_m(c.fitted.spec, c.scene.device, spring));
  EXPECT_DOUBLE_EQ(p->force_n, 8.5);
  EXPECT_NEAR(p->stiffness_n_per_m * p->depth_m, 8.5, 1e-12);
  EXPECT_GE(p->gain_margin, 2.0 * (1 - 1e-9));
  EXPECT_EQ(p->limit, StiffnessLimit::kLoop);
}

TEST(ForcePreview, NamesEachLimit) {
  Case weak;
  weak.device.translation.max_stiffness = 50.0;
  EXPECT_EQ(weak.preview().value().limit, StiffnessLimit::kDevice);
  Case soft;
  soft.scene.contact = {.model = "adapted"};
  soft.bounds = {{1.0, 20.0}, {0.0, 0.0}};
  EXPECT_EQ(soft.preview().value().limit, StiffnessLimit::kRequested);
  EXPECT_NEAR(soft.preview().value().stiffness_n_per_m, 20.0, 0.1);
  Case by_hand;
  by_hand.scene.design.reset();
  by_hand.scene.coupling = {.kind = "direct"};
  by_hand.scene.coupling.stiffness_cap_n_per_m = 100.0;
  EXPECT_EQ(by_hand.preview().value().limit, StiffnessLimit::kSetByHand);
  Case long_lever;
  long_lever.device = arm();
  long_lever.bounds = rendering::spring_of_any_device(1.0);
  const auto lever = long_lever.preview();
  ASSERT_TRUE(lever) << sentence_of(long_lever.fitted.refusal);
  EXPECT_EQ(lever->limit, StiffnessLimit::kLever);
  EXPECT_LT(lever->stiffness_n_per_m, long_lever.fitted.design.translation.displayed_stiffness);
}

TEST(ForcePreview, AcrossTheArmTwoSpringsActInSeries) {
  Case c;
  c.preview();
  const ForcePreview p = force_preview(c.fitted, c.scene, c.device, c.bounds, 0.02).value();
  EXPECT_DOUBLE_EQ(p.reach_m, 0.02);
  EXPECT_NEAR(p.rotation_nm_per_rad, p.stiffness_n_per_m * 1e-4, 1e-9) << "the lever is 10 mm";
  EXPECT_NEAR(p.across_n_per_m(), p.stiffness_n_per_m / (1.0 + 4.0), 1e-9);
  EXPECT_EQ(c.preview().value().across_n_per_m(), p.stiffness_n_per_m) << "no reach, no lever";
}

TEST(ForcePreview, IsAbsentIfNoForceMayBeCommanded) {
  Case c;
  c.device.translation.inertia_min = 0.0;
  EXPECT_FALSE(c.preview());
  EXPECT_NE(sentence_of(c.fitted.refusal), "");
}

TEST(ForcePreview, NamesOfLimitsReadBack) {
  for (const auto limit :
       {StiffnessLimit::kDevice, StiffnessLimit::kRequested, StiffnessLimit::kLever,
        StiffnessLimit::kLoop, StiffnessLimit::kSetByHand})
    EXPECT_EQ(stiffness_limit_of(name_of(limit)), limit);
  EXPECT_FALSE(stiffness_limit_of(""));
}

}  // namespace force_preview_test
}  // namespace voxtouch::device_fit
