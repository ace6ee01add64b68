// `voxtouch up` in real time: the five nodes as processes or as one, over real DDS on loopback.
#include <gtest/gtest.h>

#include <signal.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <thread>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/node_registry.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

bool wait_until(const std::function<bool()>& holds, seconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (!holds()) {
    if (std::chrono::steady_clock::now() > until)
      return false;
    std::this_thread::sleep_for(milliseconds(20));
  }
  return true;
}

void expect_a_good_touch(const RingResult& r, double duration_s, double limit_n) {
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  ASSERT_TRUE(r.summary.is_object()) << r.process.out;
  EXPECT_EQ(r.summary["samples"], static_cast<std::uint64_t>(duration_s * 1000));
  EXPECT_GT(r.summary["contact_samples"], 100);
  EXPECT_GT(r.summary["max_force_n"], 0.05);
  EXPECT_LE(r.summary["max_force_n"], limit_n);
  EXPECT_GT(r.summary["ring_latency_us"]["p50"], 0.0);
  EXPECT_EQ(r.summary["validator"]["disagree"], 0) << r.process.err;
  EXPECT_GE(r.summary["validator"]["decided"],
            0.2 * r.summary["validator"]["checked"].get<double>());
  EXPECT_EQ(r.summary["recording"]["dropped"], 0);
}

struct Rig {
  std::string device;
  double limit_n;
  bool one_process;
};

void PrintTo(const Rig& rig, std::ostream* out) {
  *out << rig.device << (rig.one_process ? ", one process" : "");
}

class UpTouchesTheCup : public testing::TestWithParam<Rig> {};

