// A body's weight whatever its grip, and how soon it hangs still.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/effects/rigid_body.hpp"
#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"
#include "tests/hard/faults/inputs.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::faults {
namespace {

constexpr double kMass = 0.2, kWeight = kMass * 9.81;

/// Mean force along z of the last half second.
double held_n(long_runs::LoopRig& rig, double seconds) {
  const auto samples = static_cast<std::size_t>(seconds * rig.device_description().rate_hz);
  const std::size_t last = samples / 6;
  double sum = 0.0;
  for (std::size_t n = 0; n < samples; ++n)
    if (const Wrench& given = rig.step(); n + last >= samples)
      sum += given.force.z();
  return sum / static_cast<double>(last);
}

TEST(BodyWeight, IsFullyHeldAtAnyGripStiffness) {
  for (const sim::SimParameters& device : {sim::sim_phantom(), sim::sim_lwr()})
    for (const int grip : {200, 1000, 2000, 10000}) {
      Inputs inputs;
      inputs.mesh("floor", {{{-0.06, -0.04, -0.03}, {0.06, 0.04, 0.0}}});
      inputs.mesh("block", {{{-0.02, -0.015, -0.01}, {0.02, 0.015, 0.01}}});
      long_runs::RigOptions options;
      options.device = device, options.motion = "rest";
      options.scene = inputs.scene(
          "held", fmt::format("static: [{{mesh: floor.obj}}]\ndynamic: {{mesh: block.obj}}\n"
                              "contact: {{model: field, stiffness_n_per_m3: 3.0e6}}\n"
                              "coupling: {{design: auto}}\neffects:\n"
                              "  - body: {{mass_kg: {}, grip_n_per_m: {}}}\n"
                              "motions:\n  rest: {{path: [[0, 0, 0.06]], hold_s: 4}}\n",
                              kMass, grip));
      long_runs::LoopRig rig(options);
      EXPECT_NEAR(held_n(rig, 3.0), -kWeight, 0.03 * kWeight) << grip;
      EXPECT_NEAR(rig.front().frame().wrench.force.z(), -kWeight, 0.01 * kWeight) << grip;
    }
}

/// A slender bar along x of that length, gripped at this distance from its middle.
effects::BodyShape bar(double length_m, double off_m) {
  effects::BodyShape shape;
  const double along = 0.01 * 0.01 / 6.0, across = length_m * length_m / 12.0;
  shape.centre = Vec3(off_m, 0, 0);
  shape.inertia_m2 = Vec3(along, across, across).asDiagonal();
  shape.reach_m = length_m;
  return shape;
}

TEST(BodyAtTheGrip, OfAnyLengthSettlesInTwoSeconds) {
  for (const double length : {0.05, 0.1, 0.2, 0.4, 0.7, 1.0})
    for (const double part : {0.0, 0.25, 0.5, -0.5})
      for (const double grip_nm : {0.0, 0.3, 3.0}) {
        const double arm = std::abs(part * length);
        if (grip_nm == 0.0 && arm == 0.0)
          continue;  // no restoring torque
        const effects::BodyParameters p{.mass_kg = kMass,
                                        .gravity_m_per_s2 = {0, 0, -9.81},
                                        .grip_n_per_m = 500,
                                        .grip_nm_per_rad = grip_nm,
                                        .grip_damping_ratio = 1};
        effects::RigidBody body(bar(length, part * length));
        body.place({}, true);
        std::vector<Pose> after;
        for (int n = 0; n < 8000; ++n) {
          (void)body.step({}, {}, {}, true, 0.0, p, 1e-3);
          if (n >= 2000)
            after.push_back(body.pose());
        }
        const Quat& end = after.back().orientation;
        const double swing = 0.5 * length * after.front().orientation.angularDistance(end);
        EXPECT_LT(swing, 0.02 * length) << length << ' ' << part << ' ' << grip_nm;
        EXPECT_LT((after.front().position - after.back().position).norm(), 1e-4);
      }
}

/// For free modes as the eigenvalues of the body's equations.
TEST(BodyAtTheGrip, DampsEveryModeAtTheRequestedRatio) {
  effects::BodyShape shape = bar(0.3, 0.15);
  shape.inertia_m2(0, 1) = shape.inertia_m2(1, 0) = 1e-4;
  const effects::BodyParameters p{
      .mass_kg = kMass, .grip_n_per_m = 400, .grip_nm_per_rad = 0.5, .grip_damping_ratio = 0.4};
  const Mat6 d = effects::grip_damping(shape, p);
  EXPECT_LT((d - d.transpose()).norm(), 1e-12 * d.norm());
  const Mat3 across = cross_matrix(shape.centre);
  Mat6 mass;
  mass << kMass * Mat3::Identity(), -kMass * across, kMass * across,
      kMass * (shape.inertia_m2 - across * across);
  const Vec6 k = (Vec6() << Vec3::Constant(400), Vec3::Constant(0.5)).finished();
  Eigen::Matrix<double, 12, 12> system = Eigen::Matrix<double, 12, 12>::Zero();
  const Mat6 inverse = mass.inverse();
  system.topRightCorner<6, 6>().setIdentity();
  system.bottomLeftCorner<6, 6>() = -inverse * k.asDiagonal();
  system.bottomRightCorner<6, 6>() = -inverse * d;
  const auto poles = system.eigenvalues().eval();
  for (int n = 0; n < 12; ++n)
    EXPECT_NEAR(-poles[n].real() / std::abs(poles[n]), 0.4, 1e-6);
}

}  // namespace
}  // namespace voxtouch::faults
