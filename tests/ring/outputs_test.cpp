// Additional outputs of a ring: ROS standard types on demand, topics recorded on request, a start
// in contact.
#include <gtest/gtest.h>

#include <signal.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <thread>

#include "nodes/bus/reader.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;

std::uint32_t domain() { return static_cast<std::uint32_t>(std::stoul(fresh_domain())); }

void wait_until_it_runs(const Process& up) {
  for (int i = 0; i < 1500 && !runs(up); ++i)
    std::this_thread::sleep_for(milliseconds(20));
  ASSERT_TRUE(runs(up)) << up.err();
}

TEST(RosOutputs, PublishPoseWrenchFramesMarkersAndDiagnostics) {
  Process up(up_arguments(shipped_scene("cup"), {"--motion", "hit", "--no-record"}));
  wait_until_it_runs(up);
  const bus::Participant participant({domain(), "lo", "rviz"});
  bus::Reader<msg::geometry_msgs_PoseStamped> poses(participant, qos::kPose, "haptic",
                                                    qos::profile(qos::ProfileId::kState));
  bus::Reader<msg::geometry_msgs_WrenchStamped> wrenches(participant, qos::kWrench, "haptic",
                                                         qos::profile(qos::ProfileId::kState));
  bus::Reader<msg::tf2_msgs_TFMessage> frames(participant, qos::kTf, "haptic",
                                              qos::profile(qos::ProfileId::kState));
  bus::Reader<msg::visualization_msgs_MarkerArray> markers(participant, qos::kMarkers, "haptic",
                                                           qos::profile(qos::ProfileId::kState));
  bus::Reader<msg::diagnostic_msgs_DiagnosticArray> diagnostics(
      participant, qos::kDiagnostics, "haptic", qos::profile(qos::ProfileId::kState));
  int pose_count = 0, wrench_count = 0, frame_count = 0, marker_count = 0;
  std::set<std::string> diagnosed, frame_names;
  double height = -1.0;
  for (int i = 0; i < 300; ++i) {
    pose_count += poses.take_each([&](const auto& p) {
      height = p.pose.position.z;
      EXPECT_STREQ(p.header.frame_id, "world");
    });
    wrench_count +=
        wrenches.take_each([&](const auto& w) { EXPECT_STREQ(w.header.frame_id, "haptic/tool"); });
    frame_count += frames.take_each([&](const auto& t) {
      for (std::uint32_t k = 0; k < t.transforms._length; ++k)
        frame_names.insert(t.transforms._buffer[k].child_frame_id);
    });
    marker_count += markers.take_each([](const auto&) {});
    diagnostics.take_each([&](const auto& d) {
      for (std::uint32_t k = 0; k < d.status._length; ++k)
        diagnosed.insert(d.status._buffer[k].name);
    });
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_GT(pose_count, 100);
  EXPECT_GT(wrench_count, 100);
  EXPECT_GT(frame_count, 100);
  EXPECT_GT(marker_count, 10);
  EXPECT_NEAR(height, 0.05, 0.005) << "the hand of `hit` stays at half the cup's height";
  EXPECT_EQ(frame_names, (std::set<std::string>{"haptic/tool"}));
  EXPECT_EQ(diagnosed, (std::set<std::string>{"haptic/device", "haptic/rendering",
                                              "haptic/coupling", "haptic/validator"}));
  up.signal(SIGINT);
  EXPECT_EQ(up.wait().status, 0);
}

TEST(Logger, RecordsAnAdditionalTopic) {
  const TemporaryFolder folder;
  const RingResult r =
      run_ring(shipped_scene("plane"),
               {"--motion", "slide", "--duration", "3", "--record", (folder / "bag").string(),
                "--topic", "rt/haptic/pose", "--topic", "rt/t*"});
  ASSERT_EQ(r.process.status, 0) << r.process.err;
  const auto bag = bag::WholeBag::open(folder / "bag");
  ASSERT_TRUE(bag);
  for (const char* topic : {"/haptic/pose", "/tf"}) {
    const auto index = bag->find_topic(topic);
    ASSERT_TRUE(index) << topic;
    EXPECT_GT(bag->topics()[*index].message_count, 20U) << topic;
  }
  EXPECT_EQ(bag->topics()[*bag->find_topic("/tf")].type, "tf2_msgs/msg/TFMessage");
}

TEST(Logger, KilledLeavesABagWithoutTheLastSecondAtMost) {
  const TemporaryFolder folder;
  Process up(up_arguments(shipped_scene("plane"), {"--motion", "slide", "--duration", "60",
                                                   "--record", (folder / "bag").string()}));
  wait_until_it_runs(up);
  std::this_thread::sleep_for(std::chrono::seconds(3));
  for (const pid_t node : children_of(up.pid())) {
    std::ifstream command("/proc/" + std::to_string(node) + "/cmdline");
    std::string program;
    std::getline(command, program, '\0');
    if (program.ends_with("voxtouch_logger"))
      ::kill(node, SIGKILL);
  }
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1);
  EXPECT_NE(end.out.find("signal 9"), std::string::npos) << end.out;
  const auto states = read_ring_topic<msg::DeviceState>(folder / "bag", "/haptic/device/state");
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object());
  EXPECT_GT(static_cast<double>(states.size()) + 1500.0, summary["samples"].get<double>())
      << "more than a second is missing (half a second is the stop's)";
}

