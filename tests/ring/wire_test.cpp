// The hardware's drivers in the ring: the Phantom's at the simulated library, the robots' at their
// simulated controllers.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <thread>

#include "tests/ring/ring_run.hpp"
#include "tests/support/bag_hash.hpp"

namespace voxtouch::test {
namespace {

using Clock = std::chrono::steady_clock;

struct Case {
  std::string device, motion;
  bool lockstep;
  double limit_n;
  int seconds = 4;
};

std::string name_of(const Case& c) {
  std::string name = c.device + "_" + c.motion + (c.lockstep ? "_lockstep" : "_real_time");
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
void PrintTo(const Case& c, std::ostream* out) { *out << name_of(c); }

class WireTouchesTheCup : public testing::TestWithParam<Case> {};

/// An arm with insufficient connection quality follows without force: this is reported at once, and
/// the run fails.
TEST(WireWithoutForce, IsReportedAndFailsTheRun) {
  const RingResult r = run_ring(
      shipped_scene("cup"), {"--device", "emulated-lwr", "--device-option", "fault=quality@0:60:1",
                             "--motion", "slide", "--duration", "3", "--no-record"});
  EXPECT_EQ(r.process.status, 1);
  ASSERT_TRUE(r.summary.is_object()) << r.process.out;
  EXPECT_EQ(r.summary["ok"], false);
  EXPECT_EQ(r.summary["samples"], 3000);
  EXPECT_GE(r.summary["zero_force_samples"], 3000);
  EXPECT_EQ(r.summary["max_force_n"], 0.0);
  const std::string why = "the connection quality is too low to start";
  EXPECT_NE(r.summary["problems"].dump().find(why), std::string::npos) << r.process.out;
  EXPECT_NE(r.process.err.find(why), std::string::npos) << r.process.err;
}

// Deadlines are not checked: on a busy machine samples are late, and the displayed force stays
// right.
TEST_P(WireTouchesTheCup, AndDisplaysTheContact) {
  const Case& c = GetParam();
  std::vector<std::string> more = {"--device",   c.device,     "--motion",
                                   c.motion,     "--duration", std::to_string(c.seconds),
                                   "--no-record"};
  if (c.lockstep)
    more.push_back("--lockstep");
  const RingResult r = run_ring(shipped_scene("cup"), more);
  ASSERT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  ASSERT_TRUE(r.summary.is_object()) << r.process.out;
  EXPECT_EQ(r.summary["ok"], true);
  EXPECT_EQ(r.summary["samples"], 1000 * c.seconds);
  EXPECT_GT(r.summary["contact_samples"], 400);
  EXPECT_EQ(r.summary["validator"]["disagree"], 0) << r.process.out;
  EXPECT_GT(r.summary["validator"]["decided"], 0);
  EXPECT_GT(r.summary["max_force_n"], 0.1);
  EXPECT_LT(r.summary["max_force_n"], c.limit_n);
  EXPECT_EQ(r.summary["guard"]["clamped"], 0) << "a touch of the cup is far below the limits";
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const auto& [device, limit] :
       {std::pair{"emulated-phantom", 8.5}, std::pair{"emulated-lwr", 150.0}})
    for (const char* motion : {"slide", "hit"})
      for (const bool lockstep : {true, false})
        cases.push_back({device, motion, lockstep, limit});
  // The arm's controller permits no motion until its connection is good, which takes seconds on a
  // busy machine.
  for (Case& c : cases)
    if (c.device == "emulated-lwr" && !c.lockstep)
      c.seconds = 8;
  cases.push_back(
      {"emulated-fr3", "slide", false, 60.0, 3});  // in lockstep its bits are compared below
  return cases;
}
INSTANTIATE_TEST_SUITE_P(All, WireTouchesTheCup, testing::ValuesIn(all_cases()),
                         [](const auto& rig) { return name_of(rig.param); });

bag::TopicHash hash_of(const std::filesystem::path& folder, const std::string& topic) {
  const auto bag = bag::WholeBag::open(folder);
  if (!bag)
    throw std::runtime_error(bag.error().sentence);
  const auto hash = bag::hash_topic(*bag, "/haptic/" + topic, bag::ring_sequence_number);
  if (!hash)
    throw std::runtime_error(hash.error().sentence);
  return *hash;
}

class WireLockstep : public testing::TestWithParam<const char*> {};

TEST_P(WireLockstep, IsBitIdenticalTwiceAndInOneProcess) {
  const TemporaryFolder folder;
  // The second arm: its hand touches in the first second, and the first case has tested one process
  // and another hand.
  const bool arm = std::string(GetParam()) == "emulated-fr3";
  const auto run = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.end(), {"--device", GetParam(), "--lockstep", "--motion", "slide",
                             "--duration", arm ? "2" : "3", "--record", (folder / name).string()});
    const RingResult r = run_ring(shipped_scene("cup"), more);
    EXPECT_EQ(r.process.status, 0) << r.process.err << r.process.out;
  };
  run("first", {}), run("second", {});
  if (!arm)
    run("together", {"--one-process"}), run("other", {"--grip-change-time", "1"});
  for (const char* topic : {"device/state", "rendering/contact", "coupling/command"}) {
    const bag::TopicHash first = hash_of(folder / "first", topic);
    EXPECT_EQ(first.messages, arm ? 2000U : 3000U) << topic;
    EXPECT_TRUE(first == hash_of(folder / "second", topic)) << topic;
    if (arm)
      continue;
    EXPECT_TRUE(first == hash_of(folder / "together", topic)) << topic << " in one process";
    EXPECT_FALSE(first == hash_of(folder / "other", topic)) << topic << " does not see the hand";
  }
  EXPECT_GT(read_ring_topic<msg::ForceCommand>(folder / "first", "/haptic/coupling/command").size(),
            0U);
}

