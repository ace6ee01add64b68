// The driver without faults: its answers, the arm's torques, its reports.
#include <gtest/gtest.h>

#include <atomic>
#include <numbers>
#include <thread>

#include "fake_controller.hpp"

namespace voxtouch::test {
namespace driver_test {

using namespace std::chrono_literals;

const Wrench kPush{Vec3(5, -3, 8), Vec3(0.4, -0.2, 0.1)};

/// A driver without posture torque, so that all torque is the command's.
lwr::LwrOptions plain_options() {
  lwr::LwrOptions options = quick_options();
  options.posture.max_torque_nm = 0.0;
  return options;
}

double difference(const lwr::fri::Joints& a, const lwr::LwrJoints& b) {
  return (lwr::fri::from_wire(a) - b).cwiseAbs().maxCoeff();
}

TEST(LwrDriver, MirrorsTheControllersPositionUntilCommandMode) {
  FakeController krc;
  krc.msr.data.cmd_jnt_pos_fri_offset = {0.01F, 0.02F, 0.03F, 0.04F, 0.05F, 0.06F, 0.07F};
  krc.msr.interface.quality = lwr::fri::Quality::kOk;
  const auto driver = krc.open();
  for (int n = 0; n < 30; ++n) {
    krc.msr.data.cmd_jnt_pos[0] += 0.01F;
    const Cycle t = cycle(krc, *driver, kPush);
    ASSERT_TRUE(t.sample);
    EXPECT_TRUE(t.sample->pose_valid) << "the arm can be followed all the same";
    EXPECT_EQ(t.written.error(), devices::DeviceError::kRecoverable);
    ASSERT_EQ(t.answers, 1U);
    EXPECT_LT(difference(t.command.command.jnt_pos,
                         lwr::fri::from_wire(krc.msr.data.cmd_jnt_pos) +
                             lwr::fri::from_wire(krc.msr.data.cmd_jnt_pos_fri_offset)),
              1e-6);
    EXPECT_EQ(torque_of(t.command), 0.0);
    EXPECT_EQ(t.command.krl.integer[lwr::fri::kFrmIntRun], lwr::fri::kHalt);
  }
  EXPECT_EQ(driver->session().diagnostic(), lwr::fri::Diagnostic::kQualityTooLowToStart);
}

TEST(LwrDriver, GivesTheWrenchAsJointTorqueAtTheMeasuredPosition) {
  FakeController krc;
  const auto driver = krc.open(plain_options());
  ASSERT_TRUE(run_to_command(krc, *driver));
  lwr::LwrJoints q = lwr::lwr_rest_posture();
  for (int n = 0; n < 50; ++n) {
    q[0] += 2e-4, q[3] -= 1e-4;
    krc.msr.data.jnt_pos = lwr::fri::to_wire(q);
    const Cycle t = cycle(krc, *driver, kPush);
    ASSERT_TRUE(t.written);
    EXPECT_LT(difference(t.command.command.add_jnt_trq,
                         lwr::joint_torque(lwr::LwrArm().jacobian(q), kPush)),
              1e-4);
    EXPECT_LT(difference(t.command.command.jnt_pos, q), 1e-6);
    EXPECT_EQ(t.command.command.jnt_stiffness, lwr::fri::Joints{});
    EXPECT_EQ(t.command.command.cmd_flags, 0x35U);
    EXPECT_EQ(t.command.krl.integer[lwr::fri::kFrmIntStrategy], 30);
    EXPECT_EQ(t.command.krl.integer[lwr::fri::kFrmIntRun], lwr::fri::kRun);
  }
}

TEST(LwrDriver, CountsItsAnswersAndReflectsTheMeasurement) {
  FakeController krc;
  krc.msr.header.send_seq = 65500;
  const auto driver = krc.open();
  std::uint16_t last = krc.received.back().header.send_seq;
  for (int n = 0; n < 200; ++n) {
    const Cycle t = cycle(krc, *driver);
    ASSERT_EQ(t.answers, 1U);
    EXPECT_EQ(t.command.header.refl_seq, krc.msr.header.send_seq);
    EXPECT_EQ(t.command.header.send_seq, static_cast<std::uint16_t>(last + 1));
    last = t.command.header.send_seq;
  }
  EXPECT_LT(krc.msr.header.send_seq, 60000) << "the count wrapped on the way";
  EXPECT_EQ(driver->sequence().lost, 0U);
  EXPECT_EQ(driver->sequence().restarts, 0U);
}

TEST(LwrDriver, NeverChangesItsFlags) {
  FakeController krc;
  krc.msr.interface.quality = lwr::fri::Quality::kBad;
  auto driver = krc.open();
  krc.msr.interface.quality = lwr::fri::Quality::kPerfect;
  ASSERT_TRUE(run_to_command(krc, *driver));
  cycle(krc, *driver, {Vec3(1e9, 0, 0), Vec3::Zero()});
  krc.close(std::move(driver));
  for (const lwr::fri::CmdPacket& answer : krc.received)
    EXPECT_EQ(answer.command.cmd_flags, krc.received.front().command.cmd_flags);
}

TEST(LwrDriver, EntersCommandModeWithoutAPositionJump) {
  FakeController krc;
  krc.msr.data.jnt_pos[1] += 0.1F;  // below the commanded position
  const auto driver = krc.open();
  ASSERT_TRUE(run_to_command(krc, *driver));
  for (int n = 0; n < 200; ++n)
    cycle(krc, *driver);
  float last = krc.msr.data.cmd_jnt_pos[1];
  for (const lwr::fri::CmdPacket& answer : krc.received) {
    EXPECT_LE(std::abs(answer.command.jnt_pos[1] - last),
              0.001 * lwr::lwr_limits().velocity_rad_s[1]);
    last = answer.command.jnt_pos[1];
  }
  EXPECT_NEAR(last, krc.msr.data.jnt_pos[1], 1e-6);
}

TEST(LwrDriver, ReportsPoseAndTwistOfTheToolInD) {
  FakeController krc;
  lwr::LwrOptions options = plain_options();
  options.pose_FT = {Vec3(0.0, 0.05, 0.1), Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()))};
  options.pose_BD = {Vec3(-0.5, 0.1, 0.3), Quat(Eigen::AngleAxisd(1.0, Vec3::UnitZ()))};
  const auto driver = krc.open(options);
  const lwr::LwrArm arm(options.pose_FT);
  lwr::LwrJoints q = lwr::lwr_rest_posture();
  const lwr::LwrJoints rate = (lwr::LwrJoints() << 0.2, -0.1, 0.1, 0.3, -0.2, 0.1, 0.4).finished();
  devices::DeviceSample sample;
  for (int n = 0; n < 100; ++n) {
    q += 0.001 * rate;
    krc.msr.data.jnt_pos = lwr::fri::to_wire(q);
    sample = *cycle(krc, *driver).sample;
  }
  const Pose expected = options.pose_BD.inverse() * arm.tool(q);
  EXPECT_NEAR((sample.pose.position - expected.position).norm(), 0.0, 1e-6);
  EXPECT_NEAR(sample.pose.orientation.angularDistance(expected.orientation), 0.0, 1e-6);
  const Vec6 twist = arm.jacobian(q) * rate;
  const Quat rotation_DB = options.pose_BD.orientation.conjugate();
  EXPECT_NEAR((sample.twist.linear - rotation_DB * twist.head<3>()).norm(), 0.0, 3e-3);
  EXPECT_NEAR((sample.twist.angular - rotation_DB * twist.tail<3>()).norm(), 0.0, 3e-3);
}

