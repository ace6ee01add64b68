#include "core/rendering/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace voxtouch {
namespace {

Scene cup() {
  Scene s;
  s.name = "cup", s.hash = "0123456789abcdef", s.voxel_size_m = 0.002;
  s.static_meshes.resize(1);
  s.contact.stiffness_n_per_m = 10;
  return s;
}
BuildCounts counts() {
  BuildCounts n;
  n.static_triangles = 1000, n.dynamic_triangles = 1;
  n.surface_voxels = 40'000, n.interior_voxels = 9'000;
  n.contact_n_per_m = {10, 15'000}, n.contact_nm_per_rad = {0.001, 0.5};
  n.shell_points = 1500, n.voxmap_bytes = 2'500'000, n.shell_bytes = 96'000;
  return n;
}
bool any_has(const std::vector<std::string>& lines, const char* text) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& s) { return s.find(text) != std::string::npos; });
}

TEST(Plan, SaysWhatIsBuiltAndForWhat) {
  const Plan p = make_plan(cup(), counts());
  EXPECT_EQ(p.scene, "cup");
  EXPECT_EQ(p.scene_hash, "0123456789abcdef");
  EXPECT_EQ(p.contact_model, "adapted");
  EXPECT_EQ(p.voxel_size_m, 0.002);
  EXPECT_EQ(p.shell_points, 1500U);
  EXPECT_EQ(p.surface_voxels, 40'000U);
  EXPECT_EQ(p.interior_voxels, 9'000U);
  EXPECT_EQ(p.bytes, 2'596'000U);
  EXPECT_DOUBLE_EQ(p.expected_ns_per_frame, 150 + (6.0 + 12.0) * 1500);
  EXPECT_TRUE(any_has(p.built, "Voxmap of 1 static mesh (1000 triangles) at 0.002 m: 40000 surface voxels"));
  EXPECT_TRUE(any_has(p.built, "Exact pointshell of the dynamic mesh (1 triangle): 1500 points, 96.0 kB"));
  EXPECT_TRUE(any_has(p.built, "'adapted' with 10 N/m"));
  EXPECT_EQ(p.contact_n_per_m.one_point, 10);
  EXPECT_EQ(p.contact_n_per_m.all_points, 15'000);
  EXPECT_EQ(p.contact_nm_per_rad.one_point, 0.001);
  EXPECT_EQ(p.contact_nm_per_rad.all_points, 0.5);
  EXPECT_TRUE(any_has(p.built, "at most: 10 N/m and 0.001 Nm/rad about the tool's origin by one point, 15000 N/m and 0.5 Nm/rad by"));
  EXPECT_TRUE(any_has(p.built, "shaping filter"));
  EXPECT_FALSE(any_has(p.built, "Reference"));
  EXPECT_TRUE(p.warnings.empty());
}

TEST(Plan, SaysWhatIsLeftOutAndWhy) {
  const Plan p = make_plan(cup(), counts());
  for (const char* what : {"Signed distance field", "Distances outside", "velocity", "Effects that the scene does not name: ", "viscosity", "Clutch"}) EXPECT_TRUE(any_has(p.left_out, what)) << what;
  EXPECT_FALSE(any_has(p.left_out, "Interior"));
  BuildCounts open = counts();
  open.interior_voxels = 0, open.closed = false;
  EXPECT_TRUE(any_has(make_plan(cup(), open).left_out, "open"));
  open.closed = true;
  EXPECT_TRUE(any_has(make_plan(cup(), open).left_out, "no voxel lies wholly inside"));
  Scene s = cup();
  s.device.clutch_button = 0;
  EXPECT_FALSE(any_has(make_plan(s, counts()).left_out, "Clutch"));
}

TEST(Plan, SaysWhatEachEffectNeedsAndCanDo) {
  Scene s = cup();
  EffectSpec oil{.name = "oil", .kind = find_effect_kind("viscosity"), .values = {}, .region = {}};
  oil.values = EffectValues(oil.kind->parameters);
  oil.values.at(0)[0] = 1.5;
  oil.on = false;
  s.effects = {oil};
  const Plan p = make_plan(s, counts());
  EXPECT_TRUE(any_has(p.built, "Effect 'oil' (viscosity): The tool moves"));
  EXPECT_TRUE(any_has(p.built, "Needs the tool's velocity. At most 1.5 Ns/m, 3 N. Switched off at the start."));
  EXPECT_FALSE(any_has(p.left_out, "velocity"));
  EXPECT_FALSE(any_has(p.left_out, "viscosity"));
  EXPECT_TRUE(any_has(p.left_out, "Distances outside"));
}

TEST(Plan, HasPartsWhoseCostsAddUpToTheFramesAndWhoseEffectsAreTheScenes) {
  Scene s = cup();
  const auto part = [](const Plan& plan, const std::string& name) {
    const auto found = std::find_if(plan.parts.begin(), plan.parts.end(), [&](const PlanPart& p) { return p.name == name; });
    return found == plan.parts.end() ? PlanPart{} : *found;
  };
  const Plan bare = make_plan(s, counts());
  EXPECT_EQ(bare.parts.size(), 5U) << "voxmap, pointshell, tree, contact model, coupling";
  EXPECT_EQ(part(bare, "voxmap").bytes, 2'500'000U);
  EXPECT_EQ(part(bare, "pointshell").bytes, 96'000U);
  EXPECT_EQ(part(bare, "culling tree").bytes, (47U + 3U + 1U) * 32U) << "1500 points: 47 leaves, 3 nodes, a root";
  EXPECT_EQ(part(bare, "coupling").node, "coupling");
  EffectSpec oil{.name = "oil", .kind = find_effect_kind("viscosity"), .values = {}, .region = {}};
  oil.values = EffectValues(oil.kind->parameters);
  EffectSpec off = oil;
  off.name = "off", off.on = false;
  s.effects = {oil, off};
  const Plan p = make_plan(s, counts());
  EXPECT_EQ(part(p, "effect oil").expected_ns, kNsPerEffect + oil.kind->expected_ns);
  EXPECT_EQ(part(p, "effect off").expected_ns, kNsPerEffectOff);
  EXPECT_NE(part(p, "effect off").why.find("off at the start"), std::string::npos);
  EXPECT_DOUBLE_EQ(p.expected_ns_per_frame,
                   bare.expected_ns_per_frame + kNsPerEffect + oil.kind->expected_ns + kNsPerEffectOff);
  BuildCounts n = counts();
  n.field_bytes = 1000, s.contact.model = "field";
  EXPECT_EQ(part(make_plan(s, n), "distance field").bytes, 1000U);
  EXPECT_EQ(part(p, "distance field").name, "");
  for (const Plan* plan : {&bare, &p})
    for (const PlanPart& one : plan->parts) EXPECT_GT(one.why.size(), 20U) << one.name;
}

TEST(Plan, PassesWarningsOnAndAddsItsOwn) {
  Scene s = cup();
  s.warnings = {"scene.yaml:1:1: doubtful."};
  BuildCounts n = counts();
  n.mesh_warnings = {"3 triangles have no area."};
  n.shell_points = 166'658;
  Plan p = make_plan(s, n);
  EXPECT_TRUE(any_has(p.warnings, "doubtful"));
  EXPECT_TRUE(any_has(p.warnings, "no area"));
  EXPECT_TRUE(any_has(p.warnings, "3.0 ms, longer than a period"));
  n.shell_points = 0, n.surface_voxels = 0;
  p = make_plan(s, n);
  EXPECT_TRUE(any_has(p.warnings, "nothing can touch."));
  EXPECT_TRUE(any_has(p.warnings, "nothing can be touched."));
}

TEST(Plan, NamesTheOtherCouplingsAndTheReference) {
  Scene s = cup();
  s.coupling.kind = "spring_damper";
  s.dynamic_mesh.primitives.push_back(SpherePrimitive{Vec3::Zero(), 0.01});
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, "spring-damper of 500 N/m"));
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, "Reference from 1 closed form "));
  s.coupling.kind = "direct";
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, "straight to the device"));
}

