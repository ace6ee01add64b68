// The recipe of a scene's parts has all that they depend on, and nothing that they do not.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <set>

#include "core/rendering/builders_digest.hpp"
#include "core/rendering/built_parts.hpp"
#include "core/scene/scene_file.hpp"
#include "tests/support/process/process.hpp"
#include "tests/unit/scene_build/memory_store.hpp"

namespace voxtouch::test::parts_recipe {
namespace {

using contact::ContactModelKind;

struct Recipes {
  MemoryStore store;
  rendering::BuildChoices choices;
  ContactModelKind model = ContactModelKind::kAdapted;

  std::string of(const scene::Scene& scene) const {
    return rendering::recipe_of({scene, choices, model}, store);
  }
};

scene::Scene shipped(const char* name) {
  return scene::load_scene(std::string(VOXTOUCH_DEPLOY "/scenes/") + name + ".yaml");
}

TEST(PartsRecipe, ChangesWithEachSettingThatIsBuiltIn) {
  const scene::Scene objects = shipped("objects");
  const Recipes recipes;
  const std::string before = recipes.of(objects);
  ASSERT_FALSE(before.empty());
  std::set<std::string> all{before};
  const auto differs = [&](const char* what, const std::string& recipe) {
    EXPECT_TRUE(all.insert(recipe).second) << what;
  };
  const auto changed = [&](const char* what, const std::function<void(scene::Scene&)>& change) {
    scene::Scene other = objects;
    change(other);
    differs(what, recipes.of(other));
  };
  changed("voxel_size", [](scene::Scene& s) { s.voxel_size_m *= 1.0000001; });
  changed("grid_origin", [](scene::Scene& s) { s.grid_origin = Vec3(0.0, 0.0, 1e-9); });
  changed("grid_origin of an object",
          [](scene::Scene& s) { s.objects.at(0).grid_origin = Vec3(0.0, 1e-9, 0.0); });
  changed("name of an object", [](scene::Scene& s) { s.objects.at(0).name += "_"; });
  changed("object of a mesh", [](scene::Scene& s) { s.static_meshes.back().object = 0; });
  changed("scale", [](scene::Scene& s) { s.static_meshes.at(0).scale *= 1.0000001; });
  changed("position", [](scene::Scene& s) { s.static_meshes.at(0).pose.position.x() += 1e-9; });
  changed("orientation", [](scene::Scene& s) {
    s.dynamic_mesh.pose.orientation = Quat(Eigen::AngleAxisd(1e-6, Vec3::UnitX()));
  });
  changed("scale of the tool", [](scene::Scene& s) { s.dynamic_mesh.scale *= 1.0000001; });
  changed("shell", [](scene::Scene& s) { s.shell = scene::ShellKind::kNaive; });
  changed("virtual tool",
          [](scene::Scene& s) { s.contact.rendering = scene::RenderingKind::kVirtualTool; });
  changed("one mesh less", [](scene::Scene& s) { s.static_meshes.pop_back(); });
  Recipes other;
  other.model = ContactModelKind::kField;
  differs("contact model field", other.of(objects));
  other = {};
  other.choices.shell_voxel_m = 0.001;
  differs("voxels of the shell", other.of(objects));
  other = {};
  other.choices.field_depth_voxels = 3.0;
  differs("depth of the field", other.of(objects));
  // With the same meshes and voxels as the cup: what effects ask for.
  differs("the cup", recipes.of(shipped("cup")));
  differs("distances round it", recipes.of(shipped("cup_proximity")));
}

TEST(PartsRecipe, IsTheSameWhateverTheLawIs) {
  const Recipes recipes;
  scene::Scene scene = shipped("cup");
  const std::string before = recipes.of(scene);
  EXPECT_TRUE(before == recipes.of(shipped("cup_friction")));
  scene.contact.stiffness_n_per_m *= 2.0, scene.name = "other", scene.motions.clear(),
                                          scene.device.force_scale = 0.5;
  EXPECT_TRUE(before == recipes.of(scene));
  Recipes original;
  original.model = ContactModelKind::kOriginal;
  EXPECT_TRUE(before == original.of(scene));
}

TEST(PartsRecipe, HasTheMeshesByContentAndNotByPlace) {
  const TemporaryFolder folder;
  const auto copy_to = [&](const std::string& name, const std::string& more) {
    std::filesystem::create_directory(folder / name);
    std::filesystem::copy_file(VOXTOUCH_DEPLOY "/meshes/plane.obj", folder / name / "part.obj");
    std::ofstream(folder / name / "part.obj", std::ios::app) << more;
    std::ofstream(folder / name / "scene.yaml")
        << "scene: s\nvoxel_size: 0.004\nstatic: [{mesh: part.obj}]\n"
        << "dynamic: {mesh: " VOXTOUCH_DEPLOY "/meshes/sphere.obj, scale: 0.01}\n"
        << "contact: {model: adapted, stiffness_n_per_m: 10}\n"
        << "coupling: {design: auto}\n";
    return scene::load_scene(folder / name / "scene.yaml");
  };
  const Recipes recipes;
  const std::string one = recipes.of(copy_to("one", ""));
  EXPECT_TRUE(one == recipes.of(copy_to("two", "")));
  EXPECT_FALSE(one == recipes.of(copy_to("three", "# a comment\n"))) << "any byte";
}

TEST(PartsRecipe, IsNoneWhereTheMeshIsNotWhatTheSceneWasReadWith) {
  const Recipes recipes;
  scene::Scene scene = shipped("plane");
  scene.mesh_hashes.begin()->second = "0000000000000000";
  EXPECT_TRUE(recipes.of(scene).empty());
  scene.mesh_hashes.clear();
  EXPECT_TRUE(recipes.of(scene).empty());
}

TEST(PartsRecipe, BeginsWithADigestOfTheBuilders) {
  EXPECT_EQ(rendering::builders_digest().size(), 64U);
  EXPECT_NE(Recipes().of(shipped("plane")).find(rendering::builders_digest()), std::string::npos);
}

}  // namespace
}  // namespace voxtouch::test::parts_recipe
