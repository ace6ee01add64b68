// Poses that are none.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/coupling/running_coupling.hpp"
#include "core/rendering/device_mapping.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::test {
namespace poses_test {

constexpr double kEdge = 2e-3, kPeriod = 1e-3, kMaxN = 8.5;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInf = std::numeric_limits<double>::infinity();
constexpr std::array kModels = {contact::ContactModelKind::kOriginal,
                                contact::ContactModelKind::kAdapted,
                                contact::ContactModelKind::kField};

std::vector<Pose> broken(const Pose& good) {
  std::vector<Pose> bad;
  for (const double x : {kNan, kInf, -kInf, 1e300})
    for (int axis = 0; axis < 3; ++axis) {
      bad.push_back(good);
      bad.back().position[axis] = x;
    }
  for (const double x : {kNan, kInf})
    for (int part = 0; part < 4; ++part) {
      bad.push_back(good);
      bad.back().orientation.coeffs()[part] = x;
    }
  for (const double scale : {0.0, 5e-324, 1e-310, 1e-4, 0.998, 1.002, 1e4, 1e300}) {
    bad.push_back(good);
    bad.back().orientation.coeffs() *= scale;
  }
  return bad;
}

/// The computations of rendering and coupling node for a sample.
struct Ring {
  rendering::DeviceMapping mapping{scene::WorkspaceMapping{}};
  contact::ContactRenderer& contact;
  coupling::RunningCoupling coupling;
  contact::StageResult touch;
  int refused = 0;
  explicit Ring(contact::ContactRenderer& renderer)
      : contact(renderer),
        coupling(
            [] {
              coupling::CouplingSpec spec;
              spec.kind = "shaping_filter", spec.cutoff_hz = 60;
              return spec;
            }(),
            {.max_force_n = kMaxN, .max_torque_nm = 0.5}, kPeriod) {}
  coupling::CouplingOutput sample(const Pose& tip) {
    if (mapping.update(tip, {}, 0).refused)
      ++refused;
    else
      touch = contact.render(mapping.tool().pose);
    coupling::CouplingInput in;
    in.contact = touch.contact.wrench;
    in.contact_stiffness_n_per_m = touch.contact.stiffness_bound_n_per_m,
    in.contact_stiffness = touch.contact.stiffness;
    in.tool = mapping.tool().pose;
    return coupling.step(in, kPeriod);
  }
};

TEST(F7InvalidPoses, ForceStaysFiniteAndRecovers) {
  const Ball ball(10e-3, 4);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  const Ground ground(box_mesh(Vec3(0.06, 0.06, 0.02), {Vec3(0, 0, -0.01), Quat::Identity()}),
                      kEdge);
  const Pose good = ball.posed(Vec3(0.001, 0.002, 10e-3 - 0.6 * kEdge),
                               Quat(Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized())));
  const std::vector<Pose> bad = broken(good);
  for (const contact::ContactModelKind kind : kModels) {
    contact::ContactRenderer renderer(
        ground.voxmap, shell, kind,
        {kind == contact::ContactModelKind::kField ? 3e7 : 1e7, contact::PointWeights::kArea},
        &ground.field);
    Ring ring(renderer);
    const auto rest = [&] {
      coupling::CouplingOutput out;
      for (int n = 0; n < 400; ++n)
        out = ring.sample(good);
      return out.wrench.force;
    };
    const Vec3 settled = rest();
    ASSERT_GT(settled.norm(), 0.1) << contact::name_of(kind);
    std::size_t round = 0;
    for (const int cycles : {1, 2, 3, 5, 10, 30, 100})
      for (std::size_t first = 0; first < bad.size(); ++first, ++round) {
        const int before = ring.refused;
        int refused = 0;
        for (int n = 0; n < cycles; ++n) {
          const Pose& pose =
              bad[cycles < 10 ? first : (first + static_cast<std::size_t>(n)) % bad.size()];
          const coupling::CouplingOutput out = ring.sample(pose);
          // 1e300 m is a number, but no place.
          refused += !pose.finite() || std::abs(pose.orientation.norm() - 1.0) > 1e-3 ||
                     pose.position.norm() > 1e12;
          ASSERT_TRUE(out.wrench.finite());
          ASSERT_LE(out.wrench.force.norm(), kMaxN * (1 + 1e-12));
        }
        EXPECT_EQ(ring.refused - before, refused);
        for (int n = 0; n < 3; ++n) {
          const coupling::CouplingOutput out = ring.sample(good);
          ASSERT_TRUE(out.wrench.finite());
          ASSERT_LE(out.wrench.force.norm(), kMaxN * (1 + 1e-12));
        }
      }
    EXPECT_LE((rest() - settled).norm(), 0.02 * settled.norm()) << contact::name_of(kind);
    EXPECT_GT(ring.refused, 1000);
  }
}

