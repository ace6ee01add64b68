#include "devices/recorded/recorded_device.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "devices/registry.hpp"

namespace voxtouch::devices {
namespace recorded_device_test {

using recorded::HandPlayer;
using recorded::RecordedDevice;
using recorded::RecordedHand;
using std::chrono::microseconds;

/// Goes along x by 1 mm a sample and turns about z by 0.01 rad a sample, at 1 kHz, from a clock
/// that does not start at 0.
RecordedHand straight(int samples) {
  RecordedHand hand{describe_device("sim-phantom"), {}};
  hand.description.max_force_n = 5.0;
  for (int i = 0; i < samples; ++i) {
    DeviceSample sample;
    sample.time_ns = 7'000'000'000 + i * 1'000'000;
    sample.pose.position = {0.001 * i, 0.1, -0.2 / 3.0};
    sample.pose.orientation = Eigen::AngleAxisd(0.01 * i, Vec3::UnitZ());
    sample.twist = {Vec3(1.0, 0.0, 0.0), Vec3(0.0, 0.0, 10.0)};
    sample.buttons = i >= 5 ? 1U : 0U;
    hand.samples.push_back(sample);
  }
  return hand;
}

void expect_same(const DeviceSample& played, const DeviceSample& recorded) {
  EXPECT_EQ(played.pose, recorded.pose);
  EXPECT_EQ(played.twist.linear, recorded.twist.linear);
  EXPECT_EQ(played.twist.angular, recorded.twist.angular);
  EXPECT_EQ(played.buttons, recorded.buttons);
  EXPECT_EQ(played.pose_valid, recorded.pose_valid);
}

double angle_of(const DeviceSample& sample) {
  return 2.0 * std::atan2(sample.pose.orientation.z(), sample.pose.orientation.w());
}

TEST(RecordedDevice, GivesTheRecordedSamplesBitForBitAtTheirSpeedWithStampsFromZero) {
  const RecordedHand hand = straight(50);
  RecordedDevice device(hand, 1.0);
  EXPECT_TRUE(device.simulated());
  ASSERT_EQ(device.recorded_samples(), 50U);
  for (int i = 0; i < 50; ++i) {
    const auto sample = device.read(microseconds(0));
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->time_ns, i * 1'000'000);
    expect_same(*sample, hand.samples[static_cast<std::size_t>(i)]);
    ASSERT_TRUE(device.write({Vec3(4.0, 0.0, 0.0), Vec3::Zero()}))
        << "it takes force as the device did";
  }
}

TEST(RecordedDevice, AtHalfItsSpeedMovesHalfAsFastAlongTheSameWay) {
  const RecordedHand hand = straight(50);
  HandPlayer player(hand, 0.5);
  ASSERT_EQ(player.count(), 99U);
  for (std::uint64_t k = 0; k < 99; ++k) {
    const DeviceSample sample = player.sample(k);
    EXPECT_NEAR(sample.pose.position.x(), 0.0005 * static_cast<double>(k), 1e-15);
    EXPECT_NEAR(angle_of(sample), 0.005 * static_cast<double>(k), 1e-12);
    EXPECT_DOUBLE_EQ(sample.twist.linear.x(), 0.5);
    EXPECT_DOUBLE_EQ(sample.twist.angular.z(), 5.0);
    EXPECT_EQ(sample.buttons, k >= 10 ? 1U : 0U) << k;
    EXPECT_EQ(sample.time_ns, static_cast<std::int64_t>(k) * 1'000'000);
  }
}

TEST(RecordedDevice, AtThreeTimesItsSpeedTakesEveryThirdSample) {
  const RecordedHand hand = straight(50);
  HandPlayer player(hand, 3.0);
  ASSERT_EQ(player.count(), 17U);
  EXPECT_EQ(player.sample(16).pose, hand.samples[48].pose);
  EXPECT_EQ(player.sample(2).pose, hand.samples[6].pose) << "and goes back";
  EXPECT_DOUBLE_EQ(player.sample(3).twist.linear.x(), 3.0);
}

TEST(RecordedDevice, BridgesWhatTheRecordingLostInAStraightLineAlongTheShortestArc) {
  RecordedHand hand = straight(50);
  hand.samples[19].pose_valid = false;
  hand.samples[30].pose.orientation.coeffs() *= -1.0;  // the same orientation
  hand.samples.erase(hand.samples.begin() + 20, hand.samples.begin() + 30);
  HandPlayer player(hand, 1.0);
  ASSERT_EQ(player.count(), 50U);
  for (std::uint64_t k = 20; k < 30; ++k) {
    const DeviceSample sample = player.sample(k);
    EXPECT_NEAR(sample.pose.position.x(), 0.001 * static_cast<double>(k), 1e-12);
    EXPECT_NEAR(angle_of(sample), 0.01 * static_cast<double>(k), 1e-9);
    EXPECT_NEAR(sample.pose.orientation.norm(), 1.0, 1e-12);
    EXPECT_FALSE(sample.pose_valid) << "one of its ends was not to be trusted";
  }
  EXPECT_TRUE(player.sample(30).pose_valid);
}

TEST(RecordedDevice, RestsWhereTheRecordingEnds) {
  HandPlayer player(straight(10), 1.0);
  const DeviceSample last = player.sample(25);
  EXPECT_DOUBLE_EQ(last.pose.position.x(), 0.009);
  EXPECT_TRUE(last.twist.linear.isZero() && last.twist.angular.isZero());
  EXPECT_EQ(last.time_ns, 25'000'000);
}

TEST(RecordedDevice, RefusesCommandsAsTheDeviceDid) {
  RecordedDevice device(straight(10), 1.0);
  EXPECT_EQ(device.write({Vec3(6.0, 0.0, 0.0), Vec3::Zero()}).error(), DeviceError::kLimit);
  EXPECT_EQ(device.write({Vec3(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0), Vec3::Zero()})
                .error(),
            DeviceError::kNotFinite);
}

TEST(RecordedDevice, RefusesWhatCannotBePlayed) {
  EXPECT_THROW(HandPlayer(RecordedHand{}, 1.0), std::runtime_error);
  for (const double speed : {0.0, -1.0, 11.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(HandPlayer(straight(3), speed), std::runtime_error) << speed;
  RecordedHand hand = straight(3);
  hand.samples[2].time_ns = hand.samples[1].time_ns;
  EXPECT_THROW(HandPlayer(hand, 1.0), std::runtime_error);
  hand = straight(3);
  hand.samples[0].time_ns = std::numeric_limits<std::int64_t>::min();
  EXPECT_THROW(HandPlayer(hand, 1.0), std::runtime_error)
      << "a difference of such stamps is no number";
  hand = straight(3);
  hand.samples[1].pose.position.y() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(HandPlayer(hand, 1.0), std::runtime_error);
}

TEST(RecordedDevice, OpensByItsNameWithTheBagThatTheCallerHasRead) {
  DeviceOptions options;
  EXPECT_THROW(open_device("replay:somewhere", options), DeviceOpenError);
  options.recorded = std::make_shared<const RecordedHand>(straight(40));
  options.settings = {{"speed", "2"}};
  EXPECT_EQ(open_device("replay:somewhere", options)->recorded_samples(), 20U);
  EXPECT_TRUE(describe_device("replay:somewhere", options).simulated);
  EXPECT_FALSE(has_simulated_hand("replay:somewhere"));
  EXPECT_THROW(usual_hand("replay:somewhere", options), DeviceOpenError);
  for (const char* speed : {"0", "nan", "100", "fast"}) {
    options.settings = {{"speed", speed}};
    EXPECT_THROW(open_device("replay:somewhere", options), DeviceOpenError) << speed;
    EXPECT_THROW(describe_device("replay:somewhere", options), DeviceOpenError) << speed;
  }
  options.settings = {{"sped", "1"}};
  EXPECT_THROW(open_device("replay:somewhere", options), DeviceOpenError);
  EXPECT_EQ(open_device("sim-phantom")->recorded_samples(), 0U);
}

}  // namespace recorded_device_test
}  // namespace voxtouch::devices
