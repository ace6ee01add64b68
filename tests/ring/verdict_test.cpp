// The verdict of `voxtouch up` on disturbed runs: `up` is suspended, the bag is removed,
// unauthorised participants write.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <regex>
#include <thread>

#include "nodes/bus/reader.hpp"
#include "tests/ring/ring_run.hpp"
#include "tests/support/adversary.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;

bool comes(const std::function<bool()>& holds) {
  for (int i = 0; i < 1500; ++i, std::this_thread::sleep_for(milliseconds(20)))
    if (holds())
      return true;
  return false;
}
bool is_running(const Process& up) {
  return comes(
      [&] { return std::regex_search(up.err(), std::regex(" [1-9][0-9]* samples  force")); });
}
std::uint32_t domain() { return static_cast<std::uint32_t>(std::stoul(fresh_domain())); }

struct Ended {
  Finished end;
  nlohmann::json summary;
  bool problem(const char* words) const {
    return summary.is_object() && summary["problems"].dump().find(words) != std::string::npos;
  }
};
Ended finish(Process& up) {
  Ended reported{up.wait(std::chrono::seconds(60)), {}};
  reported.summary = parse_summary(reported.end.out);
  return reported;
}

/// Ctrl-Z, and fg after the device has ended: the state of the other samples is unknown.
TEST(Verdict, OfAStalledUpIsFailed) {
  Process up(
      up_arguments(shipped_scene("plane"), {"--motion", "free", "--duration", "3", "--no-record"}));
  ASSERT_TRUE(is_running(up)) << up.err();
  ASSERT_EQ(::kill(up.pid(), SIGSTOP), 0);
  const pid_t device = child_called(up.pid(), "voxtouch_device");
  ASSERT_NE(device, 0);
  // A child that has ended remains until `up` continues.
  EXPECT_TRUE(comes([&] {
    std::ifstream stat("/proc/" + std::to_string(device) + "/stat");
    const std::string text(std::istreambuf_iterator<char>(stat), {});
    return text.empty() || text.find(") Z") != std::string::npos;
  }));
  std::this_thread::sleep_for(milliseconds(2500));
  ::kill(up.pid(), SIGCONT);
  const Ended reported = finish(up);
  EXPECT_EQ(reported.end.status, 1) << reported.end.out;
  EXPECT_TRUE(reported.problem("no final status from device")) << reported.end.out;
  EXPECT_GT(reported.summary["limits"]["silence_s"]["value"], 2.0) << reported.end.out;
}

TEST(Verdict, FailsAtOnceIfTheBagIsRemoved) {
  const TemporaryFolder folder;
  Process up(up_arguments(shipped_scene("plane"), {"--motion", "free", "--duration", "4",
                                                   "--record", (folder / "bag").string()}));
  ASSERT_TRUE(is_running(up)) << up.err();
  ASSERT_TRUE(std::filesystem::remove(folder / "bag/bag_0.mcap"));
  EXPECT_TRUE(comes([&] { return up.err().find("was removed") != std::string::npos; })) << up.err();
  EXPECT_TRUE(up.running()) << "it is said when it happens";
  const Ended reported = finish(up);
  EXPECT_EQ(reported.end.status, 1) << reported.end.out;
  EXPECT_GT(reported.summary["recording"]["dropped"], 0) << reported.end.out;
}

TEST(Verdict, NamesForeignContactsAndDescriptions) {
  Process up(
      up_arguments(shipped_scene("plane"), {"--motion", "free", "--duration", "5", "--no-record"}));
  ASSERT_TRUE(is_running(up)) << up.err();
  Adversary unauthorised(domain(), "haptic");
  ASSERT_TRUE(comes([&] { return unauthorised.writer<msg::ContactState>().matched_count() >= 1; }));
  for (int i = 0; i < 200; ++i)
    unauthorised.write(msg::ContactState{}), std::this_thread::sleep_for(milliseconds(2));
  for (std::uint64_t i = 0; i < 20; ++i)
    unauthorised.write(msg::Recover{i, i});
  const Ended reported = finish(up);
  EXPECT_EQ(reported.end.status, 1) << reported.end.out;
  EXPECT_TRUE(reported.problem("another writer")) << reported.end.out;
  EXPECT_TRUE(reported.problem("coupling refused ")) << reported.end.out;
  EXPECT_NE(reported.summary["notes"].dump().find("rendering/contact"), std::string::npos)
      << reported.end.out;
  EXPECT_NE(reported.summary["notes"].dump().find("Recover messages"), std::string::npos)
      << reported.end.out;
}

/// A coupling that hangs for longer than its lease is lost. An unauthorised participant that claims
/// its role in the session gets no force through.
TEST(Roles, OfALostCouplingAreNotGrantedToOthers) {
  Process up(
      up_arguments(shipped_scene("plane"), {"--motion", "free", "--duration", "8", "--no-record"}));
  ASSERT_TRUE(is_running(up)) << up.err();
  Adversary unauthorised(domain(), "haptic");
  bus::Reader<msg::DeviceState> states(unauthorised.participant(), qos::kDeviceState, "haptic",
                                       qos::profile(qos::ProfileId::kTap));
  msg::DeviceState newest{};
  ASSERT_TRUE(comes([&] { return states.take(newest); }));
  const pid_t coupling = child_called(up.pid(), "voxtouch_coupling");
  ASSERT_NE(coupling, 0);
  const auto push = [&](int samples) {
    for (int i = 0; i < samples; ++i, std::this_thread::sleep_for(milliseconds(1))) {
      while (states.take(newest)) {
      }
      if (i % 100 == 0)
        unauthorised.claim("coupling", newest.session_id);
      msg::ForceCommand command{};
      command.session_id = newest.session_id, command.sequence_number = newest.sequence_number;
      command.sample_time_ns = newest.sample_time_ns,
      command.valid_until_ns = newest.sample_time_ns + 10'000'000;
      command.wrench.force.x = 3.0;
      unauthorised.write(command);
    }
  };
  push(200);
  ASSERT_EQ(::kill(coupling, SIGSTOP), 0);
  push(3500);
  ::kill(coupling, SIGCONT);
  const Ended reported = finish(up);
  EXPECT_EQ(reported.end.status, 1) << reported.end.out;
  ASSERT_TRUE(reported.summary.is_object()) << reported.end.out << reported.end.err;
  EXPECT_LT(reported.summary["max_force_n"], 1.0) << "the unauthorised 3 N reached the device";
  EXPECT_TRUE(reported.problem("another writer")) << reported.end.out;
}

}  // namespace
}  // namespace voxtouch::test
