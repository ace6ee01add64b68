#include "core/device_fit/design_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/rendering/device_mapping.hpp"

namespace voxtouch::device_fit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

scene::Scene scaled_scene() {
  scene::Scene s;
  s.voxel_size_m = 0.002;
  s.device.position_scale = 4, s.device.force_scale = 0.5;
  s.design = scene::DesignOptions{};
  return s;
}
coupling::design::DeviceModel device() {
  coupling::design::DeviceModel d;
  d.name = "third";
  d.translation.max_effort = 22, d.translation.max_stiffness = 1000,
  d.translation.inertia_max = 0.2;
  d.rotation.max_effort = 0.5;
  d.gives_torque = true;
  d.timing.delay_s = 0.002;
  return d;
}

coupling::design::DeviceModel giving(double force_n, double torque_nm) {
  coupling::design::DeviceModel d;
  d.translation.max_effort = force_n, d.rotation.max_effort = torque_nm,
  d.gives_torque = torque_nm > 0.0;
  return d;
}
coupling::design::DeviceModel arm() {
  coupling::design::DeviceModel d = device();
  d.grip = coupling::design::Grip::kArm;
  return d;
}

/// A spring in W as displayed at the hand, through the ring's mapping.
TEST(HandScales, AreWhatTheDeviceMappingDoes) {
  scene::WorkspaceMapping spec;
  spec.position_scale = 4, spec.force_scale = 0.5;
  spec.pose_WD.orientation = Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  const HandScales scales = hand_scales(spec);
  rendering::DeviceMapping mapping(spec);
  const Pose rest = mapping.update({}, {}, 0).pose;
  const double translation_w = 300, rotation_w = 7, step = 1e-3, turn = 1e-4;
  const Pose pulled = mapping.update({Vec3(step, 0, 0), Quat::Identity()}, {}, 0).pose;
  const Wrench force = rendering::wrench_to_device(
      spec, {-translation_w * (pulled.position - rest.position), Vec3::Zero()}, pulled.orientation);
  EXPECT_NEAR(-force.force.x() / step, translation_w * scales.translation, 1e-9);
  const Pose turned =
      mapping.update({Vec3::Zero(), Quat(Eigen::AngleAxisd(turn, Vec3::UnitX()))}, {}, 0).pose;
  const Eigen::AngleAxisd angle(turned.orientation * rest.orientation.conjugate());
  const Wrench torque = rendering::wrench_to_device(
      spec, {Vec3::Zero(), -rotation_w * angle.angle() * angle.axis()}, turned.orientation);
  EXPECT_NEAR(-torque.torque.x() / turn, rotation_w * scales.rotation, 1e-6);
  EXPECT_DOUBLE_EQ(scales.translation, 2.0);
  EXPECT_DOUBLE_EQ(scales.rotation, 0.125);
}

TEST(DesignProblem, IsAllAtTheHand) {
  const coupling::design::DesignProblem r =
      design_problem(scaled_scene(), arm(), {10, 4000}, {0.01, 8});
  EXPECT_DOUBLE_EQ(r.contact.one_point, 20);
  EXPECT_DOUBLE_EQ(r.contact.all_points, 8000);
  EXPECT_DOUBLE_EQ(r.contact_rotation.one_point, 0.00125);
  EXPECT_DOUBLE_EQ(r.contact_rotation.all_points, 1);
  EXPECT_DOUBLE_EQ(r.goals.force_layer_depth_m, 0.00025)
      << "half a voxel is a quarter as long in the hand";
  EXPECT_EQ(r.device.name, "third");
  EXPECT_EQ(r.device.translation.max_effort, 22) << "the device is at the hand already";
  EXPECT_EQ(r.device.translation.max_stiffness, 1000);
  EXPECT_EQ(r.device.rotation.max_effort, 0.5);
  EXPECT_TRUE(r.device.gives_torque);
  EXPECT_EQ(r.device.timing.delay_s, 0.002);
  EXPECT_EQ(r.hand.translation.mass_max, 2.0) << "held by the device's grip";
  EXPECT_TRUE(r.hand.translation.may_release);
  EXPECT_TRUE(r.goals.free_cap);
  EXPECT_EQ(r.goals.kind, "auto");
  EXPECT_EQ(r.goals.cutoff_hz, 5);
  EXPECT_EQ(r.goals.max_cutoff_hz, coupling::design::DesignGoals{}.max_cutoff_hz);
  EXPECT_EQ(r.goals.damping_force_ratio, std::nullopt) << "the designer's choice";
}