INSTANTIATE_TEST_SUITE_P(Both, WireLockstep,
                         testing::Values("emulated-phantom", "emulated-lwr", "emulated-fr3"),
                         [](const auto& rig) { return std::string(rig.param).substr(9); });

// --- faults

template <class Condition>
bool wait_until(Condition holds, std::chrono::seconds patience = std::chrono::seconds(30)) {
  for (const auto until = Clock::now() + patience; !holds();
       std::this_thread::sleep_for(std::chrono::milliseconds(20)))
    if (Clock::now() > until)
      return false;
  return true;
}

/// The figure `name` in the device's last word.
double last_figure(const std::filesystem::path& folder, const std::string& name) {
  const auto bag = bag::WholeBag::open(folder);
  if (!bag)
    throw std::runtime_error(bag.error().sentence);
  const auto messages = bag->read_topic("/haptic/node_status", bag::WholeBag::Order::kArrival);
  if (!messages)
    throw std::runtime_error(messages.error().sentence);
  const auto size = static_cast<char>(name.size() + 1);  // the name's length is stored before it
  const std::string in_cdr = std::string{size, '\0', '\0', '\0'} + name + '\0';
  const auto aligned = [](std::size_t at, std::size_t to) {
    return (at - 4 + to - 1) / to * to + 4;
  };  // 4: encapsulation
  double value = std::numeric_limits<double>::quiet_NaN();
  for (const auto& message : *messages) {
    const std::string text(reinterpret_cast<const char*>(message.bytes.data()),
                           message.bytes.size());
    const auto at = text.find(in_cdr);
    if (at == std::string::npos)
      continue;
    const std::size_t unit_at = aligned(at + in_cdr.size(), 4);
    std::uint32_t unit_size = 0;
    if (unit_at + 4 > text.size())
      continue;
    std::memcpy(&unit_size, text.data() + unit_at, sizeof unit_size);
    const std::size_t value_at = aligned(unit_at + 4 + unit_size, 8);
    if (value_at + 8 <= text.size())
      std::memcpy(&value, text.data() + value_at, sizeof value);
  }
  return value;
}

class ControllerKilled : public testing::TestWithParam<bool> {};

