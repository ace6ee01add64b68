// The loop closed through a node outside the ring, the simplest form of teleoperation: it reads the
// tool's pose and writes a spring's wrench.
#include <gtest/gtest.h>

#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::test {
namespace {

using std::chrono::milliseconds;
constexpr double kSpringNPerM = 40.0, kMaxN = 1.5, kTimeoutS = 0.05, kFadeS = 0.05;
constexpr double kCentre[] = {-0.09, -0.03, 0.08};  // 30 mm above the hand's target in `rest`

/// A user's node, as a thread: a spring from the tool's last pose to a point.
class Remote {
 public:
  Remote()
      : participant_({static_cast<std::uint32_t>(std::stoul(fresh_domain())), "lo", "remote"}),
        poses_(participant_, qos::kPose, "haptic", qos::profile(qos::ProfileId::kTap)),
        wrenches_(participant_, qos::external_topic("/sim/wrench"), "haptic",
                  qos::profile(qos::ProfileId::kTap)),
        thread_([this] { run(); }) {}
  ~Remote() {
    stop_ = true;
    thread_.join();
  }
  int written() const { return written_; }

 private:
  void run() {
    char world[] = "world";
    msg::geometry_msgs_WrenchStamped m{};
    m.header.frame_id = world;
    while (!stop_) {
      poses_.take_each([&](const msg::geometry_msgs_PoseStamped& p) {
        const auto& at = p.pose.position;
        m.wrench.force = {kSpringNPerM * (kCentre[0] - at.x), kSpringNPerM * (kCentre[1] - at.y),
                          kSpringNPerM * (kCentre[2] - at.z)};
        wrenches_.write(m);
        ++written_;
      });
      std::this_thread::sleep_for(milliseconds(1));
    }
  }
  bus::Participant participant_;
  bus::Reader<msg::geometry_msgs_PoseStamped> poses_;
  bus::Writer<msg::geometry_msgs_WrenchStamped> wrenches_;
  std::atomic<bool> stop_{false};
  std::atomic<int> written_{0};
  std::thread thread_;
};

double size(const msg::geometry_msgs_Wrench& w) {
  return std::hypot(w.force.x, w.force.y, w.force.z);
}

/// Whether values arrived in time for half a second up to `at_ns`: a busy machine may delay them,
/// and the force is then not that of the written values.
bool was_fed(const std::vector<msg::ExternalSample>& taken, std::int64_t at_ns) {
  std::int64_t before = at_ns - 500'000'000;
  for (const msg::ExternalSample& one : taken) {
    if (one.sample_time_ns < at_ns - 500'000'000 || one.sample_time_ns > at_ns)
      continue;
    if (one.sample_time_ns - before > 40'000'000)
      return false;
    before = one.sample_time_ns;
  }
  return at_ns - before <= 40'000'000;
}

TEST(ExternalRing, IsBoundedFadesOnStopAndReplaysExactly) {
  const TemporaryFolder folder;
  const std::filesystem::path bag = folder / "bag";
  Process up(up_arguments(shipped_scene("cup_external"), {"--device", "sim-phantom", "--motion",
                                                          "rest", "--record", bag.string()}));
  for (int i = 0; i < 1500 && !runs(up); ++i)
    std::this_thread::sleep_for(milliseconds(20));
  ASSERT_TRUE(runs(up)) << up.err();
  {
    Remote remote;
    for (int i = 0; i < 1000 && remote.written() < 300; ++i)
      std::this_thread::sleep_for(milliseconds(20));
    EXPECT_GE(remote.written(), 300);
  }
  std::this_thread::sleep_for(milliseconds(1000));
  up.signal(SIGINT);
  const Finished end = up.wait();
  const nlohmann::json summary = parse_summary(end.out);
  ASSERT_TRUE(summary.is_object()) << end.out << end.err;
  EXPECT_EQ(end.status, 0) << end.err << end.out;
  EXPECT_NE(end.err.find("/sim/wrench"), std::string::npos) << end.err;
  EXPECT_NE(end.out.find("not certified"), std::string::npos) << end.out;
  EXPECT_GT(summary["external"]["external_samples"], 100);
  EXPECT_LE(summary["external"]["external_energy_generated_j"], 0.05 + 0.05 * 10.0)
      << "energy_j and ten seconds of power_w";

  const auto contacts = read_ring_topic<msg::ContactState>(bag, "/haptic/rendering/contact");
  const auto commands = read_ring_topic<msg::ForceCommand>(bag, "/haptic/coupling/command");
  const auto taken = read_ring_topic<msg::ExternalSample>(bag, "/haptic/rendering/external");
  ASSERT_GT(taken.size(), 100U);
  const std::int64_t last_ns = taken.back().sample_time_ns,
                     gone_ns = last_ns + static_cast<std::int64_t>(1e9 * (kTimeoutS + kFadeS)) +
                               2'000'000;
  double most_n = 0.0, most_command_n = 0.0, low = 1e9, high = 0.0;
  int ended = 0;
  for (const msg::ForceCommand& c : commands)
    most_command_n = std::max(most_command_n, size(c.wrench));
  for (const msg::ContactState& c : contacts) {
    const double force = size(c.effects_wrench);
    most_n = std::max(most_n, force);
    if (c.sample_time_ns > last_ns - 1'000'000'000 && was_fed(taken, c.sample_time_ns))
      low = std::min(low, force), high = std::max(high, force);
    if (c.sample_time_ns <= gone_ns)
      continue;
    ASSERT_EQ(force, 0.0) << "the force has faded, by the samples' own time";
    ++ended;
  }
  EXPECT_GT(most_n, 0.3);
  EXPECT_LE(most_n, kMaxN);
  EXPECT_GT(most_command_n, 0.3) << "displayed at the hand";
  EXPECT_LE(most_command_n, 1.2 * kMaxN) << "the filter's overshoot";
  EXPECT_LE(high - low, 0.1 * kMaxN)
      << "in the last second of the closed loop the force stands: from " << low << " to " << high
      << " N";
  EXPECT_GT(ended, 100);

  const Finished replay =
      Process({VOXTOUCH_BIN "/voxtouch", "replay", bag.string(), "--json"}).wait();
  const nlohmann::json said = nlohmann::json::parse(replay.out, nullptr, false);
  ASSERT_TRUE(said.is_object()) << replay.err;
  EXPECT_GT(said["contact"]["compared"], 1000);
  if (!said["missing"].empty())
    return;  // a recorder on a busy machine may lose samples: the replay reports them, and bits may
             // differ
  EXPECT_EQ(said["contact"]["differ"], 0) << said;
  EXPECT_EQ(said["command"]["differ"], 0) << said;
}

}  // namespace
}  // namespace voxtouch::test