TEST_P(UpTouchesTheCup, AndDisplaysTheContact) {
  const TemporaryFolder folder;
  std::vector<std::string> more = {
      "--device", GetParam().device,        "--motion", "slide", "--duration", "5",
      "--record", (folder / "bag").string()};
  if (GetParam().one_process)
    more.push_back("--one-process");
  const RingResult r = run_ring(shipped_scene("cup"), more);
  expect_a_good_touch(r, 5.0, GetParam().limit_n);
  const auto bag = bag::WholeBag::open(folder / "bag");
  ASSERT_TRUE(bag) << bag.error().sentence;
  for (const char* topic :
       {"/haptic/device/state", "/haptic/rendering/contact", "/haptic/coupling/command",
        "/haptic/device/description", "/haptic/rendering/plan", "/haptic/coupling/design",
        "/haptic/validation", "/haptic/node_status"}) {
    const auto index = bag->find_topic(topic);
    ASSERT_TRUE(index) << topic;
    EXPECT_GT(bag->topics()[*index].message_count, 0U) << topic;
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, UpTouchesTheCup,
                         testing::Values(Rig{"sim-phantom", 8.5, false},
                                         Rig{"sim-lwr", 150.0, false},
                                         Rig{"sim-phantom", 8.5, true}),
                         [](const auto& rig) {
                           std::string name =
                               rig.param.device + (rig.param.one_process ? "_in_one_process" : "");
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(Up, RefusesARigInUse) {
  Process first(up_arguments(shipped_scene("plane"), {"--motion", "free", "--no-record"}));
  ASSERT_TRUE(wait_until([&] { return runs(first); }, seconds(30))) << first.err();
  Process second(
      up_arguments(shipped_scene("plane"), {"--motion", "free", "--no-record", "--duration", "1"}));
  const Finished refused = second.wait();
  EXPECT_NE(refused.status, 0);
  EXPECT_NE(refused.err.find("'haptic'"), std::string::npos) << refused.err;
  first.signal(SIGINT);
  EXPECT_EQ(first.wait().status, 0);
}

TEST(Up, OnlyOneOfTwoConcurrentStartsRuns) {
  for (const int later_ms :
       {0, 30, 90, 180, 270}) {  // before, during and after the search of the first one
    const auto arguments = up_arguments(shipped_scene("plane"),
                                        {"--motion", "free", "--no-record", "--duration", "0.2"});
    Process one(arguments);
    std::this_thread::sleep_for(milliseconds(later_ms));
    Process other(arguments);
    const Finished ends[] = {one.wait(), other.wait()};
    const auto loser = [](const Finished& end) {
      return end.err.find("Rig 'haptic' is in use") != std::string::npos;
    };
    ASSERT_EQ(loser(ends[0]) + loser(ends[1]), 1) << later_ms << " ms later\n"
                                                  << ends[0].err << "\n--\n"
                                                  << ends[1].err;
    const Finished& winner = ends[loser(ends[0]) ? 1 : 0];
    EXPECT_GT(parse_summary(winner.out)["samples"], 100) << winner.out << winner.err;
  }
}

/// A participant on a port of the domain may be a ring that answers late on a busy machine: `up`
/// waits the full half second.
TEST(Up, RefusesARigThatAnswersLate) {
  const bus::Participant participant(
      {static_cast<std::uint32_t>(std::stoul(fresh_domain())), "lo", "a ring"});
  bus::Writer<msg::RigClaim> claims(participant, qos::kRigClaim, "haptic",
                                    qos::profile(qos::ProfileId::kStatus));
  runtime::NodeRegistry registry(participant, "haptic");
  Process up(up_arguments(shipped_scene("plane"),
                          {"--motion", "free", "--no-record", "--duration", "0.2"}));
  ASSERT_TRUE(runtime::look_for(
      registry, [](const runtime::NodeReport& report) { return report.node == "up"; }, seconds(30)))
      << up.err();
  std::this_thread::sleep_for(milliseconds(250));
  msg::RigClaim held{};
  char host[] = "other";
  held.host = host, held.state = msg::rig_claim::kStateActive;
  std::memcpy(held.participant, participant.guid().data(), participant.guid().size());
  claims.write(held);
  const Finished end = up.wait();
  EXPECT_NE(end.status, 0);
  EXPECT_TRUE(end.err.contains("'haptic'")) << end.err;
}

TEST(Up, CtrlCStopsInOrderAndReportsACutRun) {
  const TemporaryFolder folder;
  Process up(up_arguments(shipped_scene("plane"), {"--motion", "slide", "--duration", "60",
                                                   "--record", (folder / "bag").string()}));
  ASSERT_TRUE(wait_until([&] { return runs(up); }, seconds(30))) << up.err();
  const std::vector<pid_t> nodes = children_of(up.pid());
  EXPECT_EQ(nodes.size(), 5U);
  up.signal(SIGINT);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1) << end.err;
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out;
  EXPECT_NE(summary["problems"][0].get<std::string>().find("stopped before"), std::string::npos);
  EXPECT_TRUE(bag::WholeBag::open(folder / "bag"));
  for (const pid_t node : nodes)
    EXPECT_NE(::kill(node, 0), 0) << "node " << node << " is still there";
}

TEST(Up, KilledEndsItsNodes) {
  Process up(up_arguments(shipped_scene("plane"), {"--motion", "slide", "--no-record"}));
  ASSERT_TRUE(wait_until([&] { return runs(up); }, seconds(30))) << up.err();
  const std::vector<pid_t> nodes = children_of(up.pid());
  ASSERT_EQ(nodes.size(), 4U);
  up.signal(SIGKILL);
  EXPECT_TRUE(
      wait_until([&] { return std::all_of(nodes.begin(), nodes.end(), has_ended); }, seconds(10)));
}

TEST(Up, ReportsADeadNodeAndLeavesAReadableBag) {
  const TemporaryFolder folder;
  Process up(up_arguments(shipped_scene("plane"), {"--motion", "slide", "--duration", "60",
                                                   "--record", (folder / "bag").string()}));
  ASSERT_TRUE(wait_until([&] { return runs(up); }, seconds(30))) << up.err();
  ::kill(child_called(up.pid(), "voxtouch_rendering"), SIGKILL);  // a child of ours' child
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1);
  EXPECT_NE(end.out.find("signal 9"), std::string::npos) << end.out << end.err;
  EXPECT_TRUE(bag::WholeBag::open(folder / "bag"));
}

TEST(Up, NeverOverwritesABag) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "bag");
  std::ofstream(folder / "bag" / "precious") << "mine";
  const RingResult r = run_ring(shipped_scene("plane"), {"--motion", "free", "--duration", "1",
                                                         "--record", (folder / "bag").string()});
  EXPECT_NE(r.process.status, 0);
  EXPECT_NE(r.process.err.find((folder / "bag").string()), std::string::npos) << r.process.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "bag" / "precious"));
}

