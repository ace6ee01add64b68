// Samples of device and coupling before a fault are stored next to the bag, and never after a
// passed run.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <thread>

#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;

double force_n(const msg::ForceCommand& c) {
  return std::hypot(c.wrench.force.x, c.wrench.force.y, c.wrench.force.z);
}

/// The shipped plane, and a hand that presses on it without end.
std::filesystem::path pressed_scene(const std::filesystem::path& folder) {
  std::ifstream in(shipped_scene("plane"));
  std::ofstream out(folder / "pressed.yaml");
  for (std::string line; std::getline(in, line);) {
    if (const auto at = line.find("../meshes"); at != std::string::npos)
      line.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    out << line << "\n";
    if (line.starts_with("motions:"))
      out << "  press: {path: [[0.003, 0.002, 0.04], [0.003, 0.002, 0.007]], speed_m_per_s: 0.1, "
             "hold_s: 0.1}\n";
  }
  return folder / "pressed.yaml";
}

std::vector<std::filesystem::path> records(const std::filesystem::path& folder,
                                           const std::string& node) {
  std::vector<std::filesystem::path> found;
  for (int n = 1; std::filesystem::exists(folder / (node + std::to_string(n)) / "fault.json"); ++n)
    found.push_back(folder / (node + std::to_string(n)));
  return found;
}

/// Largest force of the last second, of the last line that `up` has printed.
double printed_force_n(const std::string& lines) {
  const std::regex pattern("force +([0-9.]+) N");
  double last = 0.0;
  for (std::sregex_iterator it(lines.begin(), lines.end(), pattern), end; it != end; ++it)
    last = std::stod((*it)[1]);
  return last;
}

/// A busy machine may cause other records, before and after the kill. The contact continues, so
/// each contains force.
TEST(FaultRecord, HoldsTwoSecondsBeforeAKill) {
  const TemporaryFolder folder;
  Process up(up_arguments(pressed_scene(folder.path()), {"--motion", "press", "--duration", "60",
                                                         "--record", (folder / "bag").string()}));
  for (int i = 0; i < 1500 && printed_force_n(up.err()) < 0.1; ++i)
    std::this_thread::sleep_for(milliseconds(20));
  ASSERT_GT(printed_force_n(up.err()), 0.1) << up.err();
  std::this_thread::sleep_for(milliseconds(500));
  const std::size_t before = records(folder / "bag_faults", "device_").size();
  ASSERT_LT(before, 8U) << "the machine leaves no record for the kill";
  ::kill(child_called(up.pid(), "voxtouch_rendering"), SIGKILL);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1);
  std::vector<std::filesystem::path> device = records(folder / "bag_faults", "device_"),
                                     coupling = records(folder / "bag_faults", "coupling_");
  ASSERT_GT(device.size(), before) << end.out << end.err;
  ASSERT_FALSE(coupling.empty()) << end.out << end.err;
  EXPECT_NE(end.out.find((folder / "bag_faults" / "device_").string()), std::string::npos)
      << end.out;

  // The longest of those caused by the kill: each fault begins a new record.
  device.erase(device.begin(), device.begin() + static_cast<std::ptrdiff_t>(before));
  const auto length = [](const std::filesystem::path& record) {
    return read_ring_topic<msg::DeviceState>(record, "/haptic/device/state").size();
  };
  const std::filesystem::path record = std::ranges::max(device, {}, length);
  const auto states = read_ring_topic<msg::DeviceState>(record, "/haptic/device/state");
  const auto given = read_ring_topic<msg::ForceCommand>(record, "/haptic/device/given");
  ASSERT_GT(states.size(), 100U);
  ASSERT_LE(states.size(), 2000U);
  ASSERT_EQ(given.size(), states.size());
  EXPECT_TRUE(std::ranges::is_sorted(states, {}, &msg::DeviceState::sequence_number));
  EXPECT_GT(force_n(std::ranges::max(given, {}, force_n)), 0.05) << "it was in contact";
  EXPECT_GT(read_ring_topic<msg::ForceCommand>(record, "/haptic/coupling/command").size(),
            states.size() / 2);
  EXPECT_FALSE(
      read_ring_topic<msg::ContactState>(coupling.back(), "/haptic/rendering/contact").empty());
  // The bag of the run has the same samples.
  const auto recorded = read_ring_topic<msg::DeviceState>(folder / "bag", "/haptic/device/state");
  const auto same =
      std::ranges::find(recorded, states[50].sequence_number, &msg::DeviceState::sequence_number);
  ASSERT_NE(same, recorded.end());
  EXPECT_EQ(std::memcmp(&*same, &states[50], sizeof *same), 0);
}

/// 35 kN/m at the hand of a device that can show 800 N/m, through a coupling set by hand that is
/// hardly damped.
std::filesystem::path unstable_scene(const std::filesystem::path& folder) {
  std::ifstream in(shipped_scene("plane"));
  std::ofstream out(folder / "unstable.yaml");
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("coupling:"))
      line = "coupling: {kind: shaping_filter, cutoff_hz: 5, damping_ratio: 0.1, gain: 1}";
    if (line.starts_with("contact:"))
      line = "contact: {model: field, stiffness_n_per_m3: 3e7}";
    if (const auto at = line.find("../meshes"); at != std::string::npos)
      line.replace(at, 9, std::string(VOXTOUCH_DEPLOY) + "/meshes");
    out << line << "\n";
  }
  return folder / "unstable.yaml";
}

TEST(FaultLatch, HoldsAfterInstabilityUntilRecover) {
  const TemporaryFolder folder;
  Process up(up_arguments(unstable_scene(folder.path()), {"--motion", "hit", "--duration", "0",
                                                          "--record", (folder / "bag").string()}));
  const auto receives = [&](const char* words) {
    for (int i = 0; i < 1500 && up.err().find(words) == std::string::npos; ++i)
      std::this_thread::sleep_for(milliseconds(20));
    return up.err().find(words) != std::string::npos;
  };
  ASSERT_TRUE(receives("voxtouch recover")) << up.err();
  std::this_thread::sleep_for(milliseconds(1200));
  Process recover(
      std::vector<std::string>{VOXTOUCH_BIN "/voxtouch", "recover", "--domain", fresh_domain()});
  const Finished said = recover.wait();
  EXPECT_EQ(said.status, 0) << said.out << said.err;
  EXPECT_NE(said.out.find("coupling reset"), std::string::npos) << said.out;
  std::this_thread::sleep_for(milliseconds(1500));
  up.signal(SIGINT);
  const Finished end = up.wait();
  EXPECT_EQ(end.status, 1);
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out;
  EXPECT_NE(summary["problems"].dump().find("coupling latched"), std::string::npos) << end.out;
}

TEST(FaultLatch, HasNothingToResetWithoutAFault) {
  Process recover(std::vector<std::string>{VOXTOUCH_BIN "/voxtouch", "recover", "--rig", "absent",
                                           "--domain", fresh_domain(), "--json"});
  const Finished said = recover.wait();
  EXPECT_EQ(said.status, 1);
  EXPECT_NE(said.out.find("'absent'"), std::string::npos) << said.out;
}

TEST(FaultRecord, IsAbsentForAPassedRun) {
  const TemporaryFolder folder;
  const RingResult r =
      run_ring(shipped_scene("cup"), {"--lockstep", "--one-process", "--motion", "slide",
                                      "--duration", "3", "--record", (folder / "bag").string()});
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  EXPECT_FALSE(std::filesystem::exists(folder / "bag_faults"));
}

}  // namespace
}  // namespace voxtouch::test
