#include "core/types/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace voxtouch {
namespace {

Motion zigzag() {
  Motion m;
  m.path = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.05, 0}, {0.1, 0.05, 0}, {0.02, 0.05, 0.03}};
  m.speed_m_per_s = 0.05;
  m.hold_s = 0.2;
  return m;
}

Motion round_trip() {
  Motion m;
  m.path = {{0, 0, 0.1}, {0.03, 0, 0}};
  m.speed_m_per_s = 0.05;
  m.circle_centre =
      Vec3(0, 0, 0.02);  // off the circle's plane: only the distance across the axis counts
  return m;
}

/// Steps through a motion: a position step never beats the peak speed, a velocity step never the
/// peak acceleration, and the velocity is the position's derivative.
void expect_smooth(const Motion& m, double end_s, double peak_acceleration) {
  const double dt = 1e-4;
  MotionPoint before = motion_at(m, 0.0);
  double fastest = 0.0;
  for (double t = dt; t < end_s; t += dt) {
    const MotionPoint now = motion_at(m, t);
    ASSERT_LE((now.position - before.position).norm(), m.speed_m_per_s * dt * (1 + 1e-9) + 1e-15)
        << "t " << t;
    ASSERT_LE((now.velocity - before.velocity).norm(), peak_acceleration * dt * 1.01 + 1e-12)
        << "t " << t;
    const Vec3 mean = 0.5 * (now.velocity + before.velocity);
    ASSERT_LE(((now.position - before.position) / dt - mean).norm(), 1e-6) << "t " << t;
    fastest = std::max(fastest, now.velocity.norm());
    before = now;
  }
  EXPECT_NEAR(fastest, m.speed_m_per_s, 1e-6);
}

/// Peak of |60 s - 180 s^2 + 120 s^3| is 10/sqrt(3); the shortest piece accelerates hardest.
double hardest(const Motion& m, double shortest_m) {
  const double duration = kMinimumJerkPeak * shortest_m / m.speed_m_per_s;
  return 10.0 / std::sqrt(3.0) * shortest_m / (duration * duration);
}

TEST(Motion, PositionAndVelocityAreContinuousAndBelong) {
  Motion m = zigzag();
  expect_smooth(m, approach_duration(m) + 1.0, hardest(m, 0.05));
  m.repeat_from = 1;
  expect_smooth(m, 30.0, hardest(m, 0.05));
}

TEST(Motion, CircleStartsSmoothlyAndKeepsItsSpeed) {
  const Motion m = round_trip();
  const double radius = 0.03, full = m.speed_m_per_s / radius;
  const double rise = 1.5 * full * full / std::numbers::pi;  // of the angular speed
  expect_smooth(m, approach_duration(m) + 20.0,
                std::max(hardest(m, 0.1), radius * std::hypot(rise, full * full)));
  const double start = approach_duration(m);
  for (double t = start + std::numbers::pi / full; t < start + 20.0; t += 0.0137) {
    const MotionPoint p = motion_at(m, t);
    EXPECT_NEAR(p.velocity.norm(), m.speed_m_per_s, 1e-12);
    EXPECT_NEAR(p.position.head<2>().norm(), radius, 1e-12);
    EXPECT_NEAR(p.position.z(), 0.0, 1e-12);
  }
  // 90 degrees during the rise, in the time of 180; right-handed about the axis.
  const MotionPoint quarter = motion_at(m, start + std::numbers::pi / full);
  EXPECT_LE((quarter.position - Vec3(0, radius, 0)).norm(), 1e-12);
  EXPECT_LE((quarter.velocity - Vec3(-m.speed_m_per_s, 0, 0)).norm(), 1e-12);
}

TEST(Motion, PeakSpeedOfEveryPieceIsTheRequestedSpeed) {
  const Motion m = zigzag();
  double t = m.hold_s;
  for (std::size_t i = 0; i + 1 < m.path.size(); ++i) {
    const double length = (m.path[i + 1] - m.path[i]).norm();
    const double duration = kMinimumJerkPeak * length / m.speed_m_per_s;
    if (length > 0) {
      EXPECT_NEAR(motion_at(m, t + 0.5 * duration).velocity.norm(), m.speed_m_per_s, 1e-12);
      EXPECT_LT(motion_at(m, t + 0.4 * duration).velocity.norm(), m.speed_m_per_s);
    }
    t += duration;
    EXPECT_LE((motion_at(m, t + 0.5 * m.hold_s).position - m.path[i + 1]).norm(), 0.0);
    EXPECT_EQ(motion_at(m, t + 0.5 * m.hold_s).velocity.norm(), 0.0);
    t += m.hold_s;
  }
  EXPECT_NEAR(approach_duration(m), t, 1e-12);
}

TEST(Motion, BackAndForthHasAPeriod) {
  Motion m = zigzag();
  m.repeat_from = 1;
  double period = 0;
  for (std::size_t i = 1; i + 1 < m.path.size(); ++i)
    period +=
        2 * (kMinimumJerkPeak * (m.path[i + 1] - m.path[i]).norm() / m.speed_m_per_s + m.hold_s);
  const double start = approach_duration(m);
  for (double t = start; t < start + 2 * period; t += 0.0173) {
    const MotionPoint a = motion_at(m, t), b = motion_at(m, t + 1000 * period);
    EXPECT_LE((a.position - b.position).norm(), 1e-10);
    EXPECT_LE((a.velocity - b.velocity).norm(), 1e-8);
    EXPECT_GE(a.position.x(), 0.02 - 1e-12) << "never back to point 0, which is before repeat_from";
    EXPECT_TRUE(a.position.y() > -1e-12);
  }
  EXPECT_LE((motion_at(m, start + 0.5 * period - 0.5 * m.hold_s).position - m.path[1]).norm(),
            1e-12);
  EXPECT_LE((motion_at(m, start + period - 0.5 * m.hold_s).position - m.path.back()).norm(), 1e-12);
}