TEST(LwrDriver, TakesTheWrenchInDAboutTheTool) {
  FakeController krc;
  lwr::LwrOptions options = plain_options();
  options.pose_FT.position = Vec3(0.02, 0.05, 0.1);
  options.pose_BD = {Vec3(-0.5, 0.1, 0.3),
                     Quat(Eigen::AngleAxisd(1.0, Vec3(1, 2, 3).normalized()))};
  const auto driver = krc.open(options);
  ASSERT_TRUE(run_to_command(krc, *driver));
  const Cycle t = cycle(krc, *driver, kPush);
  const Wrench wrench_B{options.pose_BD.orientation * kPush.force,
                        options.pose_BD.orientation * kPush.torque};
  const lwr::LwrJoints expected =
      lwr::joint_torque(lwr::LwrArm(options.pose_FT).jacobian(lwr::lwr_rest_posture()), wrench_B);
  EXPECT_LT(difference(t.command.command.add_jnt_trq, expected), 1e-4);
}

TEST(LwrDriver, GivesForceAndPoseThatDoTheSameWork) {
  FakeController krc;
  lwr::LwrOptions options = plain_options();
  options.pose_BD.orientation = Quat(Eigen::AngleAxisd(-0.7, Vec3(3, 2, 1).normalized()));
  const auto driver = krc.open(options);
  ASSERT_TRUE(run_to_command(krc, *driver));
  const Cycle first = cycle(krc, *driver, kPush);
  const lwr::LwrJoints step = 1e-4 * lwr::LwrJoints::Random();
  krc.msr.data.jnt_pos = lwr::fri::to_wire(lwr::LwrJoints(lwr::lwr_rest_posture() + step));
  const Cycle second = cycle(krc, *driver, kPush);
  const Eigen::AngleAxisd turned(second.sample->pose.orientation *
                                 first.sample->pose.orientation.conjugate());
  const double at_tool =
      kPush.force.dot(second.sample->pose.position - first.sample->pose.position) +
      kPush.torque.dot(turned.angle() * turned.axis());
  EXPECT_NEAR(at_tool, lwr::fri::from_wire(first.command.command.add_jnt_trq).dot(step), 2e-5 * 8);
}

