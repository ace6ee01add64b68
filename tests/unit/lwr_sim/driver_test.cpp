// The real driver at the simulated controller, in virtual time, each on its own thread.
#include "devices/lwr/lwr_driver.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "devices/lwr/simulated/session.hpp"
#include "tests/unit/lwr_sim/rig.hpp"

namespace voxtouch::lwr_sim {
namespace {

using namespace std::chrono_literals;

std::uint16_t free_port() { return arm::UdpSocket("127.0.0.1", 0).local().port; }

/// A controller on a separate thread; its trace is valid after `end`.
class RunningController {
 public:
  RunningController(std::uint16_t remote_port, hand::Hand hand,
                    const std::vector<std::string>& faults = {},
                    bool first_start_keeps_strategy = false) {
    std::vector<Fault> parsed;
    for (const std::string& text : faults)
      parsed.push_back(parse_fault(text, kFaults));
    ControllerConfig config;
    config.virtual_time = true;
    config.first_start_keeps_strategy = first_start_keeps_strategy;
    controller_ = std::make_unique<FriController>(config, std::move(hand), FaultSchedule(parsed));
    SessionConfig network;
    network.remote_port = remote_port;
    session_ = std::make_unique<Session>(network, *controller_,
                                         Line(FaultSchedule(parsed), config.period_s, 1));
    session_->after_period = [this](const FriController& c) { rows.push_back(c.row()); };
    thread_ = std::thread([this] { session_->run(stop_); });
  }
  ~RunningController() { end(); }
  void end() {
    stop_ = true;
    if (thread_.joinable())
      thread_.join();
  }
  const FriController& controller() const { return *controller_; }
  std::vector<TraceRow> rows;

 private:
  std::unique_ptr<FriController> controller_;
  std::unique_ptr<Session> session_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

lwr::LwrOptions options(std::uint16_t port) {
  lwr::LwrOptions o;
  o.address = "127.0.0.1";
  o.port = port;
  o.connect_timeout_s = 5.0;
  o.virtual_timeout_s = 2.0;
  return o;
}

TEST(DriverAtTheController, ForceReachesTheHandUnrefused) {
  const std::uint16_t port = free_port();
  RunningController krc(port, test::arm_at(Vec3::Zero(), 500.0, 60.0));
  {
    lwr::LwrDriver driver(options(port));
    EXPECT_TRUE(driver.simulated());
    Vec3 start = Vec3::Zero(), at = Vec3::Zero();
    for (int i = 0; i < 3000; ++i) {
      const auto sample = driver.read(1s);
      ASSERT_TRUE(sample) << driver.status_text();
      EXPECT_EQ(sample->time_ns, i * 1'000'000LL);
      at = sample->pose.position;
      if (i == 0)
        start = at;
      ASSERT_TRUE(driver.write({Vec3(10.0, 0.0, -5.0), Vec3::Zero()})) << driver.status_text();
    }
    // Friction reduces it by up to 2 N.
    EXPECT_NEAR((at - start).x(), 10.0 / 500.0, 0.005);
    EXPECT_NEAR((at - start).z(), -5.0 / 500.0, 0.005);
    EXPECT_EQ(driver.counts().malformed, 0u);
    EXPECT_EQ(driver.clock_disagreements(), 0u);
  }
  krc.end();
  EXPECT_EQ(krc.controller().drops(), 0u);
  EXPECT_EQ(krc.controller().counts().not_finite + krc.controller().counts().size_field, 0u);
}

TEST(DriverAtTheController, FindsItsModeAfterPositionControl) {
  const std::uint16_t port = free_port();
  RunningController krc(port, test::released_hand(), {}, true);
  lwr::LwrDriver driver(options(port));
  const auto sample = driver.read(1s);
  ASSERT_TRUE(sample);
  EXPECT_TRUE(driver.write({Vec3(1.0, 0.0, 0.0), Vec3::Zero()}));
}

TEST(DriverAtTheController, ToleratesANoisyNetwork) {
  const std::uint16_t port = free_port();
  RunningController krc(port, test::arm_at(Vec3::Zero()),
                        {"loss@0:inf:0.02", "answer_loss@0:inf:0.01", "duplicate@0:inf:0.05",
                         "reorder@0:inf:0.01", "jitter@0:inf:0.0005"});
  lwr::LwrDriver driver(options(port));
  int good = 0;
  for (int i = 0; i < 2000; ++i) {
    if (!driver.read(1s))
      continue;
    good += driver.write({Vec3(2.0, 0.0, 0.0), Vec3::Zero()}).has_value();
  }
  EXPECT_GT(good, 1900);
  EXPECT_EQ(driver.session().drops(), 0u);
}

TEST(DriverAtTheController, AfterAFaultNoForceReachesTheArm) {
  for (const char* fault :
       {"estop@1.5:0.2", "drives_off@1.5:0.2", "quality@1.5:0.2:1", "loss@1.5:0.01"}) {
    const std::uint16_t port = free_port();
    RunningController krc(port, test::arm_at(Vec3::Zero(), 500.0, 60.0), {fault});
    {
      lwr::LwrDriver driver(options(port));
      for (int i = 0, after = 0; i < 5000 && after < 150; ++i) {
        after += driver.session().drops() > 0;
        (void)driver.read(1s);
        (void)driver.write({Vec3(10.0, 0.0, 0.0), Vec3::Zero()});
      }
      EXPECT_EQ(driver.session().drops(), 1u) << fault;
    }
    krc.end();
    int pushed_before = 0, after = 0;
    for (const TraceRow& row : krc.rows) {
      if (row.time_s < 1.5)
        pushed_before += row.applied.force.norm() > 5.0;
      if (row.time_s < 1.5065 || row.time_s > 1.6065)
        continue;  // five misses take as long
      ++after;
      EXPECT_TRUE(row.applied.zero()) << fault << " at " << row.time_s;
    }
    EXPECT_GT(pushed_before, 500) << fault;
    EXPECT_GT(after, 0) << fault;
  }
}

}  // namespace
}  // namespace voxtouch::lwr_sim
