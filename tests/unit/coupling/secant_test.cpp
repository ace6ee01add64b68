// The cap on the contact's stiffness caps how the force grows: it reaches the cap times the depth,
// and not half of it.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/coupling/running_coupling.hpp"

namespace voxtouch::coupling {
namespace secant_test {

constexpr double kT = 1e-3, kCap = 300.0, kRadius = 0.01, kStep = 1e-5;
const double kInf = std::numeric_limits<double>::infinity();

/// A ball pressed by `depth` into the plane z = 0 from above, as the contact models have it: points
/// of `k` each, `layer` the depth beyond which a point's push grows no more and counts in the
/// stiffness all the same.
CouplingInput ball(double depth, double k, double layer = kInf) {
  constexpr int kRings = 60;
  CouplingInput in;
  for (int i = 0; i < kRings; ++i) {
    const double angle = 0.5 * std::numbers::pi * (i + 0.5) / kRings,
                 own = depth - kRadius * (1.0 - std::cos(angle));
    if (own <= 0.0)
      continue;
    const double stiffness = k * 6.0 * (i + 0.5);  // points of equal areas
    in.contact.force.z() += stiffness * std::min(own, layer);
    in.contact_stiffness_n_per_m += stiffness;
    in.contact_stiffness(2, 2) += stiffness;
    in.contact_depth_m = std::max(in.contact_depth_m, std::min(own, layer));
    in.depth_goes_on |= own > layer;
  }
  in.tool.position.z() = -depth;
  return in;
}

CouplingSpec direct(double cap = kCap) {
  CouplingSpec spec;
  spec.kind = "direct", spec.stiffness_cap_n_per_m = cap;
  return spec;
}

RunningCoupling running(double cap = kCap) { return RunningCoupling(direct(cap), {}, kT); }

double press(RunningCoupling& coupling, const CouplingInput& in) {
  return coupling.step(in, kT).wrench.force.z();
}

/// From free space to `depth`, slowly.
double press_to(RunningCoupling& coupling, double depth, double k, double layer = kInf) {
  double force = press(coupling, {});
  for (double d = 0.0; d < depth; d += kStep)
    force = press(coupling, ball(d, k, layer));
  return force;
}

TEST(Secant, UnderABallIsTheCapButForTheDepthThatTheBallTakesToBecomeAsStiff) {
  for (const double k : {0.2, 1.0, 20.0}) {
    RunningCoupling coupling = running();
    double before = 0.0, as_stiff = 0.0;
    for (double depth = 0.0; depth <= kRadius; depth += kStep) {
      const CouplingInput in = ball(depth, k);
      const double force = press(coupling, in);
      if (in.contact_stiffness_n_per_m < kCap)
        as_stiff = depth;
      ASSERT_GE(force, before) << k << ": falls at " << depth;
      ASSERT_LE(force - before, kCap * kStep * (1 + 1e-9))
          << k << ": steeper than the cap at " << depth;
      ASSERT_LE(force, in.contact.force.z() * (1 + 1e-12));
      ASSERT_GE(force,
                0.999 * std::min(in.contact.force.z(), kCap * (depth - as_stiff - 2 * kStep)))
          << k << " at " << depth;
      if (depth > 20.0 * as_stiff + 1e-3) {
        ASSERT_GE(force, 0.95 * kCap * depth) << k << " at " << depth;
      }
      before = force;
    }
    EXPECT_GT(before, 0.9 * kCap * kRadius) << k;
  }
}

TEST(Secant, FallsOnTheWayOutAsItRoseAndGivesNoEnergy) {
  for (const double layer : {kInf, 1e-3})
    for (const double k : {0.2, 1.0, 20.0}) {
      RunningCoupling coupling = running();
      std::vector<double> in;
      double work = 0.0;
      for (double depth = 0.0; depth <= 0.008; depth += kStep)
        in.push_back(press(coupling, ball(depth, k, layer)));
      for (std::size_t n = 1; n < in.size(); ++n)
        work += 0.5 * (in[n] + in[n - 1]) * kStep;
      double before = in.back();
      for (std::size_t n = in.size() - 1; n-- > 0;) {
        const double force = press(coupling, ball(kStep * static_cast<double>(n), k, layer));
        ASSERT_LE(force, in[n] * (1 + 1e-9) + kCap * kStep) << k << ", " << layer << " at " << n;
        ASSERT_GE(force, in[n] - 0.1 * in.back())
            << k << " at " << n << ": the scale lags by milliseconds, no more";
        work -= 0.5 * (force + before) * kStep;
        before = force;
      }
      EXPECT_GE(work, -1e-6 * kCap * 0.008 * 0.008) << k;
      EXPECT_EQ(press(coupling, {}), 0.0);
      for (int n = 0; n < 100; ++n)
        press(coupling, {});
      EXPECT_NEAR(press(coupling, ball(kStep, k)), in[1], 1e-12)
          << "the next contact begins as the first one did";
    }
}

/// A model that knows depth in one layer: its sum over points grows, their mean depth falls, and
/// the hand's force goes on as the hand does.
TEST(Secant, GoesOnWithTheHandWhereDepthIsHeldAsFarAsTheContactItselfPushes) {
  for (const double k : {1.0, 20.0}) {
    RunningCoupling coupling = running();
    double before = 0.0;
    for (double depth = 0.0; depth <= kRadius; depth += kStep) {
      const CouplingInput in = ball(depth, k, 1e-3);
      const double force = press(coupling, in);
      ASSERT_GE(force, before * (1 - 1e-3)) << k << " at " << depth;
      ASSERT_LE(force, std::min(in.contact.force.z(), kCap * depth) * (1 + 1e-9))
          << k << " at " << depth;
      if (k > 10.0 && depth > 1e-3) {
        ASSERT_GE(force, 0.95 * kCap * depth) << depth;
      }
      before = force;
    }
    EXPECT_GT(before, k > 10.0 ? 0.95 * kCap * kRadius : kCap * 1e-3) << k;
  }
}

/// Normals of such a model lean to and fro by up to 17 degrees along the way, and its force has
/// noise.
TEST(Secant, IsNotWoundUpOrLetDownBySlidingWhereDepthIsHeld) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  for (const double lean : {0.0, 0.2, -0.2}) {  // to all sides, or always against or with the way
    RunningCoupling coupling = running();
    const double pressed = press_to(coupling, 0.005, 20.0, 1e-3);
    double force = pressed, along = 0.0;
    for (int n = 0; n < 5000; ++n) {
      CouplingInput in = ball(0.005, 20.0, 1e-3);
      const Vec3 normal = Vec3(lean + 0.1 * u(random), 0.3 * u(random), 1.0).normalized();
      const double saw = 1.0 + 0.02 * ((n % 20) / 20.0 -
                                       0.5);  // rises slowly over a voxel and falls at its border
      in.contact.force = saw * in.contact.force.z() * normal;
      in.contact_stiffness.topLeftCorner<3, 3>() =
          in.contact_stiffness_n_per_m * normal * normal.transpose();
      in.tool.position.x() = along += 1e-4;
      force = coupling.step(in, kT).wrench.force.norm();
      ASSERT_NEAR(force, pressed, 0.1 * pressed) << lean << " after " << along;
    }
  }
}

TEST(Secant, LeavesWhatIsBelowTheCapToTheLastBit) {
  RunningCoupling coupling = running(1e5);
  for (double depth = 0.0; depth <= kRadius; depth += kStep) {
    const CouplingInput in = ball(depth, 0.5);
    const CouplingOutput out = coupling.step(in, kT);
    ASSERT_EQ(out.wrench.force, in.contact.force);
    ASSERT_EQ(out.scale, 1.0);
  }
}

/// Whatever way the hand takes: at least what s leaves, at most the wrench itself and, but for a
/// time that runs out, the cap times the depth.
TEST(Secant, StaysBetweenItsBoundsOnAnyWay) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> u(-1, 1);
  StiffnessCap cap(direct());
  cap.step({}, {}, kT);
  double depth = 0.0, k = 1.0;
  for (int n = 0; n < 50'000; ++n) {
    depth = std::clamp(depth + 1e-4 * u(random), -1e-3, 5e-3);
    k = std::clamp(k * std::exp(0.05 * u(random)), 0.05, 50.0);
    const CouplingInput in = ball(depth, k);
    const CapShares shares = cap.step(in, {}, kT);
    ASSERT_LE(shares.wrench, 1.0);
    ASSERT_GE(shares.wrench, shares.stiffness);
    ASSERT_LE(shares.stiffness * in.contact_stiffness_n_per_m, kCap * (1 + 1e-12));
  }
  for (int n = 0; n < 4000; ++n)
    cap.step(ball(2e-3, 50.0), {}, kT);
  const CouplingInput in = ball(2e-3, 50.0);
  EXPECT_LE(cap.step(in, {}, kT).wrench * in.contact.force.z(), kCap * 2e-3 * (1 + 1e-6));
}

