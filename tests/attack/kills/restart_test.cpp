// Processes of the ring killed in contact and restarted by `up --restart`.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>
#include <thread>

#include "nodes/runtime/node_registry.hpp"
#include "qos/topics.hpp"
#include "tests/attack/kills/contact_ring.hpp"
#include "tests/attack/kills/leftovers.hpp"
#include "tests/attack/kills/round.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::attack {
namespace {

using namespace std::chrono_literals;
using Words = std::vector<std::string>;

/// plane.yaml with a hand that presses for as long as the ring runs.
std::string pressing_scene(const std::filesystem::path& folder) {
  std::stringstream shipped;
  shipped << std::ifstream(test::shipped_scene("plane")).rdbuf();
  std::string text = shipped.str();
  for (std::size_t at; (at = text.find("../meshes")) != text.npos;)
    text.replace(at, 9, VOXTOUCH_DEPLOY "/meshes");
  const std::string motions = "\nmotions:";
  text.insert(text.find('\n', text.find(motions) + 1) + 1,
              "  press: {path: [[0.003, 0.002, 0.04], [0.003, 0.002, 0.007]], speed_m_per_s: 0.1, "
              "hold_s: 0.1}\n");
  const std::filesystem::path file = folder / "pressed.yaml";
  std::ofstream(file) << text;
  return file.string();
}

/// A ring in a contact that does not end, with these options next to.
class PressedRing {
 public:
  explicit PressedRing(const Words& options)
      : ring_({.scene = pressing_scene(folder_.path()),
               .motion = "press",
               .domain = domain(),
               .more = all(options)}) {}

  bool reach_contact() { return ring_.reach_contact(700, 200ms); }
  pid_t find(const std::string& role) {
    for (const pid_t child : test::children_of(ring_.up().pid()))
      if (program_of(child) == "voxtouch_" + role)
        return child;
    return 0;
  }
  /// Kills it.
  void kill(const std::string& role) { ring_.lose(killed_ = find(role), SIGKILL); }
  /// Waits for another process of that role; returns its Unix time, or 0 if there is none.
  std::int64_t started_again_ns(const std::string& role) {
    const bool is_there = wait_until([&] { return find(role) != 0 && find(role) != killed_; }, 15s);
    return is_there ? unix_ns() : 0;
  }
  bool force_comes_back() {
    const std::uint64_t now = ring_.seen().empty() ? 0 : ring_.seen().back().sequence;
    return wait_until([&] { return ring_.seen().back().sequence > now && ring_.has_force(); }, 20s);
  }
  /// Waits until a restarted logger reports more than that number of recorded device samples.
  bool records_again(double samples) {
    const bus::Participant listener(ring_.joined("listener"));
    runtime::NodeRegistry registry(listener, "haptic");
    const std::string bag = ring_.bag().string() + "_again",
                      figure = qos::figure_name(qos::kDeviceState) + "_recorded";
    return wait_until(
        [&] {
          registry.update();
          const auto logger = registry.find("logger");
          return logger && logger->values.contains("bag") && logger->values.at("bag") == bag &&
                 runtime::value_of(logger->figures, figure) > samples;
        },
        60s);
  }
  test::Finished interrupt() {
    ring_.up().signal(SIGINT);
    return end();
  }
  test::Finished end() {
    const test::Finished end = ring_.up().wait(30s);
    summary = test::parse_summary(end.out);
    return end;
  }
  bool has_problem(const std::string& text) const { return has("problems", text); }
  bool has_note(const std::string& text) const { return has("notes", text); }

  ContactRing& ring() { return ring_; }
  nlohmann::json summary;

 private:
  static std::uint32_t domain() {
    return static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
  }
  static Words all(const Words& options) {
    Words words = test::on_a_busy_machine();
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }
  bool has(const char* key, const std::string& text) const {
    if (!summary.is_object())
      return false;
    return std::ranges::any_of(summary[key], [&](const auto& one) {
      return one.template get<std::string>().contains(text);
    });
  }

