// The hardware's drivers in the ring, each against what is simulated where the hardware stands: the vendor's library, the
// controller's network protocol.
#include <gtest/gtest.h>

#include "core/types/geometry.hpp"
#include "nodes/bag/bag_hash.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

std::vector<std::string> touching(const std::string& device, const std::string& motion, const std::filesystem::path& bag) {
  return {"--device", device, "--motion", motion, "--duration", "4", "--record", bag.string()};
}

void expect_a_good_touch(const RingResult& run, double max_force_n) {
  ASSERT_EQ(run.process.status, 0) << run.process.err << run.process.out;
  EXPECT_GT(run.summary["contact_samples"].get<int>(), 500);
  EXPECT_EQ(run.summary["validator"]["disagree"], 0);
  EXPECT_GT(run.summary["validator"]["agree"].get<int>(), 10);
  EXPECT_GT(run.summary["max_force_n"].get<double>(), 0.1);
  EXPECT_LE(run.summary["max_force_n"].get<double>(), max_force_n);
  EXPECT_EQ(run.summary["guard"]["refused"], 0);
}

struct Wired {
  const char* device;
  double max_force_n;
};
void PrintTo(const Wired& w, std::ostream* out) { *out << w.device; }

class WiredDevice : public testing::TestWithParam<Wired> {};

TEST_P(WiredDevice, TouchesTheCupInLockstepAndGivesTheSameBitsAgain) {
  const TemporaryFolder folder;
  for (const char* name : {"one", "two"}) {
    std::vector<std::string> more = touching(GetParam().device, "slide", folder / name);
    more.push_back("--lockstep");
    expect_a_good_touch(run_ring(shipped_scene("cup"), more), GetParam().max_force_n);
  }
  const auto one = bag::BagReader::open(folder / "one"), two = bag::BagReader::open(folder / "two");
  ASSERT_TRUE(one && two);
  for (const char* topic : {"/haptic/device/state", "/haptic/rendering/contact", "/haptic/coupling/command"}) {
    const auto a = bag::hash_topic(*one, topic, bag::ring_sequence_number);
    const auto b = bag::hash_topic(*two, topic, bag::ring_sequence_number);
    ASSERT_TRUE(a && b) << topic;
    EXPECT_EQ(*a, *b) << topic;
  }
}

TEST_P(WiredDevice, IsStruckAgainstTheCup) {
  const TemporaryFolder folder;
  std::vector<std::string> more = touching(GetParam().device, "hit", folder / "bag");
  more.push_back("--lockstep");
  expect_a_good_touch(run_ring(shipped_scene("cup"), more), GetParam().max_force_n);
}

TEST_P(WiredDevice, TouchesTheCupInRealTime) {
  const TemporaryFolder folder;
  expect_a_good_touch(run_ring(shipped_scene("cup"), touching(GetParam().device, "slide", folder / "bag")),
                      GetParam().max_force_n);
}

INSTANTIATE_TEST_SUITE_P(Counterparts, WiredDevice, testing::Values(Wired{"wire-phantom", 8.5}, Wired{"wire-lwr", 150.0}));

TEST(HardwareThatIsNotThere, IsNamedWithWhatWasTriedAndWhatToDo) {
  const RingResult phantom =
      run_ring(shipped_scene("plane"), {"--device", "phantom", "--duration", "1", "--no-record"});
  EXPECT_EQ(phantom.process.status, 1);
  EXPECT_NE(phantom.process.err.find("libHD.so"), std::string::npos) << phantom.process.err;
  EXPECT_NE(phantom.process.err.find("OpenHaptics"), std::string::npos);
  const RingResult lwr = run_ring(shipped_scene("plane"), {"--device", "lwr", "--duration", "1", "--no-record"});
  EXPECT_EQ(lwr.process.status, 1);
  EXPECT_NE(lwr.process.err.find("UDP"), std::string::npos) << lwr.process.err;
  EXPECT_NE(lwr.process.err.find("friOpen"), std::string::npos);
}

}  // namespace
}  // namespace voxtouch::test