TEST(LwrDriver, PostureControlGivesNoForceAtTheTool) {
  FakeController krc;
  const auto driver = krc.open();
  const lwr::LwrArm arm;
  const lwr::LwrJoints n = arm::free_motion(arm.jacobian(lwr::lwr_rest_posture())).normalized();
  const lwr::LwrJoints q = lwr::lwr_rest_posture() + 0.1 * n;
  krc.msr.data.jnt_pos = krc.msr.data.cmd_jnt_pos = lwr::fri::to_wire(q);
  ASSERT_TRUE(run_to_command(krc, *driver));
  double first = 0.0, last = 0.0;
  for (int i = 0; i < 600; ++i) {
    last = torque_of(cycle(krc, *driver).command);
    if (i == 0)
      first = last;
  }
  EXPECT_LT(first, 0.02) << "ramped in";
  EXPECT_GT(last, 0.1);
  const lwr::LwrJoints torque = lwr::fri::from_wire(krc.received.back().command.add_jnt_trq);
  EXPECT_LT(torque.dot(n), 0.0) << "towards the posture";
  EXPECT_LT(torque.dot(lwr::joint_torque(arm.jacobian(q), kPush)), 1e-4);
}

TEST(LwrDriver, ScalesATorqueBeyondTheJointsDown) {
  FakeController krc;
  lwr::LwrOptions options = plain_options();
  options.max_add_torque_nm = lwr::LwrJoints::Constant(20.0);
  const auto driver = krc.open(options);
  ASSERT_TRUE(run_to_command(krc, *driver));
  const Wrench strong{Vec3(0, 60, 100), Vec3::Zero()};
  const Cycle t = cycle(krc, *driver, strong);
  ASSERT_TRUE(t.written);
  EXPECT_NEAR(torque_of(t.command), 20.0, 1e-4);
  const lwr::LwrJoints commanded_joints =
      lwr::joint_torque(lwr::LwrArm().jacobian(lwr::lwr_rest_posture()), strong);
  const lwr::LwrJoints got = lwr::fri::from_wire(t.command.command.add_jnt_trq);
  EXPECT_NEAR(got.normalized().dot(commanded_joints.normalized()), 1.0, 1e-9);
  EXPECT_EQ(driver->counts().scaled, 1U);
}

TEST(LwrDriver, GivesItsWholeForceInEveryDirectionAtTheRestPosture) {
  FakeController krc;
  const auto driver = krc.open(plain_options());
  ASSERT_TRUE(run_to_command(krc, *driver));
  const DeviceDescription& d = driver->description();
  int scaled = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      ASSERT_TRUE(
          cycle(krc, *driver, {sign * 0.99 * d.max_force_n * Vec3::Unit(axis), Vec3::Zero()})
              .written);
      ASSERT_TRUE(
          cycle(krc, *driver, {Vec3::Zero(), sign * 0.99 * d.max_torque_nm * Vec3::Unit(axis)})
              .written);
    }
  scaled = static_cast<int>(driver->counts().scaled);
  EXPECT_EQ(scaled, 0);
}

TEST(LwrDriver, DescribesItself) {
  FakeController krc;
  krc.msr.interface.msr_period_s = krc.msr.interface.cmd_period_s = 0.002F;
  const auto driver = krc.open();
  const DeviceDescription& d = driver->description();
  EXPECT_EQ(d.model, "lwr");
  EXPECT_DOUBLE_EQ(d.rate_hz, 500.0);
  EXPECT_DOUBLE_EQ(d.delay_s, 0.003);
  EXPECT_EQ(d.input_dof, 6U);
  EXPECT_EQ(d.output_dof, 6U);
  EXPECT_FALSE(driver->simulated());
}

