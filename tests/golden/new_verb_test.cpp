/// `voxtouch new`: the file that it writes runs as it is.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace {

const std::filesystem::path kMeshes = std::filesystem::path(VOXTOUCH_DEPLOY) / "meshes";

class NewVerb : public testing::TestWithParam<const char*> {};

TEST_P(NewVerb, WritesASceneThatIsFeltAtOnce) {
  const TemporaryFolder out;
  const std::filesystem::path scene = out / "mine.yaml";
  const Finished made = voxtouch({"new", (kMeshes / GetParam()).string(), "--out", scene.string()});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(made.out.find("mended"), std::string::npos) << made.out;
  EXPECT_NE(made.out.find("Measured at 20 places"), std::string::npos) << made.out;
  for (const char* motion : {"press", "slide"}) {
    const Finished run =
        voxtouch({"up", scene.string(), "--motion", motion, "--lockstep", "--duration", "3",
                  "--no-record", "--one-process", "--domain", "55", "--json"});
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    EXPECT_GT(nlohmann::json::parse(run.out).at("max_force_n").get<double>(), 0.2) << motion;
  }
}
INSTANTIATE_TEST_SUITE_P(
    Shipped, NewVerb, testing::Values("cup_mm.stl", "block.obj", "plane.obj", "cylinder.obj"),
    [](const auto& test) {
      return std::string(test.param).substr(0, std::string(test.param).find('.'));
    });

TEST(NewVerb, NeverWritesOverAFile) {
  const TemporaryFolder out;
  const std::filesystem::path scene = out / "mine.yaml";
  std::ofstream(scene) << "mine\n";
  const Finished made =
      voxtouch({"new", (kMeshes / "block.obj").string(), "--out", scene.string()});
  EXPECT_EQ(made.status, 1);
  EXPECT_EQ(file_text(scene), "mine\n");
}

}  // namespace
}  // namespace voxtouch::test