TEST_P(ControllerKilled, MidRunEndsTheDeviceAtZeroForce) {
  const TemporaryFolder folder;
  std::vector<std::string> more = {
      "--device",   "emulated-lwr", "--motion", "slide",
      "--duration", "3000",         "--record", (folder / "bag").string()};
  if (GetParam())
    more.push_back("--lockstep");
  Process up(up_arguments(shipped_scene("cup"), more));
  pid_t controller = 0;
  ASSERT_TRUE(wait_until([&] {
    const pid_t device = child_called(up.pid(), "voxtouch_device");
    controller = device ? child_called(device, "voxtouch_fri_controller") : 0;
    return controller != 0 && runs(up);
  })) << up.err();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  ::kill(controller, SIGKILL);
  const auto killed = Clock::now();
  const Finished end = up.wait();
  EXPECT_LT(Clock::now() - killed, std::chrono::seconds(20));
  EXPECT_EQ(end.status, 1);
  const auto summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out << end.err;
  EXPECT_EQ(summary["ok"], false);
  const std::string problem = summary["problems"].dump();
  EXPECT_NE(problem.find("signal 9"), std::string::npos) << problem;
  EXPECT_NE(problem.find("controller"), std::string::npos) << problem;
  EXPECT_GT(summary["max_force_n"], 0.1) << "it was displayed before";
  EXPECT_EQ(last_figure(folder / "bag", "force_n"), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Time, ControllerKilled, testing::Bool(), [](const auto& lockstep) {
  return lockstep.param ? "lockstep" : "real_time";
});

TEST(EmulatedLwr, KilledEndsItsController) {
  Process device({VOXTOUCH_BIN "/voxtouch_device", "--scene", shipped_scene("cup"), "--domain",
                  fresh_domain(), "--device", "emulated-lwr"});
  pid_t controller = 0;
  ASSERT_TRUE(wait_until([&] {
    return (controller = child_called(device.pid(), "voxtouch_fri_controller")) != 0;
  })) << device.err();
  device.signal(SIGKILL);
  EXPECT_TRUE(wait_until([&] { return ::kill(controller, 0) != 0; }, std::chrono::seconds(5)));
}

TEST(EmulatedLwr, ReportsTheReasonForWaitingAndEndsItsController) {
  Process device({VOXTOUCH_BIN "/voxtouch_device", "--scene", shipped_scene("cup"), "--domain",
                  fresh_domain(), "--device", "emulated-lwr", "--device-option",
                  "fault=quality@0:1.5:1", "--duration", "3"});
  pid_t controller = 0;
  ASSERT_TRUE(wait_until([&] {
    return (controller = child_called(device.pid(), "voxtouch_fri_controller")) != 0;
  })) << device.err();
  const Finished end = device.wait();
  EXPECT_EQ(end.status, 0) << end.err;
  EXPECT_NE(end.err.find("quality"), std::string::npos) << end.err;
  EXPECT_NE(::kill(controller, 0), 0) << "it is still there";
}

class LibraryFault : public testing::TestWithParam<bool> {};

TEST_P(LibraryFault, OfCommunicationEndsTheDeviceAtZeroForce) {
  const TemporaryFolder folder;
  std::vector<std::string> more = {"--device",        "emulated-phantom",
                                   "--device-option", "fault=comm_error@2",
                                   "--motion",        "slide",
                                   "--duration",      "60",
                                   "--record",        (folder / "bag").string()};
  if (GetParam())
    more.push_back("--lockstep");
  const RingResult r = run_ring(shipped_scene("cup"), more);
  EXPECT_EQ(r.process.status, 1);
  ASSERT_TRUE(r.summary.is_object()) << r.process.out << r.process.err;
  EXPECT_EQ(r.summary["ok"], false);
  const std::string problem = r.summary["problems"].dump();
  EXPECT_NE(problem.find("error 0x0302"), std::string::npos) << problem;
  EXPECT_GT(r.summary["max_force_n"], 0.1) << "it was displayed before";
  EXPECT_LT(r.summary["samples"], 2100);
  EXPECT_EQ(last_figure(folder / "bag", "force_n"), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Time, LibraryFault, testing::Bool(), [](const auto& lockstep) {
  return lockstep.param ? "lockstep" : "real_time";
});

// --- without hardware

/// A test must not start a device that is there: no library, and a robot that could only be on this
/// machine.
bool no_hardware(const std::string& device) {
  return device != "phantom" || (dlopen("libHD.so", RTLD_LAZY) == nullptr &&
                                 dlopen("libHD.so.3.4", RTLD_LAZY) == nullptr &&
                                 dlopen("libHD.so.3.0", RTLD_LAZY) == nullptr);
}

struct Absent {
  std::string device, named;
  std::vector<std::string> more;
};
void PrintTo(const Absent& a, std::ostream* out) { *out << a.device; }

class NoHardware : public testing::TestWithParam<Absent> {};

TEST_P(NoHardware, IsReportedWithinSeconds) {
  const auto& [device, named, options] = GetParam();
  if (!no_hardware(device))
    GTEST_SKIP() << "the vendor's library is installed";
  std::vector<std::string> more = {"--device", device, "--duration", "1", "--no-record"};
  more.insert(more.end(), options.begin(), options.end());
  const auto begin = Clock::now();
  const RingResult r = run_ring(shipped_scene("cup"), more);
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(20));  // three of them the wait for a robot
  EXPECT_EQ(r.process.status, 1);
  ASSERT_TRUE(r.summary.is_object()) << r.process.out << r.process.err;
  EXPECT_EQ(r.summary["ok"], false);
  EXPECT_EQ(r.summary["problems"].size(), 1U) << r.summary["problems"];
  const std::string problem = r.summary["problems"].dump();
  EXPECT_NE(problem.find(named), std::string::npos) << problem;
  EXPECT_NE(problem.find("--device emulated-" + device), std::string::npos) << problem;
}

INSTANTIATE_TEST_SUITE_P(
    Both, NoHardware,
    testing::Values(Absent{"phantom", "libHD.so", {}},
                    Absent{"lwr", "UDP 127.0.0.1:49938", {"--device-option", "address=127.0.0.1"}},
                    Absent{"fr3", "TCP 127.0.0.1:1337", {"--device-option", "address=127.0.0.1"}}),
    [](const auto& rig) { return rig.param.device; });

}  // namespace
}  // namespace voxtouch::test