/// Force and torque keep their proportion, and where turning decides the cap, what they grow by is
/// what it leaves.
TEST(Secant, KeepsTheWrenchsDirectionAndBothCaps) {
  CouplingSpec spec = direct(1e4);
  spec.stiffness_cap_nm_per_rad = 0.03;
  RunningCoupling coupling(spec, {}, kT);
  coupling.step({}, kT);
  const double lever = 0.02,
               shown = 0.03 / (lever *
                               lever);  // N/m that turning leaves, a little less with both together
  double before = 0.0;
  for (double depth = 0.0; depth <= 0.008; depth += kStep) {
    CouplingInput in = ball(depth, 20.0);
    const double k = in.contact_stiffness_n_per_m;
    in.contact.torque = Vec3(lever * in.contact.force.z(), 0, 0);
    in.contact_stiffness(3, 3) = lever * lever * k;
    in.contact_stiffness(2, 3) = in.contact_stiffness(3, 2) = lever * k;
    const Wrench out = coupling.step(in, kT).wrench;
    ASSERT_NEAR(out.torque.x(), lever * out.force.z(), 1e-12);
    ASSERT_LE(out.force.z() - before, shown * kStep);
    before = out.force.z();
  }
  EXPECT_GT(before, 0.85 * shown * 0.008);
}