TEST(Up, FollowsOneCommandWriterAndNamesTheOther) {
  Process up(
      up_arguments(shipped_scene("plane"), {"--motion", "free", "--duration", "4", "--no-record"}));
  ASSERT_TRUE(wait_until([&] { return runs(up); }, seconds(30))) << up.err();
  const bus::Participant participant(
      {static_cast<std::uint32_t>(std::stoul(fresh_domain())), "lo", "intruder"});
  const auto& stream = qos::profile(qos::ProfileId::kStream);
  bus::Writer<msg::ForceCommand> intruder(participant, qos::kForceCommand, "haptic", stream);
  bus::Reader<msg::DeviceState> states(participant, qos::kDeviceState, "haptic",
                                       qos::profile(qos::ProfileId::kTap));
  msg::DeviceState newest{};
  ASSERT_TRUE(wait_until([&] { return states.take(newest); }, seconds(10)));
  for (int i = 0; i < 1000; ++i) {
    while (states.take(newest)) {
    }
    msg::ForceCommand command{};
    command.session_id = newest.session_id;
    command.sequence_number = newest.sequence_number;
    command.sample_time_ns = newest.sample_time_ns;
    command.valid_until_ns = newest.sample_time_ns + 10'000'000;
    command.wrench.force.x = 5.0;
    intruder.write(command);
    std::this_thread::sleep_for(milliseconds(1));
  }
  const Finished end = up.wait();
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out << end.err;
  EXPECT_EQ(end.status, 1);
  EXPECT_NE(end.out.find("another writer"), std::string::npos) << end.out;
  EXPECT_GT(summary["guard"]["refused"], 100);
  EXPECT_LT(summary["max_force_n"], 1.0) << "the intruder's 5 N reached the device";
}

TEST(Up, RefusesWhatIsImpossibleWithAMessage) {
  const auto refusal = [](const std::string& scene, std::vector<std::string> more) {
    more.insert(more.end(), {"--duration", "1", "--no-record"});
    const RingResult r = run_ring(scene, more);
    EXPECT_NE(r.process.status, 0);
    EXPECT_TRUE(r.summary.is_object() && r.summary["ok"] == false &&
                r.summary["problems"].size() == 1)
        << r.process.out;
    return r.process.err;
  };
  const std::string plane = shipped_scene("plane");
  EXPECT_NE(refusal(plane, {"--motion", "moonwalk"}).find("'moonwalk'"), std::string::npos);
  EXPECT_NE(refusal(plane, {"--device", "sim-omni"}).find("sim-phantom"), std::string::npos);
  EXPECT_NE(
      refusal(plane, {"--device", "emulated-lwr", "--device-option", "prot=1"}).find("period_ms"),
      std::string::npos);
  EXPECT_NE(refusal(plane, {"--interface", "no_such_if0"}).find("no_such_if0"), std::string::npos);
  const RingResult nowhere = run_ring("/nowhere/scene.yaml", {"--duration", "1", "--no-record"});
  EXPECT_NE(nowhere.process.status, 0);
  EXPECT_NE(nowhere.process.err.find("/nowhere/scene.yaml"), std::string::npos)
      << nowhere.process.err;
}

/// The plane with another stiffness of each point.
/// The plane with stiffer points and a coupling that is set by hand: a designed one would cap them.
std::filesystem::path stiff_plane(const TemporaryFolder& folder, double stiffness_n_per_m) {
  std::ifstream in(shipped_scene("plane"));
  std::ofstream out(folder / "stiff.yaml");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("contact:"))
      line =
          "contact: {model: adapted, stiffness_n_per_m: " + std::to_string(stiffness_n_per_m) + "}";
    if (line.starts_with("coupling:"))
      line = "coupling: {kind: shaping_filter, cutoff_hz: 90, damping_ratio: 0.7071, gain: 1}";
    if (const auto at = line.find("../meshes"); at != std::string::npos)
      line.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    out << line << "\n";
  }
  return folder / "stiff.yaml";
}

