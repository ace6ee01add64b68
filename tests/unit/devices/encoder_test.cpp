#include "devices/sim/encoder.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include "devices/sim/tremor.hpp"

namespace voxtouch::devices {
namespace {

TEST(Encoder, RoundsPositionsToTheNearestMultiple) {
  const double r = 3e-5;
  EXPECT_EQ(sim::quantise(Vec3(1.4 * r, -1.6 * r, 0.4 * r), r), Vec3(1 * r, -2 * r, 0.0));
  EXPECT_FALSE(std::signbit(sim::quantise(Vec3(-0.4 * r, 0, 0), r).x()));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-0.2, 0.2);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 x(any(random), any(random), any(random));
    const Vec3 q = sim::quantise(x, r);
    ASSERT_LE((q - x).cwiseAbs().maxCoeff(), 0.5 * r * (1 + 1e-9));
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(q[axis], std::round(q[axis] / r) * r);
    ASSERT_EQ(sim::quantise(q, r), q);
  }
}

TEST(Encoder, RoundsOrientationsWithinTheStatedAngle) {
  const double r = 1e-3;
  EXPECT_EQ(sim::quantise(Quat::Identity(), r).coeffs(), Quat::Identity().coeffs());
  std::mt19937_64 random(2);
  sim::Tremor normal(1.0, 1e3, 1.0, 2);  // only as a source of directions
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 a = normal.next(), b = normal.next();
    const Quat q = Quat(a.x(), a.y(), a.z(), b.x()).normalized();
    const Quat rounded = sim::quantise(q, r);
    ASSERT_NEAR(rounded.norm(), 1.0, 1e-15);
    ASSERT_LE(2.0 * (q.coeffs() - rounded.coeffs()).norm(), 2.0 * r);
  }
  const Quat small(Eigen::AngleAxisd(0.1, Vec3(1, 1, 1).normalized()));
  EXPECT_LE(small.angularDistance(sim::quantise(small, r)), 0.88 * r);
}

TEST(Encoder, IsExactAtZeroResolution) {
  const Vec3 x(0.1234567, 0, 0);
  const Quat q = Quat(1, 2, 3, 4).normalized();
  EXPECT_EQ(sim::quantise(x, 0.0), x);
  EXPECT_EQ(sim::quantise(q, 0.0).coeffs(), q.coeffs());
}

TEST(Encoder, VelocityIsDelayedByHalfAPeriodAndTheFilter) {
  const double period = 1e-3, filter_hz = 50.0;
  sim::Encoder encoder(0.0, 0.0, filter_hz, period);
  const auto at = [](double t) { return Pose{Vec3(0.5 * 2.0 * t * t, 0, 0), Quat::Identity()}; };
  for (int i = 0; i <= 1000; ++i)
    encoder.sample(at(i * period));
  const double lag = 0.5 * period + 1.0 / (2.0 * std::numbers::pi * filter_hz);
  EXPECT_NEAR(encoder.twist().linear.x(), 2.0 * (1.0 - lag), 1e-9);
}

TEST(Encoder, MeasuresRotationInTheOuterAxes) {
  sim::Encoder encoder(0.0, 1e-6, 50.0, 1e-3);
  const Vec3 rate(0.0, 0.0, 1.5);
  const Quat start(Eigen::AngleAxisd(1.0, Vec3::UnitX()));
  for (int i = 0; i <= 1000; ++i)
    encoder.sample({Vec3::Zero(), Quat(Eigen::AngleAxisd(1.5 * i * 1e-3, Vec3::UnitZ())) * start});
  EXPECT_LT((encoder.twist().angular - rate).norm(), 2e-3);
}

TEST(Encoder, VelocityIsZeroAtFirstAndAtRest) {
  sim::Encoder encoder(3e-5, 1e-3, 50.0, 1e-3);
  for (int i = 0; i < 5; ++i) {
    encoder.sample({Vec3(0.1, 0.2, 0.3), Quat(0.5, 0.5, 0.5, 0.5)});
    EXPECT_TRUE(encoder.twist().linear.isZero(0.0));
    EXPECT_TRUE(encoder.twist().angular.isZero(0.0));
  }
}

TEST(Tremor, HasTheStatedDeviationAndBandwidth) {
  sim::Tremor tremor(0.5, 10.0, 1e-3, 9);
  double square = 0.0, product = 0.0, last = 0.0;
  const int n = 400'000;
  for (int i = 0; i < n; ++i) {
    const double f = tremor.next().y();
    square += f * f, product += f * last, last = f;
  }
  EXPECT_NEAR(std::sqrt(square / n), 0.5, 0.02);
  EXPECT_NEAR(product / square, 1.0 / (1.0 + 2.0 * std::numbers::pi * 10.0 * 1e-3), 0.01);
}

TEST(Tremor, IsReproducibleAndAbsentByDefault) {
  sim::Tremor a(0.5, 10.0, 1e-3, 7), b(0.5, 10.0, 1e-3, 7), c(0.5, 10.0, 1e-3, 8),
      none(0.0, 10.0, 1e-3, 7);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const Vec3 x = a.next();
    ASSERT_EQ(x, b.next());
    differs = differs || x != c.next();
    ASSERT_TRUE(none.next().isZero(0.0));
  }
  EXPECT_TRUE(differs);
}

/// Computed by a separate implementation of the generator and the mapping: another library has to
/// draw the same numbers.
TEST(Tremor, DrawsTheRecordedNumbers) {
  sim::Tremor tremor(1.0, 10.0, 1e-3, 42);
  const Vec3 first = tremor.next();
  EXPECT_EQ(first, Vec3(-0.19387934433300708, -0.05737703622725414, -0.1003234688204369));
  tremor.next();
  EXPECT_EQ(tremor.next(), Vec3(0.215585547735003, -0.002354199121429989, -0.30563957360476923));
}

}  // namespace
}  // namespace voxtouch::devices