/// Points of a tool that push along their own normals; `shift` and `turn` of the tool as small
/// ways.
CouplingInput points_at(const std::vector<std::array<Vec3, 2>>& points,
                        const std::vector<double>& depths, double k, const Vec3& shift,
                        const Vec3& turn) {
  CouplingInput in;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const auto& [arm, normal] = points[n];
    Vec6 j;
    j << normal, arm.cross(normal);
    const double depth = depths[n] - normal.dot(shift) - j.tail<3>().dot(turn);
    if (depth <= 0.0)
      continue;
    in.contact.force += k * depth * normal, in.contact.torque += k * depth * j.tail<3>();
    in.contact_stiffness += k * j * j.transpose(), in.contact_stiffness_n_per_m += k;
    in.contact_depth_m = std::max(in.contact_depth_m, depth);
  }
  return in;
}

/// The stiffness that is shown by differences, in units of the caps, is no more than 1.02 in any
/// direction: also where the wrench has a larger share than s, which turns with the contact's other
/// walls.
TEST(Secant, ShowsNoMoreThanTheCapInAnyDirectionOfSpaceAndTurn) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> u(-1, 1);
  constexpr double kCapR = 0.1, kTiny = 1e-9;
  const Vec6 in_caps =
      (Vec6() << Vec3::Constant(1.0 / std::sqrt(kCap)), Vec3::Constant(1.0 / std::sqrt(kCapR)))
          .finished();
  double most = 0.0, largest_gain = 0.0;
  for (int trial = 0; trial < 300; ++trial) {
    CouplingSpec spec = direct();
    spec.stiffness_cap_nm_per_rad = trial % 2 ? kCapR : kInf;
    const double spread = trial % 5 == 0 ? 1.0 : 0.3 * std::abs(u(random));
    std::vector<std::array<Vec3, 2>> points;
    std::vector<double> begin;
    for (int n = 0; n < 30; ++n)
      points.push_back({0.01 * Vec3(u(random), u(random), u(random)),
                        Vec3(spread * u(random), spread * u(random), 1.0).normalized()}),
          begin.push_back(2e-3 * u(random) - 2e-3);
    StiffnessCap cap(spec);
    cap.step({}, {}, kT);
    const double end = 4e-3 * (1 + u(random));
    for (double d = 0.0; d < end; d += 1e-5)
      cap.step(points_at(points, begin, 30.0, Vec3(0, 0, -d), {0, 0, 0}),
               {true, Vec3(0, 0, -1e-5), {0, 0, 0}}, kT);
    const auto given = [&](const Vec6& way) {
      StiffnessCap from_here = cap;
      const CouplingInput in =
          points_at(points, begin, 30.0, Vec3(0, 0, -end) + way.head<3>(), way.tail<3>());
      const CapShares shares = from_here.step(in, {true, way.head<3>(), way.tail<3>()}, 1e-9);
      largest_gain = std::max(largest_gain, shares.wrench / shares.stiffness);
      return Vec6(shares.wrench * (Vec6() << in.contact.force, in.contact.torque).finished() +
                  (Vec6() << shares.beside.force, shares.beside.torque).finished());
    };
    cap.step(points_at(points, begin, 30.0, Vec3(0, 0, -end), {0, 0, 0}), {}, 1e-9);
    const int axes = trial % 2 ? 6 : 3;
    Eigen::MatrixXd shown(axes, axes);
    for (int axis = 0; axis < axes; ++axis) {
      const Vec6 way = kTiny * in_caps[axis] * Vec6::Unit(axis);
      const Vec6 column = in_caps.cwiseProduct(given(-way) - given(way)) / (2.0 * kTiny);
      shown.col(axis) = column.head(axes);
    }
    most = std::max(
        most, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (shown + shown.transpose()))
                  .eigenvalues()
                  .maxCoeff());
  }
  std::printf("most shown over the cap %.4f; largest share over s %.3f\n", most, largest_gain);
  EXPECT_LE(most, kCapAcross + 1e-3);
  EXPECT_GT(most, 0.9);
  EXPECT_GT(largest_gain, 1.3) << "or nothing is tried";
}