TEST(Up, RefusesASceneTooStiffForTheDevice) {
  const TemporaryFolder folder;
  const RingResult r = run_ring(stiff_plane(folder, 2000.0).string(),
                                {"--motion", "hit", "--duration", "1", "--no-record"});
  EXPECT_NE(r.process.status, 0);
  EXPECT_NE(r.process.err.find("sim-phantom"), std::string::npos) << r.process.err;
}

TEST(Up, ReportsThatAllPointsWereTooStiff) {
  const TemporaryFolder folder;
  const RingResult r =
      run_ring(stiff_plane(folder, 100.0).string(),
               {"--motion", "slide", "--duration", "3", "--no-record", "--lockstep"});
  EXPECT_EQ(r.process.status, 1);
  EXPECT_NE(r.process.out.find("all contact points"), std::string::npos) << r.process.out;
}

TEST(Up, ReportsFileLineAndColumnOfASceneError) {
  const TemporaryFolder folder;
  std::ofstream(folder / "bad.yaml") << "scene: bad\nvoxel_size: 0.002\nstatik: []\n";
  const RingResult r = run_ring((folder / "bad.yaml").string(), {"--duration", "1", "--no-record"});
  EXPECT_NE(r.process.status, 0);
  EXPECT_NE(r.process.err.find("bad.yaml:3:1:"), std::string::npos) << r.process.err;
}

TEST(Nodes, ReportDifferentScenes) {
  const std::string domain = fresh_domain();
  Process rendering(
      {VOXTOUCH_BIN "/voxtouch_rendering", "--scene", shipped_scene("cup"), "--domain", domain});
  Process device({VOXTOUCH_BIN "/voxtouch_device", "--scene", shipped_scene("plane"), "--domain",
                  domain, "--duration", "3"});
  EXPECT_EQ(device.wait().status, 0);
  rendering.signal(SIGTERM);
  const std::string said = rendering.wait().err;
  EXPECT_NE(said.find("'cup'"), std::string::npos) << said;
  EXPECT_NE(said.find("'plane'"), std::string::npos) << said;
}

TEST(Nodes, MayStartInAnyOrder) {
  const std::string scene = shipped_scene("plane"), domain = fresh_domain();
  const auto node = [&](const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> a = {VOXTOUCH_BIN "/voxtouch_" + name, "--scene", scene, "--domain",
                                  domain};
    a.insert(a.end(), more.begin(), more.end());
    return std::make_unique<Process>(a);
  };
  const auto device =
      node("device", {"--motion", "slide", "--duration", "6"});  // first, with none to answer it
  std::this_thread::sleep_for(seconds(1));
  const auto coupling = node("coupling");
  std::this_thread::sleep_for(milliseconds(500));
  const auto rendering = node("rendering");
  const bus::Participant participant(
      {static_cast<std::uint32_t>(std::stoul(domain)), "lo", "listener"});
  bus::Reader<msg::ForceCommand> commands(participant, qos::kForceCommand, "haptic",
                                          qos::profile(qos::ProfileId::kTap));
  double largest = 0.0;
  msg::ForceCommand command;
  while (device->running()) {
    while (commands.take(command))
      largest = std::max(largest, std::hypot(command.wrench.force.x, command.wrench.force.y,
                                             command.wrench.force.z));
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_EQ(device->wait().status, 0);
  EXPECT_GT(largest, 0.05);
  for (const auto& other : {coupling.get(), rendering.get()}) {
    EXPECT_TRUE(other->running()) << "a node must outlive its device and wait for the next";
    other->signal(SIGTERM);
    EXPECT_EQ(other->wait().status, 0);
  }
}

}  // namespace
}  // namespace voxtouch::test