TEST(DesignProblem, CarriesEveryRequestOfTheScene) {
  scene::Scene s = scaled_scene();
  s.design->kind = "direct", s.design->cutoff_hz = 300, s.design->gain_margin = 1.5,
  s.design->inject_damping = false, s.design->velocity_windows = false;
  s.design->min_damping_ratio = 0.15, s.design->rotation_min_damping_ratio = 0.06,
  s.design->damping_force_ratio = 0.2;
  s.design->hand = scene::HandOption::kAnyPassive;
  const coupling::design::DesignProblem r = design_problem(s, device(), {10, 4000}, {0.01, 8});
  EXPECT_EQ(r.goals.kind, "direct");
  EXPECT_EQ(r.goals.cutoff_hz, 300);
  EXPECT_EQ(r.goals.max_cutoff_hz, 300) << "a request does not exceed what is allowed";
  EXPECT_EQ(r.goals.gain_margin, 1.5);
  EXPECT_FALSE(r.goals.allow_injected_damping);
  EXPECT_FALSE(r.goals.velocity_windows);
  EXPECT_EQ(r.goals.min_damping.gripped, 0.15);
  EXPECT_EQ(r.goals.rotation_min_damping.gripped, 0.06);
  EXPECT_EQ(r.goals.damping_force_ratio, 0.2);
  EXPECT_TRUE(r.hand.translation.any_passive && r.hand.rotation.any_passive);
}

TEST(DesignProblem, AppliesTheScenesCapsAndLeavesNoFreeCap) {
  scene::Scene s = scaled_scene();
  s.design->stiffness_cap_n_per_m = 500;
  coupling::design::DesignProblem r = design_problem(s, device(), {10, 4000}, {0.01, 8});
  EXPECT_DOUBLE_EQ(r.contact.one_point, 20);
  EXPECT_DOUBLE_EQ(r.contact.all_points, 1000) << "500 N/m in W";
  EXPECT_DOUBLE_EQ(r.contact_rotation.all_points, 1);
  EXPECT_FALSE(r.goals.free_cap);
  s.design->stiffness_cap_n_per_m = 5, s.design->stiffness_cap_nm_per_rad = 4;
  r = design_problem(s, device(), {10, 4000}, {0.01, 8});
  EXPECT_DOUBLE_EQ(r.contact.one_point, 10) << "a cap below one point's stiffness caps that too";
  EXPECT_DOUBLE_EQ(r.contact.all_points, 10);
  EXPECT_DOUBLE_EQ(r.contact_rotation.all_points, 0.5);
  EXPECT_FALSE(r.goals.free_cap);
}

TEST(DesignProblem, OfAManualCouplingHasNoFreeCap) {
  scene::Scene s = scaled_scene();
  s.design.reset();
  s.coupling.stiffness_cap_n_per_m = 500;
  const coupling::design::DesignProblem r = design_problem(s, device(), {10, 4000}, {0.01, 8});
  EXPECT_DOUBLE_EQ(r.contact.all_points, 1000);
  EXPECT_FALSE(r.goals.free_cap);
  const coupling::CouplingSpec hand = spec_D(s.coupling, s.device);
  EXPECT_DOUBLE_EQ(hand.stiffness_cap_n_per_m, 1000);
  EXPECT_TRUE(std::isinf(hand.stiffness_cap_nm_per_rad));
}

