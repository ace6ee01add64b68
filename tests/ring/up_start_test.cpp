// Start of `voxtouch up`: the order of nodes, and what remains of a scene and a device that do not
// fit.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <string>

#include "nodes/runtime/node_registry.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

/// The shipped scene with a line replaced: that which begins with `begin`.
std::string scene_with(const TemporaryFolder& folder, const std::string& shipped,
                       const std::string& begin, const std::string& line) {
  std::ifstream in(shipped_scene(shipped));
  std::ofstream out(folder / "scene.yaml");
  for (std::string text; std::getline(in, text);) {
    if (text.starts_with(begin))
      text = line;
    if (const auto at = text.find("../meshes"); at != std::string::npos)
      text.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    out << text << "\n";
  }
  return (folder / "scene.yaml").string();
}

/// One reason, no bag, nothing that a device did.
void expect_refused(const TemporaryFolder& folder, const RingResult& r, const std::string& reason) {
  EXPECT_EQ(r.process.status, 1) << r.process.err;
  ASSERT_TRUE(r.summary.is_object()) << r.process.out << r.process.err;
  EXPECT_EQ(r.summary["ok"], false);
  ASSERT_EQ(r.summary["problems"].size(), 1U) << r.process.out;
  EXPECT_NE(r.summary["problems"][0].get<std::string>().find(reason), std::string::npos)
      << r.process.out;
  EXPECT_FALSE(std::filesystem::exists(folder / "bag"));
}

class UpRefuses : public testing::TestWithParam<std::vector<std::string>> {
 protected:
  RingResult run(const std::string& scene) const {
    std::vector<std::string> words = GetParam();
    words.insert(words.end(),
                 {"--motion", "slide", "--duration", "1", "--record", (folder_ / "bag").string()});
    return run_ring(scene, words);
  }
  TemporaryFolder folder_;
};

TEST_P(UpRefuses, ASceneWithoutAFeasibleCoupling) {
  const RingResult r = run(scene_with(folder_, "cup_virtual_tool",
                                      "coupling:", "coupling: {design: auto, hand: any_passive}"));
  expect_refused(folder_, r, "cannot run on sim-phantom: No stable coupling");
}

TEST_P(UpRefuses, AnInvalidScene) {
  std::ofstream(folder_ / "bad.obj") << "v 0 0 0\n";
  const RingResult r =
      run(scene_with(folder_, "plane", "  - mesh: ../meshes/plane.obj", "  - mesh: bad.obj"));
  expect_refused(folder_, r, "bad.obj");
}

INSTANTIATE_TEST_SUITE_P(Variants, UpRefuses,
                         testing::Values(std::vector<std::string>{},
                                         std::vector<std::string>{"--lockstep"},
                                         std::vector<std::string>{"--one-process"},
                                         std::vector<std::string>{"--one-process", "--lockstep"}));

/// A scene that takes a second: earlier device samples would have no force, and count to the run's
/// duration.
TEST(UpStart, TheDeviceBeginsWhenTheSceneIsBuilt) {
  for (const char* option : {"--no-report", "--one-process"}) {
    const TemporaryFolder folder;
    const bus::Participant participant(
        {static_cast<std::uint32_t>(std::stoul(fresh_domain())), "lo", "onlooker"});
    runtime::NodeRegistry registry(participant, "haptic");
    Process up(up_arguments(scene_with(folder, "cup_field", "voxel_size:", "voxel_size: 0.0005"),
                            {"--motion", "slide", "--duration", "0.2", "--no-record", option}));
    const auto device = runtime::look_for(
        registry, [](const runtime::NodeReport& report) { return report.node == "device"; },
        std::chrono::seconds(60));
    ASSERT_TRUE(device) << up.err();
    const auto rendering = registry.find("rendering");
    ASSERT_TRUE(rendering) << "the device began before the rendering had built the scene";
    EXPECT_TRUE(rendering->figures.contains("warnings"));
    up.wait();
  }
}

}  // namespace
}  // namespace voxtouch::test
