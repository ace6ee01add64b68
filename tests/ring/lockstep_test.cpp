// Lockstep: the same run gives bit-identical results, whatever else the machine does and however
// the nodes are spread.
#include <gtest/gtest.h>

#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <set>
#include <thread>

#include "core/types/geometry.hpp"
#include "tests/ring/ring_run.hpp"
#include "tests/support/bag_hash.hpp"

namespace voxtouch::test {
namespace {

/// Hash per topic, in the order of sequence numbers.
std::map<std::string, bag::TopicHash> hashes(const std::filesystem::path& folder) {
  const auto bag = bag::WholeBag::open(folder);
  if (!bag)
    throw std::runtime_error(bag.error().sentence);
  std::map<std::string, bag::TopicHash> all;
  for (const char* topic : {"device/state", "rendering/contact", "coupling/command", "validation",
                            "device/description", "rendering/plan", "coupling/design"}) {
    const bool latched = std::string(topic).find("description") != std::string::npos ||
                         std::string(topic).find("plan") != std::string::npos ||
                         std::string(topic).find("design") != std::string::npos;
    const auto hash = bag::hash_topic(*bag, std::string("/haptic/") + topic,
                                      latched ? bag::KeyOf{} : bag::ring_sequence_number);
    if (!hash)
      throw std::runtime_error(hash.error().sentence);
    all[topic] = *hash;
  }
  return all;
}

std::map<std::string, bag::TopicHash> lockstep_run(const TemporaryFolder& folder,
                                                   const std::string& name,
                                                   std::vector<std::string> more) {
  more.insert(more.end(), {"--lockstep", "--motion", "slide", "--duration", "4", "--record",
                           (folder / name).string()});
  const RingResult r = run_ring(shipped_scene("cup"), more);
  EXPECT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  EXPECT_TRUE(r.summary["ring_latency_us"]["p50"].is_null()) << "lockstep measures no latency";
  return hashes(folder / name);
}

/// The needed part of a bag's NodeStatus.
struct Status {
  std::string node;
  std::uint64_t session = 0;
  std::uint32_t state = 0;
};

/// CDR: strings with their length before them, numbers at multiples of their size behind the header
/// of 4 bytes.
Status status_of(const std::vector<std::byte>& bytes) {
  std::size_t at = 4;
  const auto number = [&](auto& value) {
    at = 4 + (at - 4 + sizeof value - 1) / sizeof value * sizeof value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
  };
  const auto text = [&] {
    std::uint32_t length = 0;
    number(length);
    const std::string word(reinterpret_cast<const char*>(bytes.data() + at), length - 1);
    at += length;
    return word;
  };
  Status status;
  std::uint32_t pid = 0;
  status.node = text();
  text();  // the host
  number(pid);
  at += 16;  // the participant
  number(status.session), number(status.state);
  return status;
}

TEST(Lockstep, StartsTheDeviceOnceItsPeersAreReady) {
  const TemporaryFolder folder;
  const RingResult r =
      run_ring(shipped_scene("plane"), {"--lockstep", "--motion", "hit", "--duration", "0.2",
                                        "--record", (folder / "bag").string()});
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  const auto bag = bag::WholeBag::open(folder / "bag");
  ASSERT_TRUE(bag) << bag.error().sentence;
  const auto messages = bag->read_topic("/haptic/node_status", bag::WholeBag::Order::kArrival);
  ASSERT_TRUE(messages) << messages.error().sentence;
  constexpr std::uint32_t kReady = 1;
  std::set<std::string> ready;
  for (const auto& message : *messages) {
    const Status status = status_of(message.bytes);
    if (status.node == "device")
      break;
    if (status.state == kReady && status.session == 0)
      ready.insert(status.node);
  }
  EXPECT_TRUE(ready.contains("rendering") && ready.contains("coupling")) << ready.size();
}

TEST(Lockstep, IsBitIdenticalUnderLoadAndInOneProcess) {
  const TemporaryFolder folder;
  const auto alone = lockstep_run(folder, "alone", {});
  std::atomic<bool> burn{true};
  std::vector<std::thread> burners;
  for (int i = 0; i < 2; ++i)
    burners.emplace_back([&burn] {
      volatile double x = 1.0;
      while (burn.load(std::memory_order_relaxed))
        x = x * 1.0000001;
    });
  const auto loaded = lockstep_run(folder, "loaded", {});
  burn = false;
  for (std::thread& burner : burners)
    burner.join();
  const auto together = lockstep_run(folder, "together", {"--one-process"});
  for (const auto& [topic, hash] : alone) {
    EXPECT_GT(hash.messages, 0U) << topic;
    EXPECT_TRUE(hash == loaded.at(topic)) << topic << " differs next to a CPU burner";
    EXPECT_TRUE(hash == together.at(topic)) << topic << " differs in one process";
  }
  for (const char* topic : {"device/state", "rendering/contact", "coupling/command"})
    EXPECT_EQ(alone.at(topic).messages, 4000U) << topic;
}

TEST(Lockstep, DiffersForAnotherSceneOrDevice) {
  const TemporaryFolder folder;
  EXPECT_FALSE(lockstep_run(folder, "phantom", {}).at("coupling/command") ==
               lockstep_run(folder, "lwr", {"--device", "sim-lwr"}).at("coupling/command"));
}

TEST(Lockstep, EndsWithZeroForceIfAPeerFallsSilent) {
  Process up(up_arguments(shipped_scene("plane"), {"--lockstep", "--motion", "slide", "--duration",
                                                   "3000", "--no-record"}));
  for (int i = 0; i < 1500 && !runs(up); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const pid_t coupling = child_called(up.pid(), "voxtouch_coupling");
  ASSERT_NE(coupling, 0);
  ::kill(coupling, SIGSTOP);  // silent, but still present
  std::this_thread::sleep_for(std::chrono::seconds(7));
  ::kill(coupling, SIGCONT);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1);
  EXPECT_NE(end.out.find("coupling is silent"), std::string::npos) << end.out << end.err;
}

struct Case {
  std::string scene, device;
  double max_force_n;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.scene << ", " << c.device; }

/// In one process: Lockstep.* above holds that its bits are those of five, and it takes less than
/// half of the time.
class ShippedScene : public testing::TestWithParam<Case> {
 protected:
  static RingResult run(const std::string& motion, const std::string& duration_s,
                        std::vector<std::string> more) {
    more.insert(more.end(), {"--lockstep", "--one-process", "--device", GetParam().device,
                             "--motion", motion, "--duration", duration_s});
    return run_ring(shipped_scene(GetParam().scene), more);
  }
  /// For a motion that touches: of a run of 6 s.
  static void expect_touch_that_the_validator_agrees_with(const RingResult& r) {
    EXPECT_GT(r.summary["contact_samples"], 500);
    EXPECT_EQ(r.summary["validator"]["disagree"], 0);
    EXPECT_GE(r.summary["validator"]["decided"],
              0.2 * r.summary["validator"]["checked"].get<double>());
    EXPECT_LT(r.summary["max_force_n"], 0.6 * GetParam().max_force_n);
  }
};

double magnitude(const msg::ForceCommand& c) {
  return std::hypot(c.wrench.force.x, c.wrench.force.y, c.wrench.force.z);
}

/// Largest difference between any two forces of the window, over the axes.
double peak_to_peak(const std::vector<msg::ForceCommand>& commands, std::size_t first,
                    std::size_t last) {
  Eigen::Array3d low = Eigen::Array3d::Constant(1e9), high = -low;
  for (std::size_t i = first; i < last; ++i) {
    const auto& f = commands[i].wrench.force;
    low = low.min(Eigen::Array3d(f.x, f.y, f.z));
    high = high.max(Eigen::Array3d(f.x, f.y, f.z));
  }
  return (high - low).maxCoeff();
}

TEST_P(ShippedScene, IsStableWhileHeldStillInContactForTwoSeconds) {
  const TemporaryFolder folder;
  const RingResult r = run("hit", "6", {"--record", (folder / "bag").string()});
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  expect_touch_that_the_validator_agrees_with(r);
  const auto commands =
      read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command");
  const auto touched = std::find_if(commands.begin(), commands.end(),
                                    [](const auto& c) { return magnitude(c) > 0.0; });
  const auto settled =
      static_cast<std::size_t>(touched - commands.begin()) + 400;  // the hand is at rest
  ASSERT_LE(settled + 2000, commands.size());
  for (std::size_t i = settled; i < settled + 2000; ++i)
    ASSERT_GT(magnitude(commands[i]), 0.02) << "the hand must stay in contact";
  const double p2p = peak_to_peak(commands, settled, settled + 2000);
  RecordProperty("peak_to_peak_n", std::to_string(p2p));
  EXPECT_LE(p2p, 0.05 * GetParam().max_force_n);
}

TEST_P(ShippedScene, GivesNoForceInFreeSpaceAndAfterIt) {
  const TemporaryFolder folder;
  const RingResult r = run("free", "2", {"--record", (folder / "bag").string()});
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  for (const auto& command :
       read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command"))
    ASSERT_EQ(magnitude(command), 0.0);
  EXPECT_EQ(r.summary["contact_samples"], 0);
}

/// The third motion, hit, is that of the case above.
TEST_P(ShippedScene, TouchesInEveryMotion) {
  for (const char* motion : {"slide", "circle"}) {
    SCOPED_TRACE(motion);
    const RingResult r = run(motion, "6", {"--no-record"});
    ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
    expect_touch_that_the_validator_agrees_with(r);
  }
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const char* scene : {"plane", "tilted_plane", "cylinder", "cup", "cup_field"})
    for (const auto& [device, limit] : {std::pair{"sim-phantom", 8.5}, std::pair{"sim-lwr", 150.0}})
      cases.push_back({scene, device, limit});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene, testing::ValuesIn(all_cases()), [](const auto& rig) {
  return rig.param.scene + (rig.param.device == "sim-lwr" ? "_lwr" : "_phantom");
});

/// Every effect has a scene: each is displayed, and the contact still agrees with the reference.
class EffectScene : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(EffectScene, DisplaysItsEffectAndTheReferenceContact) {
  const auto& [scene, motion] = GetParam();
  const TemporaryFolder folder;
  const RingResult r = run_ring(
      shipped_scene(scene), {"--lockstep", "--one-process", "--device", "sim-phantom", "--motion",
                             motion, "--duration", "5", "--record", (folder / "bag").string()});
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  EXPECT_GT(r.summary["contact_samples"], 500);
  EXPECT_EQ(r.summary["validator"]["disagree"], 0);
  EXPECT_LT(r.summary["max_force_n"], 0.6 * 8.5);
  double most = 0.0;
  for (const auto& contact :
       read_ring_topic<msg::ContactState>(folder / "bag", "/haptic/rendering/contact"))
    most = std::max(most, std::hypot(contact.effects_wrench.force.x, contact.effects_wrench.force.y,
                                     contact.effects_wrench.force.z));
  EXPECT_GT(most, 0.02) << "the effect gives a force";
}

INSTANTIATE_TEST_SUITE_P(
    All, EffectScene,
    testing::Values(std::pair{"cup_friction", "slide"}, std::pair{"cup_guide_line", "slide"},
                    std::pair{"cup_guide_plane", "slide"}, std::pair{"cup_guide_point", "slide"},
                    std::pair{"cup_magnet", "slide"}, std::pair{"cup_proximity", "slide"},
                    std::pair{"cup_surface_damping", "slide"}, std::pair{"cup_texture", "slide"},
                    std::pair{"cup_viscosity", "slide"}, std::pair{"objects", "slide"}),
    [](const auto& one) { return std::string(one.param.first); });

TEST(BlockScene, CanBeCarriedDroppedAndPushed) {
  for (const char* device : {"sim-phantom", "sim-lwr"}) {
    SCOPED_TRACE(device);
    const TemporaryFolder folder;
    const RingResult r =
        run_ring(shipped_scene("block"),
                 {"--lockstep", "--one-process", "--device", device, "--motion", "fall",
                  "--duration", "6.5", "--record", (folder / "bag").string()});
    ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
    EXPECT_EQ(r.summary["validator"]["disagree"], 0);
    const auto contacts =
        read_ring_topic<msg::ContactState>(folder / "bag", "/haptic/rendering/contact");
    const auto commands =
        read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command");
    ASSERT_EQ(contacts.size(), 6500u);
    constexpr double kWeight = 0.08 * 9.81, kSixth = 0.008 / 6.0,
                     kLies = 0.015 - 1e-4 * kSixth / 0.0016;  // the lower face is larger
    EXPECT_NEAR(-contacts[1400].wrench.force.z, kWeight, 0.05) << "held still in the air";
    EXPECT_NEAR(magnitude(commands[1400]), kWeight, 0.1) << "and the hand feels it";
    EXPECT_GT(contacts[1400].object_pose.position.z, 0.04);
    EXPECT_LT(magnitude(commands[1800]), 0.01) << "let go: what is left is the filter's tail";
    for (const std::size_t n : {1900u, 2400u, 2890u})
      EXPECT_NEAR(contacts[n].object_pose.position.z, kLies, 5e-5) << n;
    EXPECT_NEAR(contacts[2890].object_pose.position.x, contacts[1900].object_pose.position.x, 1e-5)
        << "it does not creep";
    const auto& pushed = contacts[5100];
    EXPECT_GT(pushed.object_pose.position.x, 0.03) << "along with the hand";
    EXPECT_NEAR(pushed.object_pose.position.z, kLies, 1e-3)
        << "over the table, however the hand lifts or presses";
    EXPECT_LT(pushed.object_pose.position.x, pushed.tool_pose.position.x)
        << "behind it: its friction pulls";
    EXPECT_LT(std::hypot(pushed.wrench.force.x, pushed.wrench.force.y), 0.5 * kWeight)
        << "no more than friction and what accelerates it by 1 m/s^2";
    EXPECT_GT(contacts[6400].object_pose.position.z, 0.02) << "lifted off again";
  }
}

}  // namespace
}  // namespace voxtouch::test