/// Pressed on one wall the wrench has twice the share s; a second wall, met from the side, is as
/// stiff as the cap all the same.
TEST(Secant, ShowsNoMoreThanTheCapToASecondWallMetFromTheSide) {
  std::vector<std::array<Vec3, 2>> points;
  std::vector<double> begin;
  for (int n = 0; n < 60; ++n) {
    const bool side = n >= 30;
    points.push_back({Vec3::Zero(), side ? Vec3(-1, 0, 0) : Vec3(0, 0, 1)});
    begin.push_back(side ? -1e-3 : -4e-3 * n / 30);
  }
  StiffnessCap cap(direct());
  cap.step({}, {}, kT);
  Vec3 at = Vec3::Zero();
  CapShares shares;
  const auto go = [&](const Vec3& way) {
    at += way;
    const CouplingInput in = points_at(points, begin, 30.0, at, {0, 0, 0});
    shares = cap.step(in, {true, way, {0, 0, 0}}, kT);
    return Vec3(shares.wrench * in.contact.force + shares.beside.force);
  };
  for (int n = 0; n < 400; ++n)
    go(Vec3(0, 0, -1e-5));
  EXPECT_GT(shares.wrench, 1.6 * shares.stiffness) << "or nothing is tried";
  Vec3 before = Vec3::Zero();
  for (int n = 0; n < 300; ++n) {
    const Vec3 now = go(Vec3(1e-5, 0, 0));
    ASSERT_LE(before.x() - now.x(), 1.03 * kCap * 1e-5) << n;
    before = now;
  }
  EXPECT_LT(before.x(), -0.9 * kCap * 1e-3);
}

/// A contact whose normals cancel deep in: from 4 mm on it gives way, by half at 8 mm; `saw`: with
/// a step at each voxel of 1 mm.
CouplingInput giving_way(double depth, double saw) {
  CouplingInput in = ball(depth, 20.0, 1e-3);
  in.contact.force *= (1.0 - 0.5 * std::clamp((depth - 0.004) / 0.004, 0.0, 1.0)) *
                      (1.0 + saw * (1e3 * depth - std::floor(1e3 * depth)));
  return in;
}

TEST(Secant, DoesNotFallWhileTheHandGoesInAndGivesNoMoreOutWhereTheContactGivesWay) {
  for (const double saw : {0.0, 0.02}) {
    RunningCoupling coupling = running();
    press(coupling, {});
    double before = 0.0, last = 0.0, given_j = 0.0, most = 0.0;
    const auto go = [&](double from, double to) {
      const int steps = static_cast<int>(std::lround(std::abs(to - from) / kStep));
      for (int n = 1; n <= steps; ++n) {
        const double depth = from + (to - from) * n / steps,
                     force = press(coupling, giving_way(depth, saw));
        if (to > from) {
          ASSERT_GE(force, before * (1 - 1e-3)) << depth;
          ASSERT_LE(force, kCap * depth * 1.01) << depth;
        }
        given_j += 0.5 * (before + force) * (last - depth);
        before = force, last = depth, most = std::max(most, force);
      }
    };
    go(0.0, 0.008);
    EXPECT_GT(before, 0.95 * kCap * 0.004);
    for (int n = 0; n < 20; ++n)
      go(0.008, 0.002), go(0.002, 0.008);
    go(0.008, 0.0);
    std::printf("gives way, saw %g: up to %.3f N, given %.2e J in 21 rounds\n", saw, most, given_j);
    EXPECT_LE(given_j, 0.0);
  }
}