TEST(F7InvalidPoses, AreRefusedAndLeaveContactUnchanged) {
  const Ball ball(10e-3, 3);
  const Ground ground(box_mesh(Vec3(0.06, 0.06, 0.02), {Vec3(0, 0, -0.01), Quat::Identity()}),
                      kEdge);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  for (const contact::ContactModelKind kind : kModels) {
    contact::ContactRenderer disturbed = ground.renderer(shell, kind),
                             clean = ground.renderer(shell, kind);
    // Fast frames among them: how far the tool has moved counts from the last good pose.
    for (const double z : {16.0, 14.5, 12.0, 9.0, 6.0, 0.0, -6.0, -12.0, -18.0, -24.0, -20.0, -14.0,
                           -6.0, 2.0, 10.0, 10.1, 9.9}) {
      const Pose good = ball.posed(Vec3(0.001, 0.002, 1e-3 * z), Quat::Identity());
      for (const Pose& pose : broken(good)) {
        const bool scaled =
            pose.finite() &&
            pose.position == good.position;  // any norm of 1e-3 to 1e3 is taken here
        if (scaled && pose.orientation.norm() > 1e-3 && pose.orientation.norm() < 1e3)
          continue;
        const contact::StageResult r = disturbed.render(pose);
        EXPECT_NE(r.contact.pose_status, contact::PoseStatus::kUsable);
        EXPECT_TRUE(r.contact.wrench.zero());
      }
      const contact::StageResult a = disturbed.render(good), b = clean.render(good);
      EXPECT_EQ(a.contact.wrench.force, b.contact.wrench.force)
          << contact::name_of(kind) << " at " << z;
      EXPECT_TRUE(a.tunnelling_suspected == b.tunnelling_suspected && a.fast == b.fast &&
                  a.latched == b.latched);
    }
  }
}

TEST(F7InvalidPoses, NegatedQuaternionIsBitIdentical) {
  const Ball ball(10e-3, 3);
  const Ground ground(box_mesh(Vec3(0.06, 0.06, 0.02), {Vec3(0, 0, -0.01), Quat::Identity()}),
                      kEdge);
  const pointshell::Pointshell shell = exact_shell(ball.mesh, kEdge);
  for (const contact::ContactModelKind kind : kModels) {
    contact::ContactRenderer a = ground.renderer(shell, kind), b = ground.renderer(shell, kind);
    int fast = 0;
    for (int n = 0; n < 60; ++n) {
      // Slow and fast rotations: up to 0.18 rad per frame.
      const Pose pose =
          ball.posed(Vec3(0.001, 0.002, 9.2e-3),
                     Quat(Eigen::AngleAxisd(0.0015 * n * n, Vec3(1, 2, 3).normalized())));
      Pose minus = pose;
      if (n % 2 == 1)
        minus.orientation.coeffs() *= -1.0;
      const contact::StageResult x = a.render(pose), y = b.render(minus);
      EXPECT_EQ(x.contact.wrench.force, y.contact.wrench.force)
          << contact::name_of(kind) << " " << n;
      EXPECT_EQ(x.contact.wrench.torque, y.contact.wrench.torque);
      EXPECT_EQ(x.fast, y.fast);
      EXPECT_EQ(x.tunnelling_suspected, y.tunnelling_suspected);
      fast += x.fast;
    }
    EXPECT_GT(fast, 10);
  }
}

}  // namespace poses_test
}  // namespace voxtouch::test
