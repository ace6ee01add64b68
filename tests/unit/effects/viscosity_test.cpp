#include <gtest/gtest.h>

#include "core/effects/effect_chain.hpp"

namespace voxtouch::effects {
namespace {

TEST(Viscosity, PushesAgainstTheVelocityAndTakesEnergyOnly) {
  EffectSpec spec{
      .name = "viscosity", .kind = find_effect_kind("viscosity"), .values = {}, .region = {}};
  spec.values = EffectValues(spec.kind->parameters);
  spec.values.at(0)[0] = 3.0;
  spec.values.at(1)[0] = 0.1;
  EXPECT_TRUE(spec.kind->needs(spec.values).twist);
  EXPECT_TRUE(spec.kind->needs(spec.values).torque);
  EXPECT_EQ(bound_of(spec).damping_ns_per_m, 3.0);
  EffectChain chain({spec});
  EffectFrame frame;
  frame.dt_s = 0.001;
  frame.twist = {Vec3(0.1, -0.2, 0.3), Vec3(1, 0, -1)};
  const EffectForce push = chain.apply(frame);
  EXPECT_TRUE(push.wrench.force.isApprox(Vec3(-0.3, 0.6, -0.9)));
  EXPECT_TRUE(push.wrench.torque.isApprox(Vec3(-0.1, 0, 0.1)));
  EXPECT_LT(push.wrench.force.dot(frame.twist.linear) + push.wrench.torque.dot(frame.twist.angular),
            0.0);
}

}  // namespace
}  // namespace voxtouch::effects