TEST(Motion, SinglePointsAndZeroLengthPiecesRest) {
  Motion m;
  m.path = {{1, 2, 3}};
  for (const double t : {0.0, 1.0, 1e9})
    EXPECT_EQ(motion_at(m, t).position, m.path[0]);
  m.path = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  m.repeat_from = 0;
  for (const double hold : {0.0, 0.5}) {
    m.hold_s = hold;
    for (const double t : {0.0, 0.25, 0.5, 1.0, 1.7, 1e9}) {
      EXPECT_EQ(motion_at(m, t).position, m.path[0]);
      EXPECT_EQ(motion_at(m, t).velocity, Vec3::Zero().eval());
    }
  }
  m.repeat_from = 7;  // beyond the path: holds
  EXPECT_EQ(motion_at(m, 10.0).position, m.path[0]);
  m.circle_centre = Vec3(1, 2, 0);  // on the axis through the point: no radius
  EXPECT_EQ(motion_at(m, 10.0).position, m.path[0]);
  EXPECT_EQ(motion_at(Motion{}, 1.0).position, Vec3::Zero().eval());
}

TEST(Motion, AcceptsAnyTime) {
  Motion walk = zigzag();
  walk.repeat_from = 1;
  const double inf = std::numeric_limits<double>::infinity(),
               nan = std::numeric_limits<double>::quiet_NaN();
  for (const Motion& m : {zigzag(), walk, round_trip()}) {
    for (const double t : {nan, -inf, -1.0, -0.0})
      EXPECT_EQ(motion_at(m, t).position, m.path[0]);
    for (const double t : {1e6, 1e9, 1e12, 1e15, 1e300, inf}) {
      const MotionPoint p = motion_at(m, t);
      EXPECT_TRUE(p.position.allFinite() && p.velocity.allFinite());
      EXPECT_LE(p.position.norm(), 0.2);
      EXPECT_LE(p.velocity.norm(), m.speed_m_per_s * (1 + 1e-12));
    }
  }
  for (const double speed : {0.0, -1.0, nan}) {
    Motion m = zigzag();
    m.speed_m_per_s = speed;
    EXPECT_EQ(motion_at(m, 5.0).position, m.path[0]);
  }
}

TEST(Motion, DeviceMotionMovesTheToolAsInTheWorld) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto quat = [&] { return Quat(u(random), u(random), u(random), u(random)).normalized(); };
  const auto vec = [&] { return Vec3(u(random), u(random), u(random)); };
  for (int attempt = 0; attempt < 20; ++attempt) {
    Motion w = attempt % 2 ? round_trip() : zigzag();
    w.orientation = quat();
    w.circle_axis = vec().normalized();
    w.turn = {vec().normalized(), 2.0 * u(random), 1.0, 9.0};
    const Pose base{vec(), quat()}, offset{0.1 * vec(), quat()};
    const double scale = 0.2 + std::abs(u(random)) * 5;
    const Motion d = motion_in_device(w, base, offset, scale);
    for (double t = 0; t < 20; t += 0.37) {
      const MotionPoint in_w = motion_at(w, t), in_d = motion_at(d, t);
      const Pose tool =
          base * Pose{scale * in_d.position, orientation_at(d, t).orientation} * offset;
      // The hand rotates about the device's tip, and the tool's origin with it.
      const Vec3 arm = base.orientation * (d.orientation * offset.position),
                 turned = base.orientation * (orientation_at(d, t).orientation * offset.position);
      EXPECT_LE((tool.position - in_w.position - (turned - arm)).norm(), 1e-12);
      EXPECT_LE(tool.orientation.angularDistance(orientation_at(w, t).orientation), 1e-7);
      EXPECT_LE((scale * (base.orientation * in_d.velocity) - in_w.velocity).norm(), 1e-12);
    }
  }
}

TEST(Motion, RotatesFromRestToRestAndStays) {
  Motion m = zigzag();
  m.orientation = Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX()));
  m.turn = {Vec3::UnitY(), 0.2, 1.0, 3.0};
  for (const double t : {-1.0, 0.0, 1.0}) {
    EXPECT_EQ(orientation_at(m, t).orientation.coeffs(), m.orientation.coeffs());
    EXPECT_EQ(orientation_at(m, t).rate, Vec3::Zero().eval());
  }
  const Quat end = Quat(Eigen::AngleAxisd(0.2, Vec3::UnitY())) * m.orientation;
  for (const double t : {3.0, 1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_LE(orientation_at(m, t).orientation.angularDistance(end), 1e-12);
    EXPECT_EQ(orientation_at(m, t).rate, Vec3::Zero().eval());
  }
  constexpr double kStep = 1e-5;
  for (double t = 1.05; t < 3.0; t += 0.1) {
    const Quat before = orientation_at(m, t - kStep).orientation,
               after = orientation_at(m, t + kStep).orientation;
    EXPECT_LE(
        (2.0 * (after * before.conjugate()).vec() / (2 * kStep) - orientation_at(m, t).rate).norm(),
        1e-7);
  }
  EXPECT_LE(orientation_at(m, 2.0).orientation.angularDistance(
                Quat(Eigen::AngleAxisd(0.1, Vec3::UnitY())) * m.orientation),
            1e-12);
}

}  // namespace
}  // namespace voxtouch
