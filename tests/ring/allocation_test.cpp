// The ring's loops allocate nothing after their start; allocations of Cyclone DDS are counted and
// printed.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <thread>

#include "tests/support/process/process.hpp"

namespace voxtouch::test {
namespace {

struct Count {
  long ours = -1, dds = -1;
};

Count read_count(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string word;
  Count count;
  in >> word >> count.ours >> word >> count.dds;
  return count;
}

TEST(Allocation, LoopsOfAllNodesAllocateNothing) {
  const TemporaryFolder folder;
  const std::string scene = std::string(VOXTOUCH_DEPLOY) + "/scenes/cup.yaml",
                    domain = fresh_domain();
  const auto node = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> a = {VOXTOUCH_BIN "/voxtouch_" + name, "--scene", scene, "--domain",
                                  domain};
    a.insert(a.end(), more.begin(), more.end());
    return std::make_unique<Process>(
        a, std::map<std::string, std::string>{{"LD_PRELOAD", VOXTOUCH_COUNTER},
                                              {"VOXTOUCH_COUNT_FILE", (folder / name).string()},
                                              {"VOXTOUCH_COUNT_FROM_S", "4"},
                                              {"VOXTOUCH_COUNT_TO_S", "8"}});
  };
  const auto rendering = node("rendering", {}), coupling = node("coupling", {});
  const auto device = node("device", {"--motion", "slide", "--duration", "10"});
  EXPECT_EQ(device->wait().status, 0);
  rendering->signal(15), coupling->signal(15);
  EXPECT_EQ(rendering->wait().status, 0);
  EXPECT_EQ(coupling->wait().status, 0);
  for (const char* name : {"device", "rendering", "coupling"}) {
    const Count count = read_count(folder / name);
    EXPECT_EQ(count.ours, 0) << name;
    EXPECT_GE(count.dds, 0) << name;
    const double per_sample = static_cast<double>(count.dds) / 4000.0;
    std::printf("%s: ours %ld, Cyclone DDS %ld in 4 s (%.3f a sample)\n", name, count.ours,
                count.dds, per_sample);
    RecordProperty(std::string(name) + "_dds_allocations_per_sample", std::to_string(per_sample));
  }
}

TEST(Allocation, RenderingLoopAllocatesNothingDuringChanges) {
  const TemporaryFolder folder;
  std::ifstream in(std::string(VOXTOUCH_DEPLOY) + "/scenes/plane.yaml");
  std::string scene((std::istreambuf_iterator<char>(in)), {});
  const std::string plain = "effects: []", meshes = "../meshes";
  scene.replace(scene.find(plain), plain.size(), "effects: [{viscosity: {damping_ns_per_m: 2}}]");
  for (std::size_t at; (at = scene.find(meshes)) != std::string::npos;)
    scene.replace(at, meshes.size(), std::string(VOXTOUCH_DEPLOY) + "/meshes");
  const std::string file = (folder / "oily.yaml").string(), domain = fresh_domain();
  std::ofstream(file) << scene;
  Process rendering({VOXTOUCH_BIN "/voxtouch_rendering", "--scene", file, "--domain", domain},
                    {{"LD_PRELOAD", VOXTOUCH_COUNTER},
                     {"VOXTOUCH_COUNT_FILE", (folder / "rendering").string()},
                     {"VOXTOUCH_COUNT_FROM_S", "2"},
                     {"VOXTOUCH_COUNT_TO_S", "7"}});
  Process device({VOXTOUCH_BIN "/voxtouch_device", "--scene", file, "--domain", domain, "--motion",
                  "slide", "--duration", "9"});
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  const auto change = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {VOXTOUCH_BIN "/voxtouch", "change", "--domain", domain});
    const Finished end = Process(words).wait();
    EXPECT_EQ(end.status, 0) << end.err;
  };
  change({"viscosity", "off", "on", "gain", "0.5", "damping_ns_per_m=1"});
  change({"--reload", "--voxel-size",
          "0.0015"});  // the old scene fades out and is freed within the window
  EXPECT_EQ(device.wait().status, 0);
  rendering.signal(15);
  EXPECT_EQ(rendering.wait().status, 0);
  EXPECT_EQ(read_count(folder / "rendering").ours, 0);
}

TEST(Allocation, OfTheCommandLineIsCounted) {
  const TemporaryFolder folder;
  // The command line itself allocates in its main thread: the counter must see that.
  Process up({VOXTOUCH_BIN "/voxtouch", "--help"},
             {{"LD_PRELOAD", VOXTOUCH_COUNTER},
              {"VOXTOUCH_COUNT_FILE", (folder / "up").string()},
              {"VOXTOUCH_COUNT_FROM_S", "0"},
              {"VOXTOUCH_COUNT_TO_S", "60"}});
  up.wait();
  EXPECT_GT(read_count(folder / "up").ours, 10);
}

}  // namespace
}  // namespace voxtouch::test