/// A ball whose points push along their own normals is as stiff across as along. Its secant is the
/// cap all the same, a push across shows no more than the cap, and rounds in, across and out give
/// nothing.
TEST(Secant, IsTheCapWhereTheContactIsAsStiffAcross) {
  std::vector<std::array<Vec3, 2>> points;
  std::vector<double> begin;
  for (int ring = 0; ring < 40; ++ring)
    for (int n = 0; n < 2 * ring + 1; ++n) {
      const double angle = 1.2 * (ring + 0.5) / 40,
                   round = 2.0 * std::numbers::pi * n / (2 * ring + 1);
      points.push_back({Vec3::Zero(), Vec3(std::sin(angle) * std::cos(round),
                                           std::sin(angle) * std::sin(round), std::cos(angle))});
      begin.push_back(-0.002 * (1.0 - std::cos(angle)));
    }
  RunningCoupling coupling = running();
  coupling.step({}, kT);
  Vec3 at = Vec3::Zero(), force = Vec3::Zero();
  double given_j = 0.0, stiffest = 0.0;
  const auto go = [&](const Vec3& to) {
    const Vec3 from = at;
    const int steps = static_cast<int>(std::lround((to - from).norm() / kStep));
    for (int n = 1; n <= steps; ++n) {
      const Vec3 next = from + (to - from) * n / steps;
      CouplingInput in = points_at(points, begin, 30.0, next, Vec3::Zero());
      in.tool.position = next;
      const Vec3 now = coupling.step(in, kT).wrench.force;
      given_j += 0.5 * (force + now).dot(next - at);
      if (std::abs(to.x() - from.x()) > 0.0)
        stiffest = std::max(stiffest, (force - now).dot((to - from).normalized()) / kStep);
      force = now, at = next;
    }
  };
  go(Vec3(0, 0, -0.005));
  EXPECT_GE(force.z(), 0.95 * kCap * 0.005);
  EXPECT_LE(force.z(), kCap * 0.005);
  EXPECT_LE(force.head<2>().norm(), 1e-3 * force.z());
  for (int n = 0; n < 20; ++n) {
    go(Vec3(0.001, 0, -0.005));
    go(Vec3(0.001, 0, -0.002));
    go(Vec3(0, 0, -0.002));
    go(Vec3(0, 0, -0.005));
  }
  go(Vec3(0, 0, 0.001));
  std::printf("as stiff across: %.3f of the cap at most across, given %.2e J in 21 rounds\n",
              stiffest / kCap, given_j);
  EXPECT_LE(stiffest, 1.03 * kCap);
  EXPECT_LE(given_j, 0.0);
}

/// Pressed to 5 mm; then `event` happens and the hand rests for a second. The largest step of the
/// force, and the force at the end.
struct Rested {
  double largest_step_n, last_n;
};
Rested rest_after(double layer, const std::function<void(RunningCoupling&)>& event,
                  const std::function<CouplingInput(int)>& then) {
  RunningCoupling coupling(direct(), {}, kT);
  double before = press_to(coupling, 0.005, 20.0, layer), largest = 0.0;
  EXPECT_GT(before, 0.9 * kCap * 0.005);
  event(coupling);
  for (int n = 0; n < 1000; ++n) {
    const double force = press(coupling, then(n));
    largest = std::max(largest, std::abs(force - before));
    before = force;
  }
  return {largest, before};
}

