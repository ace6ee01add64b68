// What was kept and read again is, bit for bit, what would be built.
#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "core/rendering/built_parts.hpp"
#include "core/scene/scene_file.hpp"
#include "core/types/stored_bytes.hpp"
#include "tests/unit/scene_build/memory_store.hpp"

namespace voxtouch::test::kept_scenes {
namespace {

using rendering::BuiltScene;

mesh::FileTriangles never_read(const std::filesystem::path& path, std::string,
                               const mesh::ImportOptions&) {
  throw std::logic_error("read again: " + path.string());
}

/// Everything that a look into the built scene gives, as bytes.
std::string all_of(BuiltScene& built) {
  ByteWriter out;
  for (std::size_t n = 0; n < built.contacts().size(); ++n) {
    const rendering::StaticObject& object = built.contacts().object(n);
    out(object.id), out(object.name);
    object.voxmap.put(out);
    out(object.field.has_value());
    if (object.field)
      object.field->put(out);
    out(object.edges != nullptr);
    if (object.edges)
      put(object.edges->query.shell(), out), object.edges->query.voxmap().put(out),
          object.edges->tool_field->put(out);
  }
  const rendering::EffectGround& ground = built.effect_ground();
  out(ground.proximity.has_value());
  if (ground.proximity)
    ground.proximity->put(out);
  for (const effects::ToolPoint& point : ground.tool.points)
    out(point.position), out(point.share);
  out(ground.tool.gap_m), out(ground.tool.reach_m);
  out(ground.body.has_value());
  if (ground.body)
    out(ground.body->centre), out(ground.body->inertia_m2), out(ground.body->reach_m);
  out(ground.virtual_tool_lever_m), out(built.largest_shell_gap_m());
  const rendering::Plan& plan = built.plan();
  for (const auto* sentences : {&plan.built, &plan.left_out, &plan.warnings})
    out(*sentences);
  for (const rendering::PlanPart& part : plan.parts)
    out(part.name), out(part.why), out(part.bytes), out(part.expected_ns);
  out(plan.scene), out(plan.scene_hash), out(plan.contact_model), out(plan.voxel_size_m),
      out(plan.shell_points), out(plan.surface_voxels);
  out(plan.interior_voxels), out(plan.bytes), out(plan.expected_ns_per_frame);
  for (const auto* range : {&plan.contact_n_per_m, &plan.contact_nm_per_rad,
                            &plan.of_contact_alone.translation, &plan.of_contact_alone.rotation})
    out(range->one_point), out(range->all_points);
  return out.take();
}

/// The forces of the scene's motions, as bits.
std::vector<std::uint64_t> forces(const scene::Scene& scene, BuiltScene& built) {
  std::vector<std::uint64_t> bits;
  for (const auto& [name, motion] : scene.motions) {
    built.scene_renderer().reset();
    built.scene_renderer().aim_for_spring(300.0);
    for (int n = 0; n < 400; ++n) {
      const double time_s = 0.005 * n;
      rendering::ToolState tool{};
      tool.pose.position = motion_at(motion, time_s).position;
      const rendering::SceneFrame frame = built.scene_renderer().render(tool, time_s);
      for (int axis = 0; axis < 3; ++axis)
        bits.push_back(std::bit_cast<std::uint64_t>(frame.wrench.force[axis])),
            bits.push_back(std::bit_cast<std::uint64_t>(frame.wrench.torque[axis]));
    }
  }
  return bits;
}

std::vector<std::filesystem::path> shipped_scenes() {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(VOXTOUCH_DEPLOY "/scenes"))
    if (entry.path().extension() == ".yaml")
      files.insert(entry.path());
  return {files.begin(), files.end()};
}

TEST(KeptScenes, OfAllThatAreShippedAreBitEqualToBuiltOnes) {
  MemoryStore store;
  std::size_t recipes = 0;
  for (const std::filesystem::path& file : shipped_scenes()) {
    SCOPED_TRACE(file.filename().string());
    const scene::Scene scene = scene::load_scene(file);
    const auto built = rendering::build_scene(scene, serial_for());
    const std::size_t before = store.kept.size();
    rendering::build_scene(scene, serial_for(), {.store = &store});
    recipes += store.kept.size() - before;
    const auto kept =
        rendering::build_scene(scene, serial_for(), {.read = never_read, .store = &store});
    EXPECT_TRUE(all_of(*built) == all_of(*kept));
    const std::vector<std::uint64_t> wanted = forces(scene, *built);
    EXPECT_TRUE(wanted == forces(scene, *kept));
  }
  EXPECT_TRUE(store.refused.empty());
  EXPECT_GE(recipes, 8U) << "scenes of other meshes, fields and effects";
  EXPECT_LT(recipes, shipped_scenes().size())
      << "scenes that differ in their law alone share what is built";
}

TEST(KeptScenes, AreBuiltByAnyNumberOfThreadsToTheSameBytes) {
  const scene::Scene scene = scene::load_scene(VOXTOUCH_DEPLOY "/scenes/cup_proximity.yaml");
  MemoryStore one, other;
  rendering::build_scene(scene, serial_for(), {.store = &one});
  const ParallelFor backwards = [](std::size_t count,
                                   const std::function<void(std::size_t)>& body) {
    while (count-- > 0)
      body(count);
  };
  rendering::build_scene(scene, backwards, {.store = &other});
  ASSERT_EQ(one.kept.size(), 1U);
  EXPECT_TRUE(one.kept == other.kept);
}

TEST(KeptScenes, AreNotOfferedWhereTheyAreLargerThanTheStore) {
  MemoryStore store;
  store.most = 10'000;
  rendering::build_scene(scene::load_scene(VOXTOUCH_DEPLOY "/scenes/cup.yaml"), serial_for(),
                         {.store = &store});
  EXPECT_TRUE(store.kept.empty());
}

TEST(KeptScenes, AreNotKeptWhereTheBuildFails) {
  MemoryStore store;
  scene::Scene scene = scene::load_scene(VOXTOUCH_DEPLOY "/scenes/plane.yaml");
  EXPECT_THROW(rendering::build_scene(scene, serial_for(), {.read = never_read, .store = &store}),
               std::exception);
  EXPECT_TRUE(store.kept.empty());
}

}  // namespace
}  // namespace voxtouch::test::kept_scenes
