// The ring's loops allocate nothing after their start; what Cyclone DDS itself allocates is counted and said.
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <thread>

#include "tests/ring/process.hpp"

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

TEST(Allocation, OursIsZeroInDeviceRenderingAndCouplingLoops) {
  const TemporaryFolder folder;
  const std::string scene = std::string(VOXTOUCH_DEPLOY) + "/scenes/cup.yaml", domain = fresh_domain();
  const auto node = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> a = {VOXTOUCH_BIN "/voxtouch_" + name, "--scene", scene, "--domain", domain};
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
    std::printf("%s: ours %ld, Cyclone DDS %ld in 4 s (%.3f a sample)\n", name, count.ours, count.dds, per_sample);
    RecordProperty(std::string(name) + "_dds_allocations_per_sample", std::to_string(per_sample));
  }
}

TEST(Allocation, IsSeenByTheCounterWhereItHappens) {
  const TemporaryFolder folder;
  // The command line itself allocates in its main thread: the counter must see that.
  Process up({VOXTOUCH_BIN "/voxtouch", "--help"}, {{"LD_PRELOAD", VOXTOUCH_COUNTER},
                                                    {"VOXTOUCH_COUNT_FILE", (folder / "up").string()},
                                                    {"VOXTOUCH_COUNT_FROM_S", "0"},
                                                    {"VOXTOUCH_COUNT_TO_S", "60"}});
  up.wait();
  EXPECT_GT(read_count(folder / "up").ours, 10);
}

}  // namespace
}  // namespace voxtouch::test
