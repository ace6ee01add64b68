#include "core/rendering/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>

namespace voxtouch::rendering {
namespace {

scene::Scene cup() {
  scene::Scene s;
  s.name = "cup", s.hash = "0123456789abcdef", s.voxel_size_m = 0.002;
  s.static_meshes.resize(1);
  s.contact.stiffness_n_per_m = 10;
  return s;
}
BuildCounts counts() {
  BuildCounts n;
  n.static_triangles = 1000, n.dynamic_triangles = 1;
  n.surface_voxels = 40'000, n.interior_voxels = 9'000;
  n.contact = {{10, 15'000}, {0.001, 0.5}};
  n.shell_points = 1500, n.voxmap_bytes = 2'500'000, n.shell_bytes = 96'000;
  return n;
}
/// The sentence of `lines` with all of `words`; empty without one. Facts are checked, not the
/// wording.
std::string line_with(const std::vector<std::string>& lines,
                      std::initializer_list<const char*> words) {
  const auto found = std::find_if(lines.begin(), lines.end(), [&](const std::string& line) {
    return std::all_of(words.begin(), words.end(),
                       [&](const char* word) { return line.find(word) != std::string::npos; });
  });
  return found == lines.end() ? std::string() : *found;
}
bool any_has(const std::vector<std::string>& lines, std::initializer_list<const char*> words) {
  return !line_with(lines, words).empty();
}
effects::EffectSpec oil(const char* name, bool on) {
  effects::EffectSpec spec{
      .name = name, .kind = effects::find_effect_kind("viscosity"), .values = {}, .region = {}};
  spec.values = effects::EffectValues(spec.kind->parameters);
  spec.values.at(0)[0] = 1.5;
  spec.on = on;
  return spec;
}

TEST(Plan, PrintsEachVoxelGridsOriginAndAlternative) {
  BuildCounts n = counts();
  n.grids = {{"ground", Vec3(-0.123, -0.123, -0.023), Vec3(-0.122, -0.122, -0.022), false},
             {"lid", Vec3(1, 2, 3), Vec3(1, 2, 3), false},
             {"given", Vec3(0.1, 0.2, 0.3), Vec3(0, 0, 0), true}};
  const Plan p = make_plan(cup(), n);
  EXPECT_TRUE(
      any_has(p.built, {"'ground'", "[-0.123, -0.123, -0.023] m", "[-0.122, -0.122, -0.022]"}));
  EXPECT_TRUE(any_has(p.built, {"'lid'", "[1, 2, 3] m", "multiples of"}));
  EXPECT_TRUE(any_has(p.built, {"'given'", "[0.1, 0.2, 0.3] m"}));
}

TEST(Plan, PrintsWhatIsBuiltWithItsCounts) {
  const Plan p = make_plan(cup(), counts());
  EXPECT_EQ(p.scene, "cup");
  EXPECT_EQ(p.scene_hash, "0123456789abcdef");
  EXPECT_EQ(p.contact_model, "adapted");
  EXPECT_EQ(p.voxel_size_m, 0.002);
  EXPECT_EQ(p.shell_points, 1500U);
  EXPECT_EQ(p.surface_voxels, 40'000U);
  EXPECT_EQ(p.interior_voxels, 9'000U);
  EXPECT_EQ(p.contact_n_per_m.all_points, 15'000);
  EXPECT_EQ(p.contact_nm_per_rad.one_point, 0.001);
  EXPECT_TRUE(any_has(p.built, {"Voxmap", "1000 triangles", "0.002 m", "40000"}));
  EXPECT_TRUE(any_has(p.built, {"pointshell", "1 triangle", "1500 points"}));
  EXPECT_TRUE(any_has(p.built, {"'adapted'", "10 N/m"}));
  EXPECT_TRUE(any_has(p.built, {"10 N/m", "15000 N/m", "0.001 Nm/rad", "0.5 Nm/rad"}));
  EXPECT_TRUE(any_has(p.built, {"shaping filter"}));
  EXPECT_FALSE(any_has(p.built, {"Reference"}));
  EXPECT_TRUE(p.warnings.empty());
}

TEST(Plan, PrintsWhatIsSkippedUntilRequested) {
  scene::Scene s = cup();
  const Plan bare = make_plan(s, counts());
  for (const char* what :
       {"distance field", "Distances outside", "velocity", "viscosity", "Clutch"})
    EXPECT_TRUE(any_has(bare.skipped, {what})) << what;
  EXPECT_FALSE(any_has(bare.skipped, {"Interior"}));
  s.device.clutch_button = 0;
  s.effects = {oil("oil", false)};
  const Plan p = make_plan(s, counts());
  for (const char* what : {"velocity", "viscosity", "Clutch"})
    EXPECT_FALSE(any_has(p.skipped, {what})) << what;
  EXPECT_TRUE(any_has(p.skipped, {"Distances outside"}));
  EXPECT_TRUE(any_has(p.built, {"'oil'", "viscosity", "velocity", "1.5 Ns/m", "off at"}));
}

TEST(Plan, DistinguishesOpenFromThinMeshes) {
  BuildCounts hollow = counts();
  hollow.interior_voxels = 0, hollow.closed = false;
  const std::string open = line_with(make_plan(cup(), hollow).skipped, {"Interior"});
  hollow.closed = true;
  const std::string thin = line_with(make_plan(cup(), hollow).skipped, {"Interior"});
  EXPECT_NE(open, "");
  EXPECT_NE(thin, "");
  EXPECT_NE(open, thin);
}

TEST(Plan, HasPartsThatAddUpToItsTimeAndItsMemory) {
  scene::Scene s = cup();
  const Plan bare = make_plan(s, counts());
  s.effects = {oil("oil", true), oil("off", false)};
  const Plan with_effects = make_plan(s, counts());
  for (const Plan* plan : {&bare, &with_effects}) {
    double ns = 0.0;
    std::uint64_t bytes = 0;
    for (const PlanPart& part : plan->parts) {
      ns += part.node == "rendering" ? part.expected_ns : 0.0;
      bytes += part.bytes;
      EXPECT_FALSE(part.why.empty()) << part.name;
    }
    EXPECT_DOUBLE_EQ(ns, plan->expected_ns_per_frame);
    EXPECT_GE(bytes, counts().voxmap_bytes + counts().shell_bytes);
  }
  EXPECT_EQ(with_effects.parts.size(), bare.parts.size() + 2);
  EXPECT_GT(with_effects.expected_ns_per_frame, bare.expected_ns_per_frame);
}

TEST(Plan, CostsMoreForMorePointsAndActiveEffects) {
  scene::Scene s = cup();
  BuildCounts twice = counts();
  twice.shell_points *= 2;
  EXPECT_GT(make_plan(s, twice).expected_ns_per_frame,
            1.5 * make_plan(s, counts()).expected_ns_per_frame);
  s.effects = {oil("oil", true)};
  const double on = make_plan(s, counts()).expected_ns_per_frame;
  s.effects = {oil("oil", false)};
  EXPECT_GT(on, make_plan(s, counts()).expected_ns_per_frame);
}

TEST(Plan, HasAPartForTheFieldModel) {
  scene::Scene s = cup();
  BuildCounts n = counts();
  const auto fields = [](const Plan& plan) {
    return std::count_if(plan.parts.begin(), plan.parts.end(), [](const PlanPart& part) {
      return part.name == "distance field" && part.bytes == 1000U;
    });
  };
  EXPECT_EQ(fields(make_plan(s, n)), 0);
  n.field_bytes = 1000, s.contact.model = "field";
  EXPECT_EQ(fields(make_plan(s, n)), 1);
}

TEST(Plan, PassesWarningsOnAndAddsItsOwn) {
  scene::Scene s = cup();
  s.warnings = {"scene.yaml:1:1: doubtful."};
  BuildCounts n = counts();
  n.mesh_warnings = {"3 triangles have no area."};
  EXPECT_EQ(make_plan(s, n).warnings,
            (std::vector<std::string>{s.warnings[0], n.mesh_warnings[0]}));
  n.shell_points = 166'658;
  EXPECT_TRUE(any_has(make_plan(s, n).warnings, {"period"})) << "a frame of three milliseconds";
  n.shell_points = 0, n.surface_voxels = 0;
  EXPECT_EQ(make_plan(s, n).warnings.size(), 4U) << "nothing that touches, nothing that is touched";
}

TEST(Plan, NamesTheOtherCouplingsAndTheReference) {
  scene::Scene s = cup();
  s.coupling.kind = "spring_damper";
  s.dynamic_mesh.primitives.push_back(scene::SpherePrimitive{Vec3::Zero(), 0.01});
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, {"spring-damper", "500 N/m"}));
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, {"Reference"}));
  s.coupling.kind = "direct";
  EXPECT_FALSE(any_has(make_plan(s, counts()).built, {"spring-damper"}));
}

TEST(Plan, NamesCouplingAdditionsAndDesignRequests) {
  scene::Scene s = cup();
  EXPECT_FALSE(any_has(make_plan(s, counts()).built, {"capped"}));
  s.coupling.stiffness_cap_n_per_m = 800, s.coupling.stiffness_cap_nm_per_rad = 2,
  s.coupling.injected_damping_ns_per_m = 3;
  for (const char* value : {"800 N/m", "2 Nm/rad", "3 Ns/m"})
    EXPECT_TRUE(any_has(make_plan(s, counts()).built, {value})) << value;
  s.design = scene::DesignOptions{};
  EXPECT_TRUE(any_has(make_plan(s, counts()).built, {"designed", "auto", "5 Hz", "margin 2"}));
  EXPECT_FALSE(any_has(make_plan(s, counts()).built, {"shaping filter"}));
  s.design->stiffness_cap_n_per_m = 700, s.design->released = false,
  s.design->hand = scene::HandOption::kArm;
  s.design->kind = "spring_damper", s.design->inject_damping = false;
  EXPECT_TRUE(any_has(make_plan(s, counts()).built,
                      {"spring_damper", "hand: arm", "never released", "700 N/m", "no injected"}));
}

}  // namespace
}  // namespace voxtouch::rendering
