// The controller on a real socket with a scripted remote side: the packets that arrive under each
// fault.
#include "devices/lwr/simulated/session.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "tests/unit/lwr_sim/rig.hpp"

namespace voxtouch::lwr_sim {
namespace {

using namespace std::chrono_literals;
using test::MsrBytes;

/// Answers every newer packet, as a driver does, on a separate thread; stores the packets.
class Client {
 public:
  Client() : socket_("127.0.0.1", 0), thread_([this] { run(); }) {}
  ~Client() { stop(); }
  void stop() {
    stop_ = true;
    if (thread_.joinable())
      thread_.join();
  }
  std::uint16_t port() const { return socket_.local().port; }
  /// Valid after `stop`.
  std::vector<MsrBytes> seen;
  std::atomic<int> answers_left{1 << 30};
  std::atomic<int> strays{0};  ///< datagrams of other sizes

 private:
  void run() {
    std::array<std::byte, 2048> buffer;
    int newest = -1;
    while (!stop_) {
      if (!socket_.wait(20ms))
        continue;
      const auto datagram = socket_.receive(buffer);
      if (!datagram)
        continue;
      if (datagram->size != 916) {
        ++strays;
        continue;
      }
      MsrBytes msr;
      std::memcpy(msr.data(), buffer.data(), msr.size());
      seen.push_back(msr);
      if (test::sequence(msr) <= newest || test::state(msr) == 0)
        continue;
      newest = test::sequence(msr);
      if (answers_left-- > 0)
        socket_.send(remote_.answer(msr), datagram->from);
    }
  }
  arm::UdpSocket socket_;
  test::ScriptedRemote remote_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

struct Outcome {
  std::vector<MsrBytes> seen;
  Ending ending = Ending::kStopped;
  AnswerCounts answers;
  Line::Counts line;
  std::uint64_t drops = 0, starts = 0;
  std::uint32_t misses = 0;
};

Outcome virtual_run(const std::vector<std::string>& faults, double duration_s,
                    std::uint64_t seed = 1, int answers = 1 << 30, double patience_s = 5.0) {
  Client client;
  client.answers_left = answers;
  std::vector<Fault> parsed;
  for (const std::string& text : faults)
    parsed.push_back(parse_fault(text, kFaults));
  ControllerConfig config;
  config.script_pause_s = 0.002;
  config.virtual_time = true;
  config.seed = seed;
  FriController controller(config, test::arm_at(Vec3(0.02, 0.0, 0.0)), FaultSchedule(parsed));
  SessionConfig network;
  network.remote_port = client.port();
  network.duration_s = duration_s;
  network.patience_s = patience_s;
  Session session(network, controller, Line(FaultSchedule(parsed), config.period_s, seed));
  const std::atomic<bool> never{false};
  Outcome out;
  out.ending = session.run(never);
  std::this_thread::sleep_for(50ms);  // the last packet is in transit
  client.stop();
  out.seen = client.seen;
  out.answers = controller.counts();
  out.line = session.line().counts();
  out.drops = controller.drops();
  out.starts = controller.starts();
  out.misses = controller.link().statistics().miss_counter;
  return out;
}

std::vector<int> sequences(const Outcome& out, double from_s, double to_s) {
  std::vector<int> all;
  for (const MsrBytes& msr : out.seen)
    if (test::timestamp(msr) > from_s - 1e-5 && test::timestamp(msr) < to_s - 1e-5 &&
        test::state(msr) != 0)
      all.push_back(test::sequence(msr));
  return all;
}

bool dropped_after(const Outcome& out, double time_s) {
  for (const MsrBytes& msr : out.seen)
    if (test::timestamp(msr) > time_s && test::state(msr) == 1)
      return true;
  return false;
}

TEST(Session, VirtualTimeAnswersAllAndEndsOff) {
  const Outcome out = virtual_run({}, 0.3);
  EXPECT_EQ(out.ending, Ending::kDuration);
  EXPECT_EQ(out.answers.accepted, 300u);
  EXPECT_EQ(out.misses, 0u);
  ASSERT_GE(out.seen.size(), 301u);
  EXPECT_EQ(test::state(out.seen.back()), 0);
  EXPECT_EQ(out.starts, 1u);
  EXPECT_EQ(out.drops, 0u);
  EXPECT_EQ(test::get<std::int32_t>(out.seen.front(), 132), 0x56545854);
}

TEST(Session, VirtualTimeIsBitIdentical) {
  const std::vector<std::string> faults = {"loss@0.1:0.1:0.05", "duplicate@0.2:0.02",
                                           "reorder@0.25:0.02:0.2", "jitter@0.1:0.1"};
  const auto tidy = [](const Outcome& out) {
    std::vector<MsrBytes> all = out.seen;
    // The first may have been repeated before the remote side was there.
    while (all.size() > 1 && test::sequence(all[0]) == test::sequence(all[1]))
      all.erase(all.begin());
    return all;
  };
  const auto first = tidy(virtual_run(faults, 0.4)), second = tidy(virtual_run(faults, 0.4));
  EXPECT_EQ(first, second);
  EXPECT_NE(first, tidy(virtual_run(faults, 0.4, 2)));
}

TEST(Session, LostMeasurementsLeaveGapsAndMisses) {
  const Outcome out = virtual_run({"loss@0.2:0.003"}, 0.3);
  EXPECT_EQ(out.line.lost, 3u);
  EXPECT_EQ(out.misses, 3u);
  EXPECT_EQ(sequences(out, 0.198, 0.205), (std::vector<int>{199, 200, 204, 205}));
  EXPECT_FALSE(dropped_after(out, 0.1));
  const Outcome longer = virtual_run({"loss@0.2:0.005"}, 0.3);
  EXPECT_TRUE(dropped_after(longer, 0.2));
  EXPECT_EQ(longer.drops, 1u);
}

TEST(Session, LostAnswersShowAsMissesOnly) {
  const Outcome out = virtual_run({"answer_loss@0.2:0.002"}, 0.3);
  EXPECT_EQ(out.line.answers_lost, 2u);
  EXPECT_EQ(out.misses, 2u);
  EXPECT_EQ(sequences(out, 0.199, 0.204), (std::vector<int>{200, 201, 202, 203, 204}));
}

TEST(Session, LateMeasurementsBunchAndAnswersAreStale) {
  const Outcome out =
      virtual_run({"late@0.2:0.001:0.0025"}, 0.3);  // one of them, two periods and a half
  EXPECT_EQ(out.line.delayed, 1u);
  EXPECT_EQ(out.misses, 1u);
  std::vector<int> order;
  for (const MsrBytes& msr : out.seen)
    if (test::sequence(msr) >= 199 && test::sequence(msr) <= 205)
      order.push_back(test::sequence(msr));
  EXPECT_EQ(order, (std::vector<int>{199, 200, 202, 203, 201, 204, 205}));
  const Outcome all = virtual_run({"late@0.2:0.02:0.0025"}, 0.3);
  EXPECT_GT(all.answers.stale, 10u);
  EXPECT_EQ(all.drops, 1u);
}

TEST(Session, JitterWithinThePeriodIsLatencyAndNoMiss) {
  const Outcome out = virtual_run({"jitter@0.1:inf:0.0008"}, 0.4);
  EXPECT_EQ(out.misses, 0u);
  EXPECT_NEAR(test::get<float>(out.seen.back(), 164), 0.0004, 0.0001);
  EXPECT_NEAR(test::get<float>(out.seen.back(), 168), 0.0008, 0.0001);
}

TEST(Session, ReorderedMeasurementsComeAfterTheirSuccessors) {
  const Outcome out = virtual_run({"reorder@0.2:0.001"}, 0.3);
  std::vector<int> order;
  for (const MsrBytes& msr : out.seen)
    if (test::sequence(msr) >= 200 && test::sequence(msr) <= 204)
      order.push_back(test::sequence(msr));
  EXPECT_EQ(order, (std::vector<int>{200, 202, 201, 203, 204}));
  EXPECT_EQ(out.misses, 1u);
}

TEST(Session, DuplicatesComeTwiceAndAreAnsweredOnce) {
  const Outcome out = virtual_run({"duplicate@0.2:0.01"}, 0.3);
  EXPECT_EQ(out.line.duplicated, 10u);
  EXPECT_EQ(sequences(out, 0.2, 0.21).size(), 20u);
  EXPECT_EQ(out.misses, 0u);
  EXPECT_EQ(out.drops, 0u);
}

TEST(Session, AMeasurementWithoutANumberArrivesAsItIs) {
  const Outcome out = virtual_run({"nan@0.2:0.001:4"}, 0.3);
  int bad = 0;
  for (const MsrBytes& msr : out.seen)
    bad += std::isnan(test::joint(msr, 3));
  EXPECT_EQ(bad, 1);
}

TEST(Session, EmergencyStopDrivesAndQualityArrive) {
  const Outcome stop = virtual_run({"estop@0.2:0.05"}, 0.3);
  const Outcome drives = virtual_run({"drives_off@0.2:0.05:1"}, 0.3);
  const Outcome quality = virtual_run({"quality@0.2:0.05:0"}, 0.3);
  const auto at = [](const Outcome& out, int sequence) {
    for (const MsrBytes& msr : out.seen)
      if (test::sequence(msr) == sequence)
        return msr;
    return MsrBytes{};
  };
  EXPECT_EQ(test::state(at(stop, 200)), 2);
  EXPECT_EQ(test::power(at(stop, 201)), 0);
  EXPECT_EQ(test::state(at(stop, 201)), 1);
  EXPECT_EQ(test::power(at(stop, 251)), 0x7F);
  EXPECT_EQ(test::power(at(drives, 201)), 0x7E);
  EXPECT_EQ(test::quality(at(quality, 201)), 0);
  EXPECT_EQ(test::state(at(quality, 203)), 1);
}

TEST(Session, ASilentControllerSendsNothingAndIsInMonAfterwards) {
  const Outcome out = virtual_run({"silent@0.2:0.03"}, 0.3);
  EXPECT_TRUE(sequences(out, 0.2, 0.23).empty());
  EXPECT_EQ(sequences(out, 0.229, 0.232), (std::vector<int>{231, 232}));
  EXPECT_TRUE(dropped_after(out, 0.229));
  EXPECT_EQ(out.drops, 1u);
}

TEST(Session, InVirtualTimePatienceEnds) {
  const auto start = std::chrono::steady_clock::now();
  const Outcome out = virtual_run({}, 1.0, 1, 50, 0.2);
  EXPECT_EQ(out.ending, Ending::kNoAnswer);
  EXPECT_EQ(out.answers.accepted, 50u);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 3s);
}

TEST(Session, InRealTimeMeasurementsLeaveByTheClock) {
  Client client;
  ControllerConfig config;
  config.period_s = 0.01;
  config.script_pause_s = 0.02;
  FriController controller(config, test::released_hand());
  SessionConfig network;
  network.remote_port = client.port();
  network.duration_s = 0.6;
  Session session(network, controller, Line(FaultSchedule(), config.period_s, 0));
  const std::atomic<bool> never{false};
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(session.run(never), Ending::kDuration);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  EXPECT_GE(elapsed.count(), 0.599);
  client.stop();
  EXPECT_GT(controller.counts().accepted,
            0u);  // the number that arrive in time depends on the machine, not on the protocol
  EXPECT_GT(client.seen.size(), 10u);
  EXPECT_EQ(controller.counts().accepted + controller.counts().stale, session.counts().received);
}

TEST(Session, InRealTimeItGoesOnWithoutAnyAnswer) {
  Client client;
  client.answers_left = 0;
  ControllerConfig config;
  config.period_s = 0.01;
  FriController controller(config, test::released_hand());
  SessionConfig network;
  network.remote_port = client.port();
  network.duration_s = 0.2;
  Session session(network, controller, Line(FaultSchedule(), config.period_s, 0));
  const std::atomic<bool> never{false};
  EXPECT_EQ(session.run(never), Ending::kDuration);
  EXPECT_EQ(controller.state(), lwr::fri::State::kOff);
  EXPECT_EQ(controller.starts(), 0u);
}

TEST(Session, UnauthorisedPeersAreIgnored) {
  Client client;
  ControllerConfig config;
  config.period_s = 0.01;
  FriController controller(config, test::released_hand());
  SessionConfig network;
  network.remote_port = client.port();
  network.duration_s = 0.2;
  Session session(network, controller, Line(FaultSchedule(), config.period_s, 0));
  arm::UdpSocket unauthorised("127.0.0.1", 0);
  const test::CmdBytes nothing{};
  ASSERT_TRUE(unauthorised.send(nothing, session.local()));
  const std::atomic<bool> never{false};
  session.run(never);
  EXPECT_EQ(session.counts().foreign, 1u);
  EXPECT_EQ(controller.counts().id, 0u);
}

TEST(Session, SilentControllerReceivesNothing) {
  for (const bool silent : {false, true}) {
    arm::UdpSocket remote("127.0.0.1", 0);
    std::vector<Fault> faults;
    if (silent)
      faults = {parse_fault("silent@0", kFaults)};
    ControllerConfig config;
    FriController controller(config, test::released_hand(), FaultSchedule(faults));
    SessionConfig network;
    network.remote_port = remote.local().port;
    network.duration_s = 0.02;
    Session session(network, controller, Line(FaultSchedule(faults), config.period_s, 0));
    const std::array<std::byte, 10> nothing{};
    ASSERT_TRUE(remote.send(nothing, session.local()));
    const std::atomic<bool> never{false};
    session.run(never);
    EXPECT_EQ(controller.counts().length, silent ? 0u : 1u);
  }
}

TEST(Session, TakenPortIsReported) {
  arm::UdpSocket bound("127.0.0.1", 0);
  FriController controller({}, test::released_hand());
  SessionConfig network;
  network.port = bound.local().port;
  try {
    Session session(network, controller, Line(FaultSchedule(), 1e-3, 0));
    FAIL() << "the port was given twice";
  } catch (const devices::DeviceOpenError& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(network.port)), std::string::npos);
  }
  network.port = 0;
  network.remote_address = "nowhere";
  EXPECT_THROW(Session(network, controller, Line(FaultSchedule(), 1e-3, 0)),
               devices::DeviceOpenError);
}

}  // namespace
}  // namespace voxtouch::lwr_sim