/// Of whatever may happen in contact none makes a step above a ramp over 0.2 s of all that is felt
/// (and the first sample of a ramp out of a reset).
TEST(Secant, MakesNoStepByClutchSessionReloadDesignOrJump) {
  const double all = kCap * 0.005, ramp = all * kT / kDefaultRampS;
  for (const double layer : {kInf, 1e-3}) {
    const CouplingInput pressed = ball(0.005, 20.0, layer);
    const double by_scale = kCap / pressed.contact_stiffness_n_per_m * pressed.contact.force.z();
    const auto stay = [&](int) { return pressed; };
    const auto nothing = [](RunningCoupling&) {};
    // The clutch is released and a session begins from no force: what was before is forgotten, and
    // the contact fades in with s of its wrench.
    RunningCoupling coupling = running();
    press_to(coupling, 0.005, 20.0, layer);
    coupling.reset({});
    double before = 0.0;
    for (int n = 0; n < 1000; ++n) {
      const double force = press(coupling, pressed);
      ASSERT_LE(std::abs(force - before), ramp * (1 + 1e-9)) << n;
      before = force;
    }
    EXPECT_NEAR(before, by_scale, 1e-9);
    // A restart at the present force, as a gap of the loop or another kind of coupling makes it.
    Rested r = rest_after(
        layer,
        [](RunningCoupling& c) {
          c.reset({{0, 0, 0.9 * kCap * 0.005}, {0, 0, 0}});
        },
        stay);
    EXPECT_LE(r.largest_step_n, 0.15 * all)
        << "the start force given is not quite the one that was";
    EXPECT_NEAR(r.last_n, by_scale, 1e-9);
    r = rest_after(
        layer, [&](RunningCoupling& c) { c.step(pressed, 20 * kT); }, stay);
    EXPECT_LE(r.largest_step_n, 2.02 * ramp) << "gap; its own sample and the next";
    EXPECT_NEAR(r.last_n, by_scale, 1e-9);
    // Other caps.
    for (const double cap : {150.0, 600.0, 1e6}) {
      r = rest_after(
          layer, [&](RunningCoupling& c) { ASSERT_TRUE(c.redesign(direct(cap))); }, stay);
      EXPECT_LE(
          r.largest_step_n,
          2.0 * std::max(ramp, std::abs(pressed.contact.force.z() *
                                            std::min(1.0, cap / pressed.contact_stiffness_n_per_m) -
                                        by_scale) *
                                   kT / kDefaultRampS))
          << cap;
      EXPECT_LE(r.last_n, std::min(cap, pressed.contact_stiffness_n_per_m) * 0.005 * 1.001);
    }
    // Another scene fades in over 0.2 s, softer or stiffer, and tells its depth from the middle on.
    for (const double k : {2.0, 200.0}) {
      const CouplingInput other = ball(0.004, k, 5e-4);
      const auto fade = [&](int n) {
        const double w = std::min(1.0, (n + 1) * kT / kDefaultRampS);
        CouplingInput in = w < 0.5 ? pressed : other;
        in.tool = pressed.tool;
        in.contact.force = (1 - w) * pressed.contact.force + w * other.contact.force;
        in.contact_stiffness = (1 - w) * pressed.contact_stiffness + w * other.contact_stiffness;
        in.contact_stiffness_n_per_m =
            (1 - w) * pressed.contact_stiffness_n_per_m + w * other.contact_stiffness_n_per_m;
        return in;
      };
      r = rest_after(layer, nothing, fade);
      const double raw_ramp =
          std::abs(other.contact.force.z() - pressed.contact.force.z()) * kT / kDefaultRampS;
      EXPECT_LE(r.largest_step_n, std::max(1.1 * ramp, k < 20.0 ? raw_ramp : 0.0)) << k;
    }
    // The deepest point is suddenly another one, with the wrench as it was.
    for (const double share : {0.1, 10.0}) {
      CouplingInput in = pressed;
      in.contact_depth_m *= share;
      EXPECT_LE(rest_after(layer, nothing, [&](int) { return in; }).largest_step_n, 1.1 * ramp)
          << share;
    }
    // The mapping jumps along the contact, deeper by what no hand does in a sample, with the same
    // contact or out of reach and back.
    CouplingInput far = pressed;
    far.tool.position.z() -= 0.5;
    EXPECT_LE(rest_after(layer, nothing, [&](int) { return far; }).largest_step_n, 1e-9);
  }
}

TEST(Secant, BeginsWithTheScaleWhereAContactIsMetDeepInside) {
  RunningCoupling coupling = running();
  const CouplingInput in = ball(0.005, 20.0);
  coupling.reset({});
  double force = 0.0;
  for (int n = 0; n < 500; ++n)
    force = press(coupling, in);
  EXPECT_NEAR(force, kCap / in.contact_stiffness_n_per_m * in.contact.force.z(), 1e-9);
}

TEST(Secant, ADepthThatIsNoNumberMakesTheSampleUnusable) {
  CouplingInput in = ball(0.005, 20.0);
  EXPECT_TRUE(usable(in));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInf, -1e13, 1e13}) {
    in.contact_depth_m = bad;
    EXPECT_FALSE(usable(in));
  }
}

}  // namespace secant_test
}  // namespace voxtouch::coupling
