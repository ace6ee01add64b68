// A scene with the contact model `field`: built parts, skipped parts, warnings and refusals.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <algorithm>

#include "core/rendering/build.hpp"
#include "tests/unit/scene/scene_fixture.hpp"

namespace voxtouch::rendering {
namespace {

bool any_has(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& s) { return s.find(text) != std::string::npos; });
}

/// A box from 0 to `size` in OBJ; `faces` of its twelve triangles.
std::string box_obj(const Vec3& size, std::size_t faces = 12) {
  std::string text;
  for (int n = 0; n < 8; ++n)
    text += "v " + std::to_string(n & 1 ? size.x() : 0.0) + " " +
            std::to_string(n & 2 ? size.y() : 0.0) + " " + std::to_string(n & 4 ? size.z() : 0.0) +
            "\n";
  const char* const all[] = {"1 3 2", "2 3 4", "5 6 7", "6 8 7", "1 2 5", "2 6 5",
                             "3 7 4", "4 7 8", "1 5 3", "3 5 7", "2 4 6", "4 8 6"};
  for (std::size_t n = 0; n < faces; ++n)
    text += "f " + std::string(all[n]) + "\n";
  return text;
}

class FieldScene : public scene::SceneFolder {
 protected:
  void SetUp() override {
    scene::SceneFolder::SetUp();
    write("ball.obj", box_obj({0.01, 0.01, 0.01}));
    write("thick.obj", box_obj({0.08, 0.08, 0.06}));
    write("thin.obj", box_obj({0.08, 0.08, 0.005}));
    write("open.obj", box_obj({0.08, 0.08, 0.06}, 11));
  }
  std::unique_ptr<BuiltScene> built(const std::string& meshes, const std::string& contact,
                                    std::optional<contact::ContactModelKind> model = {}) const {
    return build_scene(parse("scene: s\nvoxel_size: 0.002\nstatic: [" + meshes +
                             "]\ndynamic: {mesh: ball.obj}\ncontact: {" + contact + "}\n"),
                       serial_for(), {.model = model});
  }
  static constexpr const char* kField = "model: field, stiffness_n_per_m3: 1.0e7";
  static constexpr const char* kAdapted = "stiffness_n_per_m: 30";
};

TEST_F(FieldScene, BuildsTheFieldOnlyForItsModel) {
  const auto with = built("{mesh: thick.obj}", kField),
             without = built("{mesh: thick.obj}", kAdapted);
  ASSERT_NE(with->field(), nullptr);
  EXPECT_EQ(with->renderer().model(), contact::ContactModelKind::kField);
  EXPECT_EQ(without->field(), nullptr);
  EXPECT_TRUE(any_has(with->plan().built, "24 mm inside"));
  EXPECT_FALSE(any_has(with->plan().skipped, "distance field"));
  EXPECT_FALSE(any_has(without->plan().built, "distance field"));
  EXPECT_TRUE(any_has(without->plan().skipped, "distance field"));
  EXPECT_EQ(with->plan().bytes - without->plan().bytes, with->field()->bytes());
  EXPECT_GT(with->plan().expected_ns_per_frame, without->plan().expected_ns_per_frame);
  // Requested on the command line, for a scene with another model.
  EXPECT_NE(built("{mesh: thick.obj}", kAdapted, contact::ContactModelKind::kField)->field(),
            nullptr);
  EXPECT_EQ(built("{mesh: thick.obj}", kField, contact::ContactModelKind::kAdapted)->field(),
            nullptr);
}

TEST_F(FieldScene, WarnsOfTheThinnestBodyOnly) {
  EXPECT_FALSE(any_has(built("{mesh: thick.obj}", kField)->plan().warnings, "thinnest"));
  const auto thin = built("{mesh: thick.obj}, {mesh: thin.obj, position: [0, 0, 0.1]}", kField);
  ASSERT_TRUE(any_has(thin->plan().warnings, "thinnest"));
  for (const char* figure : {"about 5 mm", "2.5 voxels", "to a depth of 2.5 mm"})
    EXPECT_TRUE(any_has(thin->plan().warnings, figure)) << figure;
  EXPECT_FALSE(any_has(built("{mesh: thin.obj}", kAdapted)->plan().warnings, "thinnest"));
}

/// As `virtual_tool_runs plates` measures it: walls of a quarter to one voxel 0.7 degrees,
/// of 1.25 voxels askew 5.7, of 2.5 voxels 0.2 (95 %).
/// Neither thin walls nor open ones are a limit for a virtual tool, but open ones can be entered.
TEST_F(FieldScene, WarnsOfOpenMeshesAloneForAVirtualTool) {
  const char* const kTool = "rendering: virtual_tool}\ncoupling: {design: auto";
  write("wall.obj", box_obj({0.08, 0.08, 0.001}));
  EXPECT_TRUE(built("{mesh: wall.obj}", kTool)->plan().warnings.empty());
  for (const char* const meshes :
       {"{mesh: open.obj}", "{mesh: thick.obj}, {mesh: open.obj, position: [0, 0, 0.1]}"})
    EXPECT_TRUE(any_has(built(meshes, kTool)->plan().warnings,
                        "open.obj: the mesh is open. It holds a virtual tool from either side."));
}

TEST_F(FieldScene, OnlyOpenMeshIsNamedAndRefused) {
  const auto both = built("{mesh: thick.obj}, {mesh: open.obj, position: [0, 0, 0.1]}", kField);
  EXPECT_TRUE(any_has(both->plan().warnings, "open.obj: "));
  EXPECT_FALSE(any_has(both->plan().warnings, "thick.obj: "));
  const auto refusal = [&](const std::string& meshes) {
    try {
      built(meshes, kField);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("no exception");
  };
  EXPECT_NE(refusal("{mesh: open.obj}").find("closed"), std::string::npos);
  write("sheet.obj", box_obj({0.08, 0.08, 0.0004}));
  EXPECT_NE(refusal("{mesh: sheet.obj, position: [0, 0, 0.0011]}").find("corner"),
            std::string::npos);
}

TEST_F(FieldScene, ThePlansStiffnessBoundsEveryFrame) {
  const auto scene = built("{mesh: thick.obj}", kField);
  const Plan& plan = scene->plan();
  double most = 0.0;
  for (int n = 0; n < 600; ++n) {
    const Pose pose{Vec3(0.04 + 0.00008 * n, 0.03, 0.059 - 0.00002 * n),
                    Quat(Eigen::AngleAxisd(0.01 * n, Vec3::UnitY()))};
    const contact::ContactResult r = scene->renderer().probe(pose);
    EXPECT_LE(r.stiffness_bound_n_per_m, plan.contact_n_per_m.all_points * (1 + 1e-12));
    const Mat3 rotation = r.stiffness.bottomRightCorner<3, 3>();
    EXPECT_LE(
        Eigen::SelfAdjointEigenSolver<Mat3>(rotation, Eigen::EigenvaluesOnly).eigenvalues()[2],
        plan.contact_nm_per_rad.all_points * (1 + 1e-12));
    most = std::max(most, r.stiffness_bound_n_per_m);
  }
  EXPECT_GT(most, 0.2 * plan.contact_n_per_m.all_points);
}

}  // namespace
}  // namespace voxtouch::rendering