TEST(LwrDriver, StampsSamplesByTheControllersPeriods) {
  FakeController krc;
  const auto driver = krc.open();
  const std::int64_t start = cycle(krc, *driver).sample->time_ns;
  EXPECT_EQ(cycle(krc, *driver).sample->time_ns, start + 1'000'000);
  (void)krc.next(), (void)krc.next();  // two lost
  EXPECT_EQ(cycle(krc, *driver).sample->time_ns, start + 4'000'000);
}

TEST(LwrDriver, StopAnswersAndRevokesASentAnswer) {
  FakeController krc;
  const auto driver = krc.open(plain_options());
  ASSERT_TRUE(run_to_command(krc, *driver));
  EXPECT_GT(torque_of(cycle(krc, *driver, kPush).command), 1.0);
  driver->stop();
  auto answers = krc.receive();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(torque_of(answers[0]), 0.0);
  EXPECT_EQ(answers[0].header.refl_seq, krc.msr.header.send_seq);
  driver->stop();
  EXPECT_TRUE(krc.receive().empty()) << "nothing is under way any more";
  krc.send();
  ASSERT_TRUE(driver->read(20ms));
  driver->stop();
  answers = krc.receive();
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(torque_of(answers[0]), 0.0);
  EXPECT_EQ(driver->write(kPush).error(), devices::DeviceError::kTimeout)
      << "the measurement is answered";
}

TEST(LwrDriver, LeavesCommandModeBeforeClosing) {
  FakeController krc;
  lwr::LwrOptions options = plain_options();
  options.stop_timeout_s = 2.0;
  auto driver = krc.open(options);
  ASSERT_TRUE(run_to_command(krc, *driver));
  cycle(krc, *driver, kPush);
  const std::size_t before = krc.received.size();
  const auto start = std::chrono::steady_clock::now();
  krc.close(std::move(driver));
  EXPECT_LT(std::chrono::steady_clock::now() - start, 1s) << "followed, not timed out";
  EXPECT_EQ(krc.msr.interface.state, lwr::fri::State::kMon);
  ASSERT_GT(krc.received.size(), before + 2);
  for (std::size_t n = before; n < krc.received.size(); ++n) {
    EXPECT_EQ(torque_of(krc.received[n]), 0.0);
    EXPECT_EQ(krc.received[n].krl.integer[lwr::fri::kFrmIntRun], lwr::fri::kHalt);
  }
}

TEST(LwrDriver, ClosesInTimeWithoutAController) {
  FakeController krc;
  auto driver = krc.open(plain_options());
  ASSERT_TRUE(run_to_command(krc, *driver));
  cycle(krc, *driver, kPush);
  const auto start = std::chrono::steady_clock::now();
  driver.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, 500ms);
  const auto answers = krc.receive();
  ASSERT_FALSE(answers.empty());
  EXPECT_EQ(torque_of(answers.back()), 0.0);
}

TEST(LwrDriver, WaitsForAControllerInVirtualTime) {
  FakeController krc;
  krc.msr.krl.integer[lwr::fri::kToIntSimulated] = lwr::fri::kVirtualTime;
  krc.port = quick_options().port;
  lwr::LwrOptions options = plain_options();
  options.port = krc.port;
  std::atomic<bool> done{false};
  std::atomic<int> pushes{0};
  std::thread controller([&] {  // the next measurement only after the answer; the first again and
                                // again until there is one
    while (!done && krc.received.empty()) {
      krc.send();
      std::this_thread::sleep_for(2ms);
      krc.receive();
    }
    while (!done) {
      krc.send();
      if (krc.msr.header.send_seq % 16 == 0)
        std::this_thread::sleep_for(5ms);  // busy elsewhere
      while (!done && krc.receive().empty())
        std::this_thread::sleep_for(20us);
      if (torque_of(krc.received.back()) > 1.0)
        ++pushes;
    }
  });
  {
    lwr::LwrDriver driver(options);
    EXPECT_TRUE(driver.simulated());
    for (int n = 0; n < 100; ++n) {
      const auto sample = driver.read(0us);  // its own time counts for nothing here
      ASSERT_TRUE(sample) << n << devices::name_of(sample.error());
      EXPECT_EQ(sample->time_ns, 1'000'000 * n);
      EXPECT_TRUE(driver.write(kPush)) << "in command mode from the first sample on";
    }
  }
  done = true;
  controller.join();
  EXPECT_EQ(pushes, 100);
}

}  // namespace driver_test
}  // namespace voxtouch::test
