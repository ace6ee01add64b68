// The verdict of `voxtouch up` on disturbed runs: `up` is suspended, the bag is removed,
// unauthorised participants write.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <map>
#include <regex>
#include <string_view>
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

TEST(Verdict, NamesAMovedFolderAsTheCauseOfLosses) {
  const TemporaryFolder folder;
  Process up(up_arguments(shipped_scene("plane"), {"--motion", "free", "--duration", "4",
                                                   "--record", (folder / "bag").string()}));
  ASSERT_TRUE(is_running(up)) << up.err();
  std::filesystem::rename(folder / "bag", folder / "moved");
  EXPECT_TRUE(comes([&] { return up.err().contains("removed or replaced"); })) << up.err();
  const Ended reported = finish(up);
  EXPECT_EQ(reported.end.status, 1) << reported.end.out;
  EXPECT_TRUE(reported.end.err.contains("see the error above")) << reported.end.err;
  EXPECT_FALSE((reported.end.err + reported.end.out).contains("too slow")) << reported.end.err;
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

/// A node that hangs for longer than its lease is lost. An unauthorised participant claims its role
/// in the session and sends a force of 3 N, or samples of another device.
class LostRole : public testing::TestWithParam<const char*> {
 protected:
  static constexpr int kLeaseMs = 2600;  ///< the DDS lease, and the time until its end is noticed
  static constexpr std::uint64_t kForeign = 1'000'000'000;  ///< first number of foreign samples

  LostRole() {
    // It has a writer on every topic that a binding requires.
    unauthorised.writer<msg::EffectChanged>(), unauthorised.writer<msg::ExternalSample>();
    unauthorised.writer<msg::CouplingDesign>(), unauthorised.writer<msg::DeviceDescription>();
    unauthorised.writer<msg::DeviceState>();
  }
  static bool plays(std::string_view role) { return role == GetParam(); }
  bool is_complete() {
    poll();
    return plans.matched_count() > 0 && answer.session_id != 0;
  }
  /// Takes the newest samples of the device and of the rendering; counts samples with force and
  /// contacts of foreign samples.
  void poll() {
    msg::DeviceState state{};
    while (states.take(state)) {
      if (state.sequence_number >= kForeign)
        continue;
      newest = state;
      with_force += (state.flags & msg::device_state::kFlagForceOn) != 0;
    }
    contacts.take_each([this](const msg::ContactState& contact, const dds_sample_info_t&) {
      if (contact.sequence_number >= kForeign)
        ++foreign_rendered;
      else if (contact.session_id == newest.session_id && contact.wrench.force.x < 3.0)
        answer = contact;
    });
  }
  /// A rendering is followed only after its plan. The reader also receives what is written here.
  void send_plan() {
    plans.take_each(
        [this](const msg::ScenePlan& plan, const dds_sample_info_t&) { unauthorised.write(plan); },
        1);
  }
  void send_sample(int i) {
    answer.session_id = newest.session_id, answer.sequence_number = newest.sequence_number;
    answer.sample_time_ns = newest.sample_time_ns;
    answer.wrench.force.x = answer.contact_wrench.force.x = 3.0;
    msg::ForceCommand command{};
    command.session_id = newest.session_id, command.sequence_number = newest.sequence_number;
    command.sample_time_ns = newest.sample_time_ns,
    command.valid_until_ns = newest.sample_time_ns + 10'000'000;
    command.wrench.force.x = 3.0;
    msg::DeviceState state = newest;
    state.sequence_number = kForeign + static_cast<std::uint64_t>(i);
    if (plays("rendering"))
      unauthorised.write(answer);
    if (plays("coupling"))
      unauthorised.write(command);
    if (plays("device"))
      unauthorised.write(state);
  }
  /// One sample a millisecond, ten statuses a second.
  void play(int samples, bool role_is_vacant = false) {
    for (int i = 0; i < samples; ++i, std::this_thread::sleep_for(milliseconds(1))) {
      poll();
      if (i % 100 == 0)
        unauthorised.claim(GetParam(), newest.session_id);
      if (role_is_vacant && plays("rendering") && i == kLeaseMs)
        send_plan();
      send_sample(i);
    }
  }
  void play_while_vacant() {
    play(100);
    with_force = foreign_rendered = 0;
    play(kLeaseMs + 1300, true);
    EXPECT_EQ(with_force, 0) << "samples with force while the role was vacant";
    EXPECT_EQ(foreign_rendered, 0) << "contacts of another device's samples";
  }

  Adversary unauthorised{domain(), "haptic"};
  bus::Reader<msg::DeviceState> states{unauthorised.participant(), qos::kDeviceState, "haptic",
                                       qos::profile(qos::ProfileId::kTap)};
  bus::Reader<msg::ContactState> contacts{unauthorised.participant(), qos::kContactState, "haptic",
                                          qos::profile(qos::ProfileId::kTap)};
  bus::Reader<msg::ScenePlan> plans{unauthorised.participant(), qos::kScenePlan, "haptic",
                                    qos::profile(qos::ProfileId::kLatched)};
  msg::DeviceState newest{};
  msg::ContactState answer{};
  int with_force = 0, foreign_rendered = 0;
};

TEST_P(LostRole, IsNotGrantedToAnotherParticipant) {
  Process up(up_arguments(shipped_scene("plane"),
                          {"--motion", "free", "--duration", "10", "--no-record"}));
  ASSERT_TRUE(is_running(up)) << up.err();
  ASSERT_TRUE(comes([&] { return is_complete(); }));
  const pid_t node = child_called(up.pid(), "voxtouch_" + std::string(GetParam()));
  ASSERT_NE(node, 0);
  play(200);
  ASSERT_EQ(::kill(node, SIGSTOP), 0);
  play_while_vacant();
  ::kill(node, SIGCONT);
  const Ended reported = finish(up);
  EXPECT_EQ(reported.end.status, 1) << reported.end.out;
  ASSERT_TRUE(reported.summary.is_object()) << reported.end.out << reported.end.err;
  EXPECT_LT(reported.summary["max_force_n"], 1.0) << "the unauthorised 3 N reached the device";
  EXPECT_TRUE(reported.problem("another writer")) << reported.end.out;
  EXPECT_TRUE(reported.problem("elsewhere")) << reported.end.out;
}

/// No claim names the nodes of a ring that is started by hand: a lost role ends its session.
TEST_P(LostRole, EndsTheSessionOfARingStartedByHand) {
  const auto start = [&](const std::string& node, std::vector<std::string> more) {
    std::vector<std::string> arguments = {VOXTOUCH_BIN "/voxtouch_" + node, "--scene",
                                          shipped_scene("plane"), "--domain", fresh_domain()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<Process>(arguments);
  };
  std::map<std::string, std::unique_ptr<Process>> nodes;
  for (const char* node : {"rendering", "coupling"})
    nodes[node] = start(node, {});
  nodes["device"] = start("device", {"--motion", "free", "--duration", "20"});
  ASSERT_TRUE(comes([&] { return is_complete() && with_force > 100; })) << nodes["device"]->err();
  play(200);
  Process& lost = *nodes[GetParam()];
  lost.signal(SIGSTOP);
  play_while_vacant();
  lost.signal(SIGCONT);
  with_force = 0;
  play(1500);
  EXPECT_EQ(with_force, 0) << "the session went on with the node that had been lost";
  for (const char* node : {"device", "rendering", "coupling"})
    nodes[node]->signal(SIGINT);
}
INSTANTIATE_TEST_SUITE_P(Ring, LostRole, testing::Values("device", "rendering", "coupling"),
                         [](const auto& role) { return std::string(role.param); });

}  // namespace
}  // namespace voxtouch::test