  test::TemporaryFolder folder_;
  ContactRing ring_;
  pid_t killed_ = 0;
};

class Restart : public testing::TestWithParam<const char*> {};

/// Of the commands in the bag: the largest gap is the loss, and behind it the force grows from
/// nothing.
void expect_a_ramp(const std::filesystem::path& bag) {
  const auto commands = test::read_ring_topic<msg::ForceCommand>(bag, "/haptic/coupling/command");
  ASSERT_GT(commands.size(), 500U);
  const auto force_n = [](const msg::ForceCommand& c) {
    return std::hypot(c.wrench.force.x, c.wrench.force.y, c.wrench.force.z);
  };
  std::size_t back = 1;
  const auto gap = [&](std::size_t n) {
    return commands[n].sequence_number - commands[n - 1].sequence_number;
  };
  for (std::size_t n = 1; n < commands.size(); ++n)
    if (gap(n) > gap(back))
      back = n;
  const double settled_n = force_n(commands.back());
  EXPECT_GT(settled_n, 0.05);
  EXPECT_LT(force_n(commands[back]), 0.1 * settled_n)
      << "behind a gap of " << gap(back) << " samples";
  const auto half =
      std::find_if(commands.begin() + static_cast<std::ptrdiff_t>(back), commands.end(),
                   [&](const auto& c) { return force_n(c) > 0.5 * settled_n; });
  ASSERT_NE(half, commands.end());
  // The ramp takes 0.2 s. The hand has moved in without force, so its wrench is at first more than
  // twice the settled one.
  EXPECT_GT(half->sequence_number - commands[back].sequence_number, 20U)
      << "the coupling ramps in over 0.2 s";
}

TEST_P(Restart, GivesZeroForceUntilReadyThenRamps) {
  PressedRing pressed({"--restart", "1", "--limit", "restarts=1"});
  ASSERT_TRUE(pressed.reach_contact()) << pressed.ring().refusal();
  pressed.kill(GetParam());
  const std::int64_t lost_ns = pressed.ring().lost_at_ns(),
                     again_ns = pressed.started_again_ns(GetParam());
  ASSERT_NE(again_ns, 0) << pressed.ring().refusal();
  const double machine_ms = pressed.ring().machine_ms();
  ASSERT_TRUE(pressed.force_comes_back()) << pressed.ring().refusal();
  std::this_thread::sleep_for(1s);
  const std::vector<Seen> seen = pressed.ring().seen();
  const auto first =
      std::ranges::find_if(seen, [&](const Seen& s) { return s.written_ns >= lost_ns; });
  const auto zero = std::find_if(first, seen.end(), [](const Seen& s) { return !s.force_on; });
  ASSERT_TRUE(first != seen.begin() && first != seen.end() && zero != seen.end());
  const double zero_ms = 1e-6 * static_cast<double>(zero->sample_ns - (first - 1)->sample_ns);
  std::printf(
      "zero after %.1f ms, started again after %.2f s; the machine stood still for %.1f ms\n",
      zero_ms, 1e-9 * static_cast<double>(again_ns - lost_ns), machine_ms);
  EXPECT_LE(zero_ms, kZeroWithinMs + machine_ms);
  const auto early = std::count_if(
      zero, seen.end(), [&](const Seen& s) { return s.force_on && s.written_ns < again_ns; });
  EXPECT_EQ(early, 0) << "samples with force before the node was started again";

  const test::Finished end = pressed.interrupt();
  EXPECT_EQ(end.status, 0) << end.err << end.out;
  ASSERT_TRUE(pressed.summary.is_object()) << end.out;
  EXPECT_EQ(pressed.summary["restarts"].size(), 1U);
  EXPECT_EQ(pressed.summary["restarts"][0]["node"], GetParam());
  EXPECT_EQ(pressed.summary["limits"]["restarts"]["value"], 1.0);
  EXPECT_TRUE(pressed.has_note(std::string(GetParam()) + " ended by signal 9")) << end.out;
  expect_a_ramp(pressed.ring().bag());
}
INSTANTIATE_TEST_SUITE_P(Ring, Restart, testing::Values("rendering", "coupling"),
                         [](const auto& role) { return std::string(role.param); });

TEST(RestartOfUp, FailsTheRunByDefaultAndEndsAtASecondDeath) {
  PressedRing pressed({"--restart", "1"});
  ASSERT_TRUE(pressed.reach_contact()) << pressed.ring().refusal();
  pressed.kill("rendering");
  ASSERT_NE(pressed.started_again_ns("rendering"), 0) << pressed.ring().refusal();
  ASSERT_TRUE(pressed.force_comes_back()) << pressed.ring().refusal();
  pressed.kill("coupling");
  const test::Finished end = pressed.end();
  EXPECT_EQ(end.status, 1);
  EXPECT_TRUE(pressed.has_problem("coupling ended by signal 9")) << end.out;
  EXPECT_TRUE(pressed.has_problem("restarts of nodes: 1 restarts (rendering)")) << end.out;
  EXPECT_EQ(pressed.summary["limits"]["restarts"]["met"], false) << end.out;
}

TEST(RestartOfUp, NeverStartsADeviceAgain) {
  PressedRing pressed({"--restart", "3"});
  ASSERT_TRUE(pressed.reach_contact()) << pressed.ring().refusal();
  pressed.kill("device");
  const test::Finished end = pressed.end();
  EXPECT_EQ(end.status, 1);
  EXPECT_TRUE(pressed.has_problem("device ended by signal 9")) << end.out;
  EXPECT_FALSE(pressed.summary.contains("restarts")) << end.out;
}

TEST(RestartOfUp, LeavesTheForceIfAListenerRestarts) {
  PressedRing pressed({"--restart", "2", "--limit", "restarts=2"});
  ASSERT_TRUE(pressed.reach_contact()) << pressed.ring().refusal();
  for (const char* role : {"validator", "logger"}) {
    pressed.kill(role);
    ASSERT_NE(pressed.started_again_ns(role), 0) << role;
  }
  ASSERT_TRUE(pressed.records_again(500)) << pressed.ring().refusal();
  const test::Finished end = pressed.interrupt();
  EXPECT_EQ(end.status, 0) << end.err << end.out;
  EXPECT_EQ(pressed.summary["restarts"].size(), 2U) << end.out;
  const std::filesystem::path again = pressed.ring().bag().string() + "_again";
  EXPECT_TRUE(pressed.has_note("The recording continues in " + again.string())) << end.out;
  EXPECT_GT(test::read_ring_topic<msg::DeviceState>(again, "/haptic/device/state").size(), 500U);
}

TEST(RestartOfUp, IsRefusedIfNothingCouldRestart) {
  for (const char* option : {"--lockstep", "--one-process"}) {
    test::Process up({VOXTOUCH_BIN "/voxtouch", "up", "plane", "--restart", "1", option,
                      "--no-record", "--domain", test::fresh_domain()});
    const test::Finished end = up.wait(20s);
    EXPECT_EQ(end.status, 1) << option;
    EXPECT_NE(end.err.find(std::string("Start without ") + option), std::string::npos) << end.err;
  }
}

}  // namespace
}  // namespace voxtouch::attack