TEST(SpecInWorld, BringsTheDesignFromTheHandToTheWorld) {
  coupling::design::Design design;
  design.spec.cutoff_hz = 33, design.spec.gain = 0.5, design.spec.damping_ratio = 0.9,
  design.spec.velocity_filter_hz = 50, design.spec.velocity_window = 2;
  design.spec.stiffness_n_per_m = 600, design.spec.damping_ns_per_m = 4;
  design.spec.stiffness_cap_n_per_m = 800, design.spec.stiffness_cap_nm_per_rad = 2;
  design.spec.injected_damping_ns_per_m = 3, design.spec.injected_damping_nms_per_rad = 0.01;
  design.spec.damping_force_ratio = 0.3, design.spec.damping_force_offset_n = 0.2;
  design.spec.slow_velocity_hz = 8, design.spec.velocity_band_m_per_s = 0.003;
  scene::Scene scene = scaled_scene();
  coupling::CouplingSpec spec = spec_W(design, scene);
  EXPECT_DOUBLE_EQ(spec.stiffness_cap_n_per_m, 400);
  EXPECT_DOUBLE_EQ(spec.stiffness_cap_nm_per_rad, 16);
  EXPECT_DOUBLE_EQ(spec.injected_damping_ns_per_m, 1.5);
  EXPECT_DOUBLE_EQ(spec.injected_damping_nms_per_rad, 0.08);
  EXPECT_DOUBLE_EQ(spec.stiffness_n_per_m, 300);
  EXPECT_DOUBLE_EQ(spec.damping_ns_per_m, 2);
  EXPECT_EQ(spec.cutoff_hz, 33);
  EXPECT_EQ(spec.gain, 0.5);
  EXPECT_EQ(spec.damping_ratio, 0.9);
  EXPECT_EQ(spec.velocity_filter_hz, 50);
  EXPECT_EQ(spec.velocity_window, 2U);
  EXPECT_EQ(spec.damping_force_ratio, 0.3);
  EXPECT_DOUBLE_EQ(spec.damping_force_offset_n, 0.2 / scene.device.force_scale);
  EXPECT_EQ(spec.slow_velocity_hz, 8);
  EXPECT_DOUBLE_EQ(spec.velocity_band_m_per_s, 0.003 * scene.device.position_scale)
      << "a speed of the tool";
  const coupling::CouplingSpec back = spec_D(spec, scene.device);
  EXPECT_DOUBLE_EQ(back.damping_force_offset_n, 0.2);
  EXPECT_DOUBLE_EQ(back.velocity_band_m_per_s, 0.003);
  EXPECT_DOUBLE_EQ(back.stiffness_cap_nm_per_rad, 2);
  EXPECT_DOUBLE_EQ(back.injected_damping_nms_per_rad, 0.01);
  EXPECT_DOUBLE_EQ(back.damping_ns_per_m, 4);
}

TEST(SpecInWorld, NeverLosesTheScenesOwnCaps) {
  coupling::design::Design uncapped;
  scene::Scene scene = scaled_scene();
  EXPECT_TRUE(std::isinf(spec_W(uncapped, scene).stiffness_cap_n_per_m));
  scene.design->stiffness_cap_n_per_m = 500, scene.design->stiffness_cap_nm_per_rad = 3;
  EXPECT_EQ(spec_W(uncapped, scene).stiffness_cap_n_per_m, 500);
  EXPECT_EQ(spec_W(uncapped, scene).stiffness_cap_nm_per_rad, 3);
  uncapped.spec.stiffness_cap_n_per_m = 100;
  EXPECT_EQ(spec_W(uncapped, scene).stiffness_cap_n_per_m, 50) << "the lower one holds";
}

TEST(LimitsInWorld, AreTheDevicesThroughTheScales) {
  const coupling::CouplingLimits limits = limits_W(scaled_scene().device, giving(20, 0.5));
  EXPECT_DOUBLE_EQ(limits.max_force_n, 40);
  EXPECT_DOUBLE_EQ(limits.max_torque_nm, 4);
  const coupling::CouplingLimits none = limits_W(scaled_scene().device, giving(kInfinity, 0));
  EXPECT_TRUE(std::isinf(none.max_force_n));
  EXPECT_EQ(none.max_torque_nm, 0);
  // At the limit in W the device gets just its own.
  const Wrench at_limit = rendering::wrench_to_device(
      scaled_scene().device, {Vec3(limits.max_force_n, 0, 0), Vec3(0, limits.max_torque_nm, 0)},
      Quat::Identity());
  EXPECT_DOUBLE_EQ(at_limit.force.norm(), 20);
  EXPECT_DOUBLE_EQ(at_limit.torque.norm(), 0.5);
}

}  // namespace
}  // namespace voxtouch::device_fit
