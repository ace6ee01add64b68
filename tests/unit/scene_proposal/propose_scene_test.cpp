#include "core/scene_proposal/propose_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/scene/scene_file.hpp"
#include "core/scene_proposal/scene_text.hpp"
#include "tests/unit/scene_proposal/boxes.hpp"

namespace voxtouch::scene_proposal {
namespace {

using test::box;

ProposedScene proposal(const mesh::TriangleMesh& part, Tool tool = {}) {
  return propose_scene(part, mesh::inspect(part), tool);
}

TEST(ProposedScene, HasFourVoxelsInAWall) {
  const ProposedScene scene = proposal(box({0, 0, 0}, {0.1, 0.08, 0.0032}));
  EXPECT_NEAR(scene.voxel_size_m, 0.0008, 1e-9);
}

TEST(ProposedScene, BoundsTheVoxelsOfAVeryThinAndOfASolidPart) {
  EXPECT_NEAR(proposal(box({0, 0, 0}, {0.2, 0.2, 0.0002})).voxel_size_m, 0.2 / 220,
              0.05 * 0.2 / 220);
  EXPECT_NEAR(proposal(box({0, 0, 0}, {0.2, 0.2, 0.2})).voxel_size_m, 0.2 / 100, 0.05 * 0.2 / 100);
}

TEST(ProposedScene, PrintsWhatHoldsTheToolOfClosedAndOpenParts) {
  mesh::TriangleMesh part = box({0, 0, 0}, {0.1, 0.1, 0.1});
  const auto says = [&](const char* what) {
    const std::vector<std::string> reasons = proposal(part).reasons;
    return std::ranges::any_of(reasons,
                               [&](const std::string& reason) { return reason.contains(what); });
  };
  EXPECT_TRUE(says("The part is closed"));
  part.triangles.pop_back();
  EXPECT_TRUE(says("The part is open"));
}

TEST(ProposedScene, ComesDownWithTheToolsLowestPointOverTheMiddle) {
  const Tool stylus{.sphere = false, .reach_m = 0.05, .lowest_T = Vec3(0.002, 0.001, -0.04)};
  const ProposedScene scene = proposal(box({0, 0, 0}, {0.1, 0.08, 0.02}), stylus);
  const Vec3 begin = scene.press_W.front() + stylus.lowest_T,
             end = scene.press_W.back() + stylus.lowest_T;
  EXPECT_LT((begin - Vec3(0.05, 0.04, begin.z())).norm(), 1e-12);
  EXPECT_GT(begin.z(), 0.02);
  EXPECT_LT(end.z(), 0.02);
}

TEST(ProposedScene, RefusesAPointOfAPart) {
  mesh::TriangleMesh point{.vertices = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, .triangles = {{0, 1, 2}}};
  EXPECT_THROW(proposal(point), std::invalid_argument);
}

TEST(SceneText, IsASceneForAnyFileNames) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "voxtouch_first_scene";
  std::filesystem::create_directories(folder);
  SceneNames names{.scene = scene_name("a part: \"#1\"\n"),
                   .part_file = "a \"part\": #1\\{}.stl",
                   .tool_file = "b.obj",
                   .part_scale = 0.001,
                   .tool_scale = 0.01};
  for (const std::string& file : {names.part_file, names.tool_file})
    std::ofstream(folder / file) << "v 0 0 0\n";
  std::ofstream(folder / "scene.yaml")
      << scene_text(proposal(box({0, 0, 0}, {0.1, 0.08, 0.02})), names);
  const scene::Scene scene = scene::load_scene(folder / "scene.yaml");
  EXPECT_EQ(scene.name, "a_part____1__");
  EXPECT_EQ(scene.static_meshes.at(0).path.filename(), names.part_file);
  EXPECT_EQ(scene.motions.size(), 2u);
  EXPECT_TRUE(scene.virtual_tool());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace voxtouch::scene_proposal