TEST(Plan, NamesWhatACouplingAddsAndWhatADesignIsAskedFor) {
  Scene s = cup();
  EXPECT_FALSE(any_has(make_plan(s, counts()).built, "capped"));
  s.coupling.stiffness_cap_n_per_m = 800, s.coupling.stiffness_cap_nm_per_rad = 2, s.coupling.injected_damping_ns_per_m = 3;
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, "stiffness is capped at 800 N/m."));
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, "rotation is capped at 2 Nm/rad."));
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, "damps with 3 Ns/m and 0 Nms/rad."));
  s.design = DesignOptions{};
  EXPECT_TRUE(any_has(make_plan(s, counts()).built,
                      "Coupling: designed when the device is known; kind auto, wished cut-off 5 Hz, gain margin 2, hand: as the "
                      "device is held, and it may be let go."));
  EXPECT_FALSE(any_has(make_plan(s, counts()).built, "shaping filter"));
  s.design->stiffness_cap_n_per_m = 700, s.design->released = false, s.design->hand = HandOption::kArm;
  s.design->kind = "spring_damper", s.design->inject_damping = false;
  EXPECT_TRUE(any_has(make_plan(s, counts()).built,
                      "kind spring_damper, gain margin 2, hand: arm, but it is never let go, stiffness capped at 700 N/m, no injected damping."));
}

TEST(Plan, TextHoldsEverySentence) {
  const Plan p = make_plan(cup(), counts());
  const std::string text = to_text(p);
  for (const auto* lines : {&p.built, &p.left_out})
    for (const std::string& line : *lines) EXPECT_NE(text.find(line), std::string::npos);
  EXPECT_NE(text.find("Memory: 2596.0 kB. Expected: at most about 27.1 us a frame."), std::string::npos) << text;
}

}  // namespace
}  // namespace voxtouch