/// A scene of the plane with the hand starting 2 mm inside it.
std::filesystem::path pressed_scene(const TemporaryFolder& folder) {
  const std::filesystem::path file = folder / "pressed.yaml",
                              meshes = std::filesystem::path(VOXTOUCH_DEPLOY) / "meshes";
  std::ofstream(file) << "scene: pressed\nvoxel_size: 0.002\nstatic: [{mesh: "
                      << (meshes / "plane.obj").string()
                      << "}]\ndynamic: {mesh: " << (meshes / "sphere.obj").string()
                      << ", scale: 0.01, parts: [{sphere: {centre: [0, 0, 0], radius: 0.01}}]}\n"
                      << "contact: {model: adapted, stiffness_n_per_m: 10}\neffects: []\n"
                      << "coupling: {kind: shaping_filter, cutoff_hz: 90, damping_ratio: 0.7071, "
                         "gain: 1}\ndevice: {}\n"
                      << "motions: {press: {path: [[0, 0, 0.007]], speed_m_per_s: 0.1}}\n";
  return file;
}

TEST(Ring, RampsTheForceInWhenItStartsInsideAContact) {
  const TemporaryFolder folder;
  const RingResult r =
      run_ring(pressed_scene(folder).string(), {"--lockstep", "--motion", "press", "--duration",
                                                "2", "--record", (folder / "bag").string()});
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  const auto commands =
      read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command");
  const auto states = read_ring_topic<msg::DeviceState>(folder / "bag", "/haptic/device/state");
  ASSERT_EQ(commands.size(), 2000U);
  const auto force = [&](std::size_t i) { return std::abs(commands[i].wrench.force.z); };
  EXPECT_NE(commands[10].status & msg::force_command::kStatusRamping, 0U);
  EXPECT_GT(force(1999), 0.1);
  EXPECT_LT(force(0), 0.02 * force(1999));
  EXPECT_LT(force(20), 0.5 * force(1999));
  double fastest = 0.0;
  for (const auto& s : states)
    fastest = std::max(fastest, std::abs(s.twist.linear.z));
  EXPECT_LT(fastest, 0.02) << "the tool was thrown out instead of being pushed out";
}

TEST(Ring, ForceIsExactlyZeroAfterEachContact) {
  const TemporaryFolder folder;
  const RingResult r =
      run_ring(shipped_scene("cup"), {"--lockstep", "--motion", "slide", "--duration", "6",
                                      "--record", (folder / "bag").string()});
  ASSERT_EQ(r.process.status, 0) << r.process.err;
  const auto contacts =
      read_ring_topic<msg::ContactState>(folder / "bag", "/haptic/rendering/contact");
  const auto commands =
      read_ring_topic<msg::ForceCommand>(folder / "bag", "/haptic/coupling/command");
  ASSERT_EQ(contacts.size(), commands.size());
  int free_for = 0, checked = 0;
  bool touched = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const bool contact = contacts[i].surface_hits + contacts[i].interior_hits > 0;
    touched = touched || contact;
    free_for = contact ? 0 : free_for + 1;
    if (!touched || free_for < 200)
      continue;
    ++checked;
    ASSERT_EQ(commands[i].wrench.force.x, 0.0);
    ASSERT_EQ(commands[i].wrench.force.y, 0.0);
    ASSERT_EQ(commands[i].wrench.force.z, 0.0);
  }
  EXPECT_GT(checked, 500);
}

}  // namespace
}  // namespace voxtouch::test
