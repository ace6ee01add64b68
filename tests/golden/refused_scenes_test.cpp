/// Scenes that cannot be built: each is refused with a sentence, by the library and by the command
/// line.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include <fmt/format.h>

#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"
#include "core/voxmap/grid_mesh.hpp"
#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace {

// A sanitizer's shadow memory is terabytes of addresses.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr const char* kLimit = "";
#else
constexpr const char* kLimit = "ulimit -v 1000000; ";
#endif
const std::filesystem::path kMeshes = std::filesystem::path(VOXTOUCH_DEPLOY) / "meshes";

class RefusedScene : public testing::Test {
 protected:
  /// A scene file of the sphere over a static mesh; `more` are further keys of that.
  std::filesystem::path scene(const std::string& mesh, const std::string& more = "",
                              double voxel_m = 0.002) const {
    std::ofstream(folder_ / "scene.yaml") << fmt::format(
        "scene: refused\nvoxel_size: {}\nstatic:\n  - {{mesh: {}{}}}\ndynamic: {{mesh: {}, scale: "
        "0.01}}\n"
        "contact: {{model: adapted, stiffness_n_per_m: 10}}\n",
        voxel_m, mesh, more, (kMeshes / "sphere.obj").string());
    return folder_ / "scene.yaml";
  }
  /// The exception from reading the file to a built scene, as text; empty without one.
  static std::string refusal(const std::filesystem::path& file) {
    try {
      rendering::build_scene(scene::load_scene(file), serial_for());
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
  /// The same through `voxtouch probe`, with the address space limited to 1 GB.
  Finished probed(const std::filesystem::path& file) const {
    return shell(
        fmt::format("{}printf 'qw,qx,qy,qz,tx,ty,tz\\n1,0,0,0,0,0,0\\n' | "
                    "\"$VOXTOUCH\" probe '{}' --poses -",
                    kLimit, file.string()));
  }
  void expect_refused(const std::filesystem::path& file, const std::string& says) const {
    const std::string sentence = refusal(file);
    EXPECT_NE(sentence.find(says), std::string::npos)
        << "'" << sentence << "' does not hold: " << says;
    const Finished run = probed(file);
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_NE(run.err.find(says), std::string::npos) << run.err;
  }

  TemporaryFolder folder_;
};

TEST_F(RefusedScene, CannotBeBuilt) {
  const std::filesystem::path file = scene((kMeshes / "cup.obj").string());
  EXPECT_EQ(refusal(file), "");
  const Finished run = probed(file);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out, "");
}

TEST_F(RefusedScene, HasAMeshFileWithoutReadPermission) {
  std::filesystem::copy_file(kMeshes / "cup.obj", folder_ / "locked.obj");
  chmod((folder_ / "locked.obj").c_str(), 0);
  std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
  // The unprivileged user may not reach the project's folder: all files of the scene are in the
  // test's folder.
  std::filesystem::copy_file(kMeshes / "sphere.obj", folder_ / "sphere.obj");
  const std::filesystem::path locked = folder_ / "locked.yaml";
  std::ofstream(locked) << "scene: locked\nvoxel_size: 0.002\nstatic: [{mesh: "
                           "locked.obj}]\ndynamic: {mesh: sphere.obj, scale: 0.01}\n"
                           "contact: {model: adapted, stiffness_n_per_m: 10}\n";
  const uid_t me = geteuid();
  ASSERT_EQ(seteuid(me == 0 ? 65534 : me), 0);  // root may read everything: be none for this line
  const std::string sentence = refusal(locked);
  ASSERT_EQ(seteuid(me), 0);
  EXPECT_NE(sentence.find("locked.obj"), std::string::npos) << sentence;
}

TEST_F(RefusedScene, HasAMeshFileThatCannotBeRead) {
  const std::filesystem::path unreadable =
      "/proc/self/mem";  // at its start nothing is mapped: fails for root as well
  ASSERT_TRUE(std::filesystem::exists(unreadable)) << "/proc must be mounted";
  std::filesystem::create_symlink(unreadable, folder_ / "broken.obj");
  expect_refused(scene("broken.obj"), "broken.obj");
}

TEST_F(RefusedScene, HasAnEmptyMesh) {
  std::ofstream(folder_ / "empty.obj");
  expect_refused(scene("empty.obj"), "empty.obj");
  std::ofstream(folder_ / "points.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refused(scene("points.obj"), "points.obj");
  std::ofstream(folder_ / "empty.stl") << std::string(84, '\0');
  expect_refused(scene("empty.stl"), "empty.stl");
}

TEST_F(RefusedScene, NeedsMoreMemoryThanAVoxmapMayTake) {
  const std::string cup = (kMeshes / "cup.obj").string();
  for (const auto& [more, voxel] : {std::pair{", scale: 1000", 0.002}, std::pair{"", 1e-6}}) {
    const std::filesystem::path file = scene(cup, more, voxel);
    const auto begin = std::chrono::steady_clock::now();
    const std::string sentence = refusal(file);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(spent.count(), 1.0);
    EXPECT_NE(sentence.find("TiB"), std::string::npos) << sentence;
    expect_refused(file, "larger voxel size");
  }
  EXPECT_THROW(rendering::build_scene(scene::load_scene(scene(cup, ", scale: 1000")), serial_for()),
               voxmap::VoxelBudgetError);
}

}  // namespace
}  // namespace voxtouch::test
